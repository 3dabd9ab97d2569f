/// \file
/// The error of a run, from the defect of its own curve: integrated along the run, step by step.
///
/// The dense output of the run has angles q and rates qd. Its rates and their integral in each step
/// make a curve, u(t) = (q(0) + integral of qd, qd). The true motion is u + e, and e obeys
///
///     d(e_q)/dt  = e_qd
///     d(e_qd)/dt = qdd(t, u + e) - d(qd)/dt
///
/// with the accelerations qdd of the equations of motion. Only the slopes of the dense output enter
/// beside these: the run's method, its coefficients and its error estimate do not. e needs few
/// digits, so a few right-hand sides a step find it. They are taken at the points of a Lobatto
/// quadrature. With the polynomial through all r_j = h (qdd - d(qd)/dt) at the points theta_j,
///
///     e_qd(theta) = e_qd(0) + integral of r
///     e_q(theta)  = e_q(0) + theta h e_qd(0) + h (double integral of r)
///
/// The state at a point is found in the same way from the points before it, as in an explicit
/// Runge-Kutta-Nystrom method. The right-hand side at the last point serves the next step as well.
/// Where an error is reported, the difference between the curve's angles and the run's is added.
///
/// It suits Taylor series best: their error inside a step is no larger than at its ends. That of
/// Dormand and Prince's methods is larger inside, which takes more points; e is less certain then.
///
/// A neighbour is a scene and its angles at the start: the run's own, or some that differ by last
/// bits. The e of such a one also has what rounding may do to the motion. The distance of two
/// neighbours that differ only in the number of their points shows how well e itself is known.
///
/// Source: Zadunaisky, Numerische Mathematik 27 (1976) 21-39; Skeel, Numerische Mathematik 48
/// (1986) 1-20, "solving for the correction". The points are those of lobatto_points.hpp. Cost: for
/// each step and neighbour one right-hand side less than there are points, and one at the
/// start.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "pendcore/options.hpp"
#include "pendcore/scene.hpp"
#include "simulate/step_watch.hpp"

namespace pendcore {

/// Whether the error of a run of a scene can be found in this way: no law switches, in time or with
/// the state, and no joint may be held.
bool has_defect_correction(const Scene& scene);

/// How far the errors of the first two neighbours are apart at the ends of the steps. The measure
/// is the sum of the errors of the links, each times its share in the total length, which bounds
/// the distance of any joint. Beyond 0.2 the run is lost, and its error is not known any more.
/// Where chaos made the error grow, it is hardly larger than that at first; where the integration
/// is unstable, it is many times as large.
struct Agreement {
  double between = 0.0;  ///< the largest distance
  double largest = 0.0;  ///< the largest error
  double at_loss = 0.0;  ///< the error with which the run was lost; 0 if it is not
  double t_known = 0.0;  ///< s, until when the errors are known

  bool is_lost() const { return at_loss != 0.0; }
};

/// Finds the error of one run while it is made. It needs the dense output of every step; the run
/// may keep anything.
class DefectCorrection final : public KeepingWatch {
 public:
  DefectCorrection();
  ~DefectCorrection() override;
  DefectCorrection(DefectCorrection&&) noexcept;

  /// Adds a neighbour for each of some numbers of points in a step, 5 to 9: a scene of as
  /// many links as the run's, and its angles at the start, (n) rad. Throws std::invalid_argument
  /// for other sizes, and for a scene that has no defect correction.
  void add(const Scene& scene, const std::vector<double>& q0, std::span<const int> points);
  /// Keeps errors where a run keeps its states: at t_eval, at the steps, or at the end; of a run
  /// with dense output at six times in each step.
  void keep(Store store, const Options& options) override;

  bool asks_for_dense_output() const override { return true; }
  void starts(double t, std::span<const double> y) override;
  void steps(const WatchedStep& step) override;
  /// A scene whose laws do not change has no impacts: its state is only settled.
  void jumps(double /*t*/, std::span<const double> /*y*/) override {}

  const std::vector<double>& t() const { return t_; }  ///< s, (n_t)
  /// The errors of the angles, (n_t, neighbours, n) row-major, rad. NaN where the run is lost.
  const std::vector<double>& errors() const { return errors_; }
  const Agreement& agreement() const { return agreement_; }
  std::vector<double> errors_at_end() const;  ///< the same where the run is now, (neighbours, n)
  std::size_t neighbours() const { return neighbours_.size(); }
  std::size_t links() const;  ///< n
  long long nfev() const;     ///< right-hand sides

 private:
  struct Step;
  struct Neighbour;
  struct Scratch;
  void take_curve(const WatchedStep& step);
  void go_on(const Step& step);
  void end_step(const WatchedStep& step);
  void compare();
  void keep_errors(const Step& step);
  void keep_errors_within(const Step& step, const double* t);
  void keep_errors_now(double t);
  double* append(std::size_t times);

  std::vector<std::unique_ptr<Neighbour>> neighbours_;
  std::unique_ptr<Scratch> scratch_;
  Store store_ = Store::end;
  std::vector<double> t_eval_;
  std::size_t next_time_ = 0;
  bool has_started_ = false;
  double t_start_ = 0.0;  ///< s, of the step
  std::vector<double> t_, errors_;
  Agreement agreement_;
};

}  // namespace pendcore
