#include "analysis/defect.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "arithmetic/floating_point_environment.hpp"
#include "arithmetic/pack.hpp"
#include "dynamics/contact/held_joints.hpp"
#include "dynamics/equations_of_motion.hpp"
#include "dynamics/joint_forces.hpp"

namespace pendcore {
namespace {

/// The dense output of one step, and the curve that its rates make.
class Curve {
 public:
  Curve(const Solution& solution, std::size_t step)
      : n_(static_cast<std::size_t>(solution.n)),
        degree_(solution.dense.degree),
        row_(static_cast<std::size_t>(solution.dimension)),
        h_(solution.dense.h[step]),
        start_(solution.dense.start[step]),
        start_low_(solution.dense.start_low[step]),
        rows_(solution.dense.coefficients.data() + step * (degree_ + 1) * row_) {}

  double h() const { return h_; }
  double time(double theta) const { return start_ + fma(theta, h_, start_low_); }
  /// The theta up to which the run used the step.
  double end(double t_reached) const {
    return std::min(1.0, ((t_reached - start_) - start_low_) / h_);
  }
  /// The angle by which the dense output has turned since the step began, rad.
  double turned(std::size_t link, double theta) const { return theta * sum(link, theta, 0); }
  double angle(std::size_t link, double theta) const { return rows_[link] + turned(link, theta); }
  double rate(std::size_t link, double theta) const {
    const double* const w = rows_ + n_ + link;
    return *w + theta * sum(n_ + link, theta, 0);
  }
  /// d(qd)/dt
  double slope(std::size_t link, double theta) const { return sum(n_ + link, theta, 1) / h_; }
  /// The integral of the rate since the step began.
  double integral(std::size_t link, double theta) const {
    const double* const w = rows_ + n_ + link;
    return theta * h_ * (*w + theta * sum(n_ + link, theta, -1));
  }

 private:
  /// The sum over p >= 1 of theta^(p-1) c_p, with a factor in each term: p for the derivative, 1
  /// for the polynomial, 1/(p+1) for the integral.
  double sum(std::size_t column, double theta, int derivatives) const {
    double total = 0.0;
    for (int p = degree_; p >= 1; --p) {
      const double c = rows_[p * row_ + column];
      total = total * theta + (derivatives > 0 ? p * c : derivatives < 0 ? c / (p + 1) : c);
    }
    return total;
  }

  std::size_t n_;
  int degree_;
  std::size_t row_;
  double h_, start_, start_low_;
  const double* rows_;
};

/// The torques that are missing in the equations of motion.
class Torques {
 public:
  Torques(const Scene& scene, std::size_t n)
      : equations_(equations_of_motion(scene)), forces_(scene), n_(n), qdd_(n) {}

  /// Chooses the modes in the middle of a step. They hold for the whole step, because steps end
  /// where a law changes.
  void choose_modes(double t, const std::vector<double>& q, const std::vector<double>& qd) {
    accelerations(equations_, t, q.data(), qd.data(), qdd_.data());
  }
  /// Raises `largest` to |tau_j| where that is larger.
  void raise(double t, const std::vector<double>& q, const std::vector<double>& qd,
             const std::vector<double>& slope, double* largest) {
    accelerations_in_force(equations_, t, q.data(), qd.data(), qdd_.data());
    forces_.set_mass_matrix(q.data());
    double torque = 0.0;
    for (std::size_t j = n_; j-- > 0;) {
      for (std::size_t i = 0; i < n_; ++i) {
        torque += forces_.mass(j, i) * (slope[i] - qdd_[i]);
      }
      const auto& held = equations_.held_joints;
      if (held && held->is_held(static_cast<int>(j))) continue;
      if (!(std::abs(torque) <= largest[j])) largest[j] = std::abs(torque);
    }
  }

 private:
  EquationsOfMotion equations_;
  JointForces forces_;
  std::size_t n_;
  std::vector<double> qdd_;
};

}  // namespace

Defect defect(const Scene& scene, const Solution& solution, std::size_t first, std::size_t end,
              std::vector<double>& q) {
  const FloatingPointEnvironment ieee;
  if (solution.options.store != Store::dense) {
    throw std::invalid_argument(
        "defect: this solution keeps no dense output: simulate with store=\"dense\"");
  }
  const auto n = static_cast<std::size_t>(solution.n);
  const int grid = 4 * (solution.dense.degree + 1);
  Torques torques(scene, n);
  Defect found{std::vector<double>((end - first) * n), std::vector<double>(end - first)};
  std::vector<double> angles(n), rates(n), slopes(n);
  for (std::size_t step = first; step < end; ++step) {
    const Curve curve(solution, step);
    const double last = curve.end(solution.t_reached);
    for (std::size_t i = 0; i < n; ++i) {
      angles[i] = curve.angle(i, 0.5 * last);
      rates[i] = curve.rate(i, 0.5 * last);
    }
    torques.choose_modes(curve.time(0.5 * last), angles, rates);
    if (q.empty()) {
      for (std::size_t i = 0; i < n; ++i) q.push_back(curve.angle(i, 0.0));
    }
    double& apart = found.apart[step - first];
    for (int k = 0; k < grid; ++k) {
      const double theta = last * (k + 0.5) / grid;
      for (std::size_t i = 0; i < n; ++i) {
        angles[i] = q[i] + curve.integral(i, theta);
        rates[i] = curve.rate(i, theta);
        slopes[i] = curve.slope(i, theta);
        const double between =
            (q[i] - curve.angle(i, 0.0)) + (curve.integral(i, theta) - curve.turned(i, theta));
        if (!(std::abs(between) <= apart)) apart = std::abs(between);
      }
      torques.raise(curve.time(theta), angles, rates, slopes,
                    found.torque.data() + (step - first) * n);
    }
    for (std::size_t i = 0; i < n; ++i) q[i] += curve.integral(i, last);
  }
  return found;
}

}  // namespace pendcore
