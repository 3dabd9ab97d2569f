#include "pendcore/simulate/fast_mode.hpp"

#include <cmath>
#include <complex>
#include <cstdio>
#include <Eigen/Eigenvalues>

#include "pendcore/dynamics/jacobian.hpp"
#include "pendcore/text/message.hpp"

namespace pendcore {
namespace {

using Matrix = Eigen::MatrixXd;
using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// ((0, 1), (A, B))
Matrix first_order(const Scene& scene, const EquationsOfMotion& equations, double t,
                   const double* q, const double* qd) {
  const auto n = static_cast<Eigen::Index>(scene.links.size());
  Rows by_q(n, n);
  Rows by_qd(n, n);
  Jacobian(scene, equations)(t, q, qd, by_q.data(), by_qd.data());
  Matrix whole = Matrix::Zero(2 * n, 2 * n);
  whole.topRightCorner(n, n).setIdentity();
  whole.bottomLeftCorner(n, n) = by_q;
  whole.bottomRightCorner(n, n) = by_qd;
  return whole;
}

/// No |lambda| is larger: |lambda|^2 <= |B| |lambda| + |A|, in the norm of the largest row sum.
double bound_of(const Matrix& whole) {
  const Eigen::Index n = whole.rows() / 2;
  auto norm = [&](const auto& block) { return block.cwiseAbs().rowwise().sum().maxCoeff(); };
  const double of_q = norm(whole.bottomLeftCorner(n, n));
  const double of_qd = norm(whole.bottomRightCorner(n, n));
  return 0.5 * (of_qd + std::sqrt(of_qd * of_qd + 4.0 * of_q));
}

/// The same of a scene of its own, in the modes that the state calls for.
double bound_of(const Scene& scene, double t, const double* q, const double* qd) {
  const EquationsOfMotion equations = equations_of_motion(scene);
  if (equations.effects) choose_modes(*equations.effects, t, q, qd, true);
  return bound_of(first_order(scene, equations, t, q, qd));
}

std::string short_text(double x) {
  char digits[32];
  std::snprintf(digits, sizeof digits, "%.3g", x);
  return digits;
}

/// Its frequency and damping ratio; the rate at which it dies out where that is the larger by far.
std::string measure_of(const FastMode& mode) {
  if (mode.damping_ratio > 10.0) return "overdamped, " + short_text(mode.fastest) + " 1/s";
  const double ratio = std::abs(mode.damping_ratio) < 1e-6 ? 0.0 : mode.damping_ratio;
  return short_text(mode.frequency) + " rad/s, damping ratio " + short_text(ratio);
}

constexpr double far_faster = 30.0;
constexpr long long many_steps = 1000;
constexpr std::size_t many_links = 100;

}  // namespace

std::optional<FastMode> fast_mode(const Scene& scene, const EquationsOfMotion& equations, double t,
                                  const double* q, const double* qd) {
  const Matrix whole = first_order(scene, equations, t, q, qd);
  if (!whole.allFinite()) return std::nullopt;
  const Scene links{.links = scene.links, .gravity = scene.gravity};
  const double slow = far_faster * bound_of(links, t, q, qd);
  if (!(bound_of(whole) > slow)) return std::nullopt;  // as a rule: no eigenvalue is needed
  const Eigen::EigenSolver<Matrix> solver(whole);
  const Eigen::VectorXcd& values = solver.eigenvalues();
  const Eigen::MatrixXcd vectors = solver.eigenvectors();
  const Eigen::Index n = whole.rows() / 2;
  Eigen::Index first = 0;
  if (!(values.cwiseAbs().maxCoeff(&first) > slow)) return std::nullopt;

  // Its partner: the conjugate, or the real one that moves the links most alike.
  Eigen::Index second = first;
  double most_alike = -1.0;
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    if (k == first) continue;
    const bool is_conjugate = values[k] == std::conj(values[first]) && values[k].imag() != 0.0;
    const std::complex<double> product = vectors.col(k).head(n).dot(vectors.col(first).head(n));
    const double size = vectors.col(k).head(n).norm() * vectors.col(first).head(n).norm();
    const bool is_real = values[k].imag() == 0.0 && values[first].imag() == 0.0;
    const double alike = is_conjugate ? 2.0 : is_real ? std::abs(product) / size : -1.0;
    if (alike > most_alike) {
      most_alike = alike;
      second = k;
    }
  }
  const double omega = std::sqrt(std::abs(values[first] * values[second]));
  FastMode mode{.frequency = omega,
                .damping_ratio = -0.5 * (values[first] + values[second]).real() / omega,
                .fastest = std::abs(values[first]),
                .joint = 1,
                .effect = std::nullopt};
  double largest = 0.0;
  for (Eigen::Index j = 0; j < n; ++j) {
    const std::complex<double> before = j > 0 ? vectors(j - 1, first) : 0.0;
    const double turn = std::abs(vectors(j, first) - before);
    if (turn > largest) {
      largest = turn;
      mode.joint = static_cast<int>(j) + 1;
    }
  }
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
    std::visit(
        [&]<class Kind>(const Kind& one) {
          if constexpr (OnJoint<Kind>) mode.joint = one.joint;
        },
        scene.effects[*mode.effect]);
  }
  return mode;
}

std::string remark_on_steps(const Scene& scene, const EquationsOfMotion& equations,
                            const IntegratorState& integrator, const MethodInfo& method,
                            const MethodInfo& in_force, bool fixed_step, double t0) {
  std::string remark;
  const Statistics& statistics = integrator.statistics;
  const std::string since = text(integrator.stiff_since) + " s";
  if (statistics.stiff && in_force.name == method.second_of_pair) {
    remark += "; stiff: went on with " + std::string(in_force.name) + " from t = " + since;
  } else if (statistics.stiff && method.kind == MethodKind::pair) {
    remark += "; stiff at t = " + since + ", but " + std::string(method.second_of_pair) +
              " does not pay: its steps can hardly be longer for their accuracy";
  } else if (statistics.stiff) {
    remark += "; from t = " + since +
              " on the steps are limited by stability, not by accuracy: the problem is stiff: "
              "method=\"radau5\" takes longer ones, and " +
              (fixed_step ? "\"dopri5-radau5\"" : "\"auto\"") + " changes over by itself";
  }
  if (statistics.njev > 0) {
    for (std::size_t i = 0; i < scene.effects.size(); ++i) {
      if (!std::holds_alternative<CompiledUser>(scene.effects[i])) continue;
      remark += "; derivatives of " + effect_name(scene, i) + " by differences";
    }
  }
  const std::size_t n = scene.links.size();
  const bool asks_users = equations.effects && !equations.effects->users.empty();
  if (statistics.limited_by_tolerance <= many_steps || scene.effects.empty() || n > many_links ||
      asks_users) {
    return remark;
  }
  const double* const y = integrator.y.data();
  const double h = std::abs(integrator.t.high - t0) / static_cast<double>(statistics.accepted);
  const auto mode = fast_mode(scene, equations, integrator.t.high, y, y + n);
  // What the steps were made for is about a radian a step, or the border of stability.
  if (!mode || !(0.01 < h * mode->fastest && h * mode->fastest < 10.0)) return remark;
  remark += "; a fast mode set " + std::to_string(statistics.limited_by_tolerance) +
            " steps: " + measure_of(*mode) + ", in joint " + std::to_string(mode->joint);
  if (mode->effect) remark += ", from " + effect_name(scene, *mode->effect);
  if (mode->damping_ratio < 0.5) {
    remark += ": as long as it swings, every method has to follow it; damp it, or lock the joint";
  }
  return remark;
}

}  // namespace pendcore
