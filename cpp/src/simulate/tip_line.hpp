/// \file
/// The distance of the tip from a line, at a state and along the dense output of a step.
///
///     g = n . (P_0(t) + sum_i L_i u_i(q_i) - point)                                         m
///     g' = n . (h v_0 + sum_i L_i q_i' n_i)                                    ' is d/dtheta
///     |g''| <= |n| (h^2 |a_0| + sum_i L_i sqrt(max |q_i''|^2 + max |q_i'|^4))
///
/// n is the normal of the line; P_0 is the pivot, which may move. The angles are polynomials in
/// theta, and the maxima over the step are bounded in Bernstein form. On an interval of width w
/// about m, Taylor's theorem then proves that g has no zero, |g(m)| > |g'(m)| w/2 + |g''| w^2/8, or
/// that it is monotone, |g'(m)| > |g''| w/2. Other intervals are halved until one of the two holds,
/// except where g touches zero. Cost: a sine and a cosine of each link at each point.
#pragma once

#include <vector>

#include "integrate/events/root.hpp"
#include "pendcore/events.hpp"
#include "pendcore/scene.hpp"

namespace pendcore {

class TipLine {
 public:
  TipLine(const Scene& scene, const events::TipLine& line);

  /// At time t (s) and angles q (n).
  double at(double t, const double* q);

  /// What rounding may do to it there.
  double rounding(double t, const double* q) const;

  /// The zeros in 0 < theta <= 1 of a step of size h from time t, with the dense output in
  /// `rows`, (degree + 1) of `dimension` numbers; `start` and `end` are the values at its ends.
  /// Values up to `noise` count as zero. Returns whether it has left the zero in which it starts.
  bool find(const double* rows, int degree, int dimension, double t, double h, double start,
            double end, double noise, std::vector<Root>& found);

 private:
  struct Point {
    double value;
    double slope;
  };
  Point along(double theta);
  void bound_curvature();
  void search(double low, double high, int depth);

  Scene scene_;
  events::TipLine line_;
  double size_of_normal_;
  double pivot_acceleration_;  ///< m/s^2, an upper bound
  const double* rows_ = nullptr;
  int degree_ = 0;
  int dimension_ = 0;
  double t_ = 0.0;
  double h_ = 0.0;
  double curvature_ = 0.0;  ///< a bound on |g''| over the step
  int points_left_ = 0;
  double noise_ = 0.0;  ///< what rounding may leave of a zero
  std::vector<double> angles_;
  std::vector<double> rates_;  ///< q_i'
  std::vector<double> sines_;
  std::vector<double> cosines_;
  std::vector<TurningPoint> points_;
};

}  // namespace pendcore
