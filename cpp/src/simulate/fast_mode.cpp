#include "simulate/fast_mode.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "arithmetic/eigenvalues.hpp"
#include "dynamics/jacobian.hpp"
#include "pendcore/equations.hpp"

namespace pendcore {
namespace {

using ComplexVector = Eigen::Matrix<std::complex<double>, Eigen::Dynamic, 1, Eigen::DontAlign>;
using ComplexMatrix =
    Eigen::Matrix<std::complex<double>, Eigen::Dynamic, Eigen::Dynamic, Eigen::DontAlign>;

/// A and B of qdd = A q + B qd about a state.
Derivatives linearized(const Scene& scene, const EquationsOfMotion& equations, double t,
                       const double* q, const double* qd) {
  const auto n = static_cast<Eigen::Index>(scene.links.size());
  Derivatives result{.by_q = Matrix(n, n), .by_qd = Matrix(n, n)};
  Jacobian(scene, equations)(t, q, qd, result.by_q, result.by_qd);
  return result;
}

/// The largest sum of the sizes in a row. A row that is not a number does not count.
double norm(const Matrix& matrix) {
  double largest = 0.0;
  for (const auto& row : matrix.rowwise()) largest = std::max(largest, row.lpNorm<1>());
  return largest;
}

/// No |lambda| is larger: |lambda|^2 <= |B| |lambda| + |A|.
double bound_of(const Derivatives& second_order) {
  const double of_q = norm(second_order.by_q);
  const double of_qd = norm(second_order.by_qd);
  return 0.5 * (of_qd + std::sqrt(of_qd * of_qd + 4.0 * of_q));
}

/// The same bound for a scene alone, in the modes that the state calls for.
double bound_of(const Scene& scene, double t, const double* q, const double* qd) {
  const EquationsOfMotion equations = equations_of_motion(scene);
  if (equations.effects) choose_modes(*equations.effects, t, q, qd, true);
  return bound_of(linearized(scene, equations, t, q, qd));
}

/// The eigenvalues of the first-order system, and the angles of links in its eigenvectors.
struct ModesOfLinks {
  ComplexVector values;  ///< (2n), 1/s
  ComplexMatrix angles;  ///< (n, 2n)
};

ModesOfLinks modes_of(const Derivatives& second_order) {
  const Eigen::Index n = second_order.by_q.rows();
  Matrix first_order(2 * n, 2 * n);
  first_order << Matrix::Zero(n, n), Matrix::Identity(n, n), second_order.by_q, second_order.by_qd;
  const Eigenpairs pairs = eigenpairs(first_order.data(), static_cast<int>(2 * n));
  return {.values = Eigen::Map<const ComplexVector>(pairs.values.data(), 2 * n),
          .angles = Eigen::Map<const ComplexMatrix>(pairs.vectors.data(), 2 * n, 2 * n).topRows(n)};
}

/// The number of the eigenvalue that makes a mode with number `first`: its conjugate, or the real
/// one that moves the links most alike.
Eigen::Index partner_of(Eigen::Index first, const ModesOfLinks& modes) {
  const auto& [values, angles] = modes;
  Eigen::Index partner = first;
  double most_alike = -1.0;
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    if (k == first) continue;
    const bool is_conjugate = values[k] == std::conj(values[first]) && values[k].imag() != 0.0;
    const bool is_real = values[k].imag() == 0.0 && values[first].imag() == 0.0;
    double alike = is_conjugate ? 2.0 : -1.0;
    if (is_real) {
      const double size = angles.col(k).norm() * angles.col(first).norm();
      alike = std::abs(angles.col(k).dot(angles.col(first))) / size;
    }
    if (alike > most_alike) {
      most_alike = alike;
      partner = k;
    }
  }
  return partner;
}

constexpr double far_faster = 30.0;

}  // namespace

std::optional<FastMode> fast_mode(const Scene& scene, const EquationsOfMotion& equations, double t,
                                  const double* q, const double* qd) {
  const Derivatives whole = linearized(scene, equations, t, q, qd);
  if (!whole.by_q.allFinite() || !whole.by_qd.allFinite()) return std::nullopt;
  const Scene links{.links = scene.links, .gravity = scene.gravity};
  const double slow = far_faster * bound_of(links, t, q, qd);
  if (!(bound_of(whole) > slow)) return std::nullopt;  // the usual case: no eigenvalue is needed

  const ModesOfLinks modes = modes_of(whole);
  Eigen::Index first;
  const double fastest = modes.values.cwiseAbs().maxCoeff(&first);
  if (!(fastest > slow)) return std::nullopt;

  const std::complex<double> one = modes.values[first];
  const std::complex<double> other = modes.values[partner_of(first, modes)];
  const double omega = std::sqrt(std::abs(one * other));
  ComplexVector turned = modes.angles.col(first);  // the angles of joints
  turned.tail(turned.size() - 1) -= turned.head(turned.size() - 1).eval();
  Eigen::Index joint;
  turned.cwiseAbs().maxCoeff(&joint);
  FastMode mode{.frequency = omega,
                .damping_ratio = -0.5 * (one + other).real() / omega,
                .fastest = fastest,
                .joint = static_cast<int>(joint) + 1,
                .effect = std::nullopt};
  double slowest = 0.5 * bound_of(whole);
  for (std::size_t i = 0; i < scene.effects.size(); ++i) {
    Scene without = scene;
    without.effects.erase(without.effects.begin() + static_cast<std::ptrdiff_t>(i));
    const double bound = bound_of(without, t, q, qd);
    if (bound < slowest) {
      slowest = bound;
      mode.effect = static_cast<int>(i);
    }
  }
  // The joint that turns most may be the next one, which the same torque moves.
  if (mode.effect) {
    const int own_joint = scene.effects[*mode.effect]->joint();
    if (own_joint > 0) mode.joint = own_joint;
  }
  return mode;
}

}  // namespace pendcore
