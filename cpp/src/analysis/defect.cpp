#include "analysis/defect.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "arithmetic/floating_point_environment.hpp"
#include "arithmetic/pack.hpp"
#include "arithmetic/two_double.hpp"
#include "dynamics/contact/held_joints.hpp"
#include "dynamics/equations_of_motion.hpp"
#include "dynamics/joint_forces.hpp"
#include "integrate/horner.hpp"

namespace pendcore {
namespace {

/// A step at some theta, a row for each of them and a column for each link.
struct StepAtTheta {
  Matrix rates;   ///< qd
  Matrix slopes;  ///< d(qd)/dt
  Matrix turns;   ///< the integral of the rates since the step began
  Matrix turned;  ///< by how much the angles of the dense output have turned since
  Vector first;   ///< these angles where the step began
};

StepAtTheta step_at(const Solution& solution, std::size_t step, const Vector& theta) {
  const Eigen::Index n = solution.n;
  const int degree = solution.dense.degree;
  const double h = solution.dense.h[step];
  const Eigen::Index size = Eigen::Index{degree + 1} * solution.dimension;
  const Eigen::Map<const Matrix> rows(
      solution.dense.coefficients.data() + static_cast<Eigen::Index>(step) * size, degree + 1,
      solution.dimension);
  const auto of_angles = rows.leftCols(n);
  const auto of_rates = rows.middleCols(n, n);
  Matrix powers = Matrix::Ones(theta.size(), degree + 1);
  for (Eigen::Index p = 1; p <= degree; ++p) {
    powers.col(p) = powers.col(p - 1).cwiseProduct(theta);
  }
  const Vector number = Vector::LinSpaced(degree + 1, 1.0, 1.0 + degree);
  return {.rates = powers * of_rates,
          .slopes = powers.leftCols(degree) * number.head(degree).asDiagonal() *
                    of_rates.bottomRows(degree) / h,
          .turns = h * theta.asDiagonal() * powers * number.cwiseInverse().asDiagonal() * of_rates,
          .turned = powers.rightCols(degree) * of_angles.bottomRows(degree),
          .first = of_angles.row(0)};
}

/// The torques that are missing in the equations of motion.
class Torques {
 public:
  explicit Torques(const Scene& scene)
      : equations_(equations_of_motion(scene)), forces_(scene), qdd_(scene.links.size()) {}

  /// Chooses the modes in the middle of a step. They hold for the whole step, because steps end
  /// where a law changes.
  void choose_modes(double t, const Vector& q, const Vector& qd) {
    accelerations(equations_, t, q.data(), qd.data(), qdd_.data());
  }
  /// Raises `largest` to |tau_j| where that is larger.
  void raise(double t, const Vector& q, const Vector& qd, const Vector& slope,
             Eigen::Ref<Vector> largest) {
    accelerations_in_force(equations_, t, q.data(), qd.data(), qdd_.data());
    forces_.set_mass_matrix(q.data());
    const Vector of_links = forces_.mass * (slope - qdd_);
    double torque = 0.0;
    for (Eigen::Index j = of_links.size(); j-- > 0;) {
      torque += of_links[j];
      const auto& held = equations_.held_joints;
      if (held && held->is_held(static_cast<int>(j))) continue;
      if (!(std::abs(torque) <= largest[j])) largest[j] = std::abs(torque);
    }
  }

 private:
  EquationsOfMotion equations_;
  JointForces forces_;
  Vector qdd_;
};

}  // namespace

Defect defect(const Scene& scene, const Solution& solution, std::size_t first, std::size_t end,
              std::vector<double>& q) {
  const FloatingPointEnvironment ieee;
  if (solution.options.store != Store::dense) {
    throw std::invalid_argument(
        "defect: this solution keeps no dense output: simulate with store=\"dense\"");
  }
  const Eigen::Index n = solution.n;
  const int grid = 4 * (solution.dense.degree + 1);
  Torques torques(scene);
  Defect found{std::vector<double>((end - first) * n), std::vector<double>(end - first)};
  for (std::size_t step = first; step < end; ++step) {
    const double h = solution.dense.h[step];
    const TwoDouble start{solution.dense.start[step], solution.dense.start_low[step]};
    // The run may have used a part of its last step only.
    const double last = std::min(1.0, theta_at(solution.t_reached, start, h));
    // The points of the grid, and then the middle and the end.
    Vector theta = last * Vector::LinSpaced(grid + 2, 0.5, grid + 1.5) / grid;
    theta.tail<2>() << 0.5 * last, last;
    const auto time = [&](Eigen::Index k) { return start.high + fma(theta[k], h, start.low); };
    const StepAtTheta curve = step_at(solution, step, theta);
    if (q.empty()) q.assign(curve.first.begin(), curve.first.end());
    Eigen::Map<Vector> from(q.data(), n);

    torques.choose_modes(time(grid), curve.first + curve.turned.row(grid).transpose(),
                         curve.rates.row(grid));
    const Eigen::Index row = static_cast<Eigen::Index>(step - first) * n;
    Eigen::Map<Vector> largest(found.torque.data() + row, n);
    double& apart = found.apart[step - first];
    for (Eigen::Index k = 0; k < grid; ++k) {
      const Vector turn = curve.turns.row(k);
      torques.raise(time(k), from + turn, curve.rates.row(k), curve.slopes.row(k), largest);
      const Vector between = (from - curve.first) + (turn - curve.turned.row(k).transpose());
      for (const double one : between) {
        if (!(std::abs(one) <= apart)) apart = std::abs(one);  // NaN too
      }
    }
    from += curve.turns.row(grid + 1);
  }
  return found;
}

}  // namespace pendcore
