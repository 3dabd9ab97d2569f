#include "simulate/fast_mode.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <vector>

#include "arithmetic/eigenvalues.hpp"
#include "dynamics/jacobian.hpp"
#include "scene/effects_of_scene.hpp"
#include "text/message.hpp"

namespace pendcore {
namespace {

/// A and B of qdd = A q + B qd about a state, row by row.
struct Linearized {
  std::vector<double> by_q;
  std::vector<double> by_qd;
};

Linearized linearized(const Scene& scene, const EquationsOfMotion& equations, double t,
                      const double* q, const double* qd) {
  const std::size_t n = scene.links.size();
  Linearized result{std::vector<double>(n * n), std::vector<double>(n * n)};
  Jacobian(scene, equations)(t, q, qd, result.by_q.data(), result.by_qd.data());
  return result;
}

/// ((0, 1), (A, B))
std::vector<double> first_order(const Linearized& second_order, std::size_t n) {
  std::vector<double> whole(4 * n * n);
  for (std::size_t i = 0; i < n; ++i) {
    whole[2 * n * i + n + i] = 1.0;
    double* const row = &whole[2 * n * (n + i)];
    std::copy_n(&second_order.by_q[n * i], n, row);
    std::copy_n(&second_order.by_qd[n * i], n, row + n);
  }
  return whole;
}

/// The largest sum of the sizes in a row.
double norm(const std::vector<double>& matrix, std::size_t n) {
  double largest = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    double sum = 0.0;
    for (std::size_t j = 0; j < n; ++j) sum += std::abs(matrix[n * i + j]);
    largest = std::max(largest, sum);
  }
  return largest;
}

/// No |lambda| is larger: |lambda|^2 <= |B| |lambda| + |A|.
double bound_of(const Linearized& second_order, std::size_t n) {
  const double of_q = norm(second_order.by_q, n);
  const double of_qd = norm(second_order.by_qd, n);
  return 0.5 * (of_qd + std::sqrt(of_qd * of_qd + 4.0 * of_q));
}

/// The same bound for a scene alone, in the modes that the state calls for.
double bound_of(const Scene& scene, double t, const double* q, const double* qd) {
  const EquationsOfMotion equations = equations_of_motion(scene);
  if (equations.effects) choose_modes(*equations.effects, t, q, qd, true);
  return bound_of(linearized(scene, equations, t, q, qd), scene.links.size());
}

std::string short_text(double x) {
  char digits[32];
  std::snprintf(digits, sizeof digits, "%.3g", x);
  return digits;
}

/// The frequency and damping ratio of a mode in words; for an overdamped mode, the rate at which it
/// dies out.
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
  const std::size_t n = scene.links.size();
  const Linearized whole = linearized(scene, equations, t, q, qd);
  const auto is_finite = [](double x) { return std::isfinite(x); };
  if (!std::ranges::all_of(whole.by_q, is_finite) || !std::ranges::all_of(whole.by_qd, is_finite)) {
    return std::nullopt;
  }
  const Scene links{.links = scene.links, .gravity = scene.gravity};
  const double slow = far_faster * bound_of(links, t, q, qd);
  if (!(bound_of(whole, n) > slow)) return std::nullopt;  // the usual case: no eigenvalue is needed
  const auto [values, vectors] = eigenpairs(first_order(whole, n), static_cast<int>(2 * n));
  const auto sizes = [](std::complex<double> a, std::complex<double> b) {
    return std::abs(a) < std::abs(b);
  };
  const std::size_t first = std::ranges::max_element(values, sizes) - values.begin();
  if (!(std::abs(values[first]) > slow)) return std::nullopt;

  // The partner of the fastest is its conjugate, or the real one that moves the links most alike.
  const auto angles_of = [&, &vectors = vectors](std::size_t k) { return &vectors[2 * n * k]; };
  const auto product = [n](const std::complex<double>* a, const std::complex<double>* b) {
    std::complex<double> sum = 0.0;
    for (std::size_t i = 0; i < n; ++i) sum += std::conj(a[i]) * b[i];
    return std::abs(sum);
  };
  const std::complex<double>* const fastest = angles_of(first);
  std::size_t second = first;
  double most_alike = -1.0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (k == first) continue;
    const bool is_conjugate = values[k] == std::conj(values[first]) && values[k].imag() != 0.0;
    const std::complex<double>* const other = angles_of(k);
    const double size = std::sqrt(product(other, other) * product(fastest, fastest));
    const bool is_real = values[k].imag() == 0.0 && values[first].imag() == 0.0;
    const double alike = is_conjugate ? 2.0 : is_real ? product(other, fastest) / size : -1.0;
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
  for (std::size_t j = 0; j < n; ++j) {
    const std::complex<double> before = j > 0 ? fastest[j - 1] : 0.0;
    const double turned = std::abs(fastest[j] - before);
    if (turned > largest) {
      largest = turned;
      mode.joint = static_cast<int>(j) + 1;
    }
  }
  double slowest = 0.5 * bound_of(whole, n);
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
    const int joint = scene.effects[*mode.effect]->joint();
    if (joint > 0) mode.joint = joint;
  }
  return mode;
}

std::string remark_on_steps(const Scene& scene, const EquationsOfMotion& equations,
                            const IntegratorState& integrator, const MethodInfo& method,
                            const MethodInfo& in_force, bool fixed_step, double t0) {
  std::string remark;
  const Statistics& statistics = integrator.statistics;
  const auto since = [&integrator] { return text(integrator.stiff_since) + " s"; };
  if (statistics.stiff && in_force.name == method.second_of_pair) {
    remark += "; stiff: went on with " + std::string(in_force.name) + " from t = " + since();
  } else if (statistics.stiff && method.kind == MethodKind::pair) {
    remark += "; stiff at t = " + since() + ", but " + std::string(method.second_of_pair) +
              " does not pay: accuracy hardly allows it longer steps";
  } else if (statistics.stiff) {
    remark += "; from t = " + since() +
              " on the steps are limited by stability, not by accuracy: the problem is stiff: "
              "method=\"radau5\" takes longer ones, and " +
              (fixed_step ? "\"dopri5-radau5\"" : "\"auto\"") + " changes over by itself";
  }
  if (statistics.njev > 0) {
    for (std::size_t i = 0; i < scene.effects.size(); ++i) {
      if (!scene.effects[i].info().is_function) continue;
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
  // The mode that set the steps turns by about a radian a step, or is at the border of stability.
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
