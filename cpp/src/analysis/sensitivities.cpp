#include "analysis/sensitivities.hpp"

#include <algorithm>
#include <cmath>
#include <Eigen/LU>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "arithmetic/sine_cosine.hpp"
#include "dynamics/equations_of_motion.hpp"
#include "dynamics/inverse_dynamics.hpp"
#include "dynamics/jacobian.hpp"
#include "dynamics/joint_forces.hpp"
#include "integrate/horner.hpp"
#include "pendcore/effects/lock.hpp"
#include "pendcore/parameters.hpp"
#include "scene/effects_of_scene.hpp"
#include "text/message.hpp"

namespace pendcore {
namespace {

/// Legendre's polynomials P_0 .. P_{count - 1} at 2 theta - 1.
Vector legendre(int count, double theta) {
  const double x = 2.0 * theta - 1.0;
  Vector p(count);
  for (int k = 0; k < count; ++k) {
    p[k] = k == 0 ? 1.0 : k == 1 ? x : ((2 * k - 1) * x * p[k - 1] - (k - 1) * p[k - 2]) / k;
  }
  return p;
}

/// The collocation at the points of a Gauss quadrature of a step from theta = 0 to 1.
struct Collocation {
  explicit Collocation(int points);

  /// With them, a row of the values of f at the points, (s), gives the integral of f from 0 to
  /// theta, and the integral of that.
  struct Integrals {
    Vector once, twice;
  };
  Integrals integrals(double theta) const;

  int s;
  Vector theta, weight;
  Matrix to_legendre;  ///< from values at the points to the coefficients of P_k, (s, s)
  std::vector<Integrals> to_point;
  Integrals to_end;
};

Collocation::Collocation(int points) : s(points), theta(points), weight(points) {
  for (int i = 0; i < s; ++i) {  // Newton's method, from Tricomi's estimate
    double sine, cosine;
    sine_cosine(std::numbers::pi * (i + 0.75) / (s + 0.5), sine, cosine);
    double x = 0.5 - 0.5 * cosine;
    double slope = 0.0;
    for (int round = 0; round < 8; ++round) {
      const Vector p = legendre(s + 1, x);
      const double at = 2.0 * x - 1.0;
      slope = 2.0 * s * (p[s - 1] - at * p[s]) / (1.0 - at * at);
      x -= p[s] / slope;
    }
    theta[i] = x;
    weight[i] = 4.0 / ((1.0 - (2.0 * x - 1.0) * (2.0 * x - 1.0)) * slope * slope);
  }
  to_legendre.resize(s, s);
  for (int j = 0; j < s; ++j) {
    const Vector p = legendre(s, theta[j]);
    for (int k = 0; k < s; ++k) to_legendre(k, j) = (2 * k + 1) * weight[j] * p[k];
  }
  for (int i = 0; i < s; ++i) to_point.push_back(integrals(theta[i]));
  to_end = integrals(1.0);
}

Collocation::Integrals Collocation::integrals(double at) const {
  const Vector p = legendre(s + 3, at);
  Vector once(s + 1), twice(s);  // of P_k
  for (int k = 0; k <= s; ++k) {
    once[k] = k == 0 ? at : (p[k + 1] - p[k - 1]) / (2.0 * (2 * k + 1));
  }
  for (int k = 0; k < s; ++k) {
    twice[k] = k == 0 ? 0.5 * at * at : (once[k + 1] - once[k - 1]) / (2.0 * (2 * k + 1));
  }
  return {to_legendre.transpose() * once.head(s), to_legendre.transpose() * twice};
}

/// The collocation that suits a dense output of a degree.
const Collocation& collocation_for(int degree) {
  static const std::vector<Collocation> all = [] {
    std::vector<Collocation> made;
    for (int s = 4; s <= 16; ++s) made.emplace_back(s);
    return made;
  }();
  return all[std::clamp((degree + 5) / 2, 4, 16) - 4];
}

/// The number of the column of q0 or qd0 that a name means, from 0, or -1.
int column_of_start(const std::string& name, const std::string& kind, int n) {
  if (!name.starts_with(kind)) return -1;
  for (int i = 0; i < n; ++i) {
    if (name == kind + "[" + std::to_string(i + 1) + "]") return i;
  }
  throw std::invalid_argument("sensitivities: \"" + name + "\": must be " + kind + "[1] to " +
                              kind + "[" + std::to_string(n) + "]");
}

void require_smooth(const Scene& scene) {
  for (std::size_t i = 0; i < scene.effects.size(); ++i) {
    const Effect& effect = scene.effects[i];
    if (!effect.info().jumps_or_sticks && !effect.is<Lock>()) continue;
    throw std::invalid_argument(
        "sensitivities: " + effect_name(scene, i) +
        ": what changes with a start or a parameter jumps where a joint sticks, slides or bounces, "
        "and has no value where it is locked; leave this effect out, or compare two runs");
  }
}

constexpr int most_halvings_of_step = 44;

}  // namespace

struct Sensitivities::Variation {
  Variation(const Scene& given, const std::vector<std::string>& names)
      : scene(given),
        n(static_cast<int>(given.links.size())),
        k(static_cast<Eigen::Index>(names.size())),
        equations(equations_of_motion(given)),
        jacobian(given, equations),
        forces(given),
        now(Matrix::Zero(2 * n, k)) {
    for (int j = 0; j < n; ++j) forces.joints.push_back(j);
    for (Eigen::Index column = 0; column < k; ++column) {
      const std::string& name = names[static_cast<std::size_t>(column)];
      const int angle = column_of_start(name, "q0", n);
      const int rate = column_of_start(name, "qd0", n);
      if (angle >= 0) {
        now(angle, column) = 1.0;
      } else if (rate >= 0) {
        now(n + rate, column) = 1.0;
      } else {
        require_parameter(name);
        names_of_parameters.push_back(name);
        parameters.push_back({column, {}});
      }
    }
  }

  struct Parameter {
    Eigen::Index column;
    Mechanism<Dual<double>> mechanism;
  };

  /// What the variational equations are at a point of a step.
  struct Point {
    Matrix by_q, by_qd;  ///< (n, n)
    Matrix by_name;      ///< (n, k)
  };

  void start(double t, std::span<const double> y);
  void take(const WatchedStep& step);
  void require_parameter(const std::string& name) const;
  void choose_modes_at(double t, const Vector& y);
  void refuse_from(double t, const std::string& why);
  Point at(double t, const Vector& y);
  bool has_converged(const Collocation& points, const Matrix& found, double h) const;
  void advance(const WatchedStep& step, double from, double to, int halvings);
  Vector state(const WatchedStep& step, double theta) const;
  /// Whether the next time that is kept lies in a step.
  bool is_due(const WatchedStep& step) const {
    return next_time < t_eval.size() && (t_eval[next_time] - step.t) * step.h <= 0.0;
  }
  void keep_now() { values.insert(values.end(), now.data(), now.data() + now.size()); }

  Scene scene;
  int n;
  Eigen::Index k;
  EquationsOfMotion equations;
  Jacobian jacobian;
  JointForces forces;
  InverseDynamics<Dual<double>> inverse_dynamics{};
  std::vector<Parameter> parameters{};
  std::vector<std::string> names_of_parameters{};
  std::optional<std::vector<int>> modes{};  ///< for which the mechanisms are made
  Matrix now;                               ///< (2n, k)
  double t_start = 0.0;

  bool has_started = false;
  bool keeps_end = true;
  bool keeps_times = false;
  std::vector<double> t_eval{};
  std::size_t next_time = 0;
  std::vector<double> values{};
  std::string refusal{};
};

void Sensitivities::Variation::require_parameter(const std::string& name) const {
  if (name.starts_with("q[") || name.starts_with("qd[")) {
    throw std::invalid_argument("sensitivities: \"" + name +
                                "\": a start is named q0[i] or qd0[i]");
  }
  const ParameterChoice known(scene, {name});  // throws for a name that is none
}

/// From a time on, there are no derivatives.
void Sensitivities::Variation::refuse_from(double t, const std::string& why) {
  refusal = "sensitivities: none after t = " + text(t) + " s: " + why;
  now.setConstant(std::numeric_limits<double>::quiet_NaN());
}

/// Puts the laws in the modes of the middle of a step.
void Sensitivities::Variation::choose_modes_at(double t, const Vector& y) {
  if (equations.effects) choose_modes(*equations.effects, t, y.data(), y.data() + n, true);
  std::vector<int> chosen = modes_at(scene, t, y.data(), y.data() + n);
  if (modes && chosen == *modes) return;
  modes = std::move(chosen);
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    parameters[i].mechanism = mechanism_along(scene, *modes, t, names_of_parameters, i);
  }
}

Sensitivities::Variation::Point Sensitivities::Variation::at(double t, const Vector& y) {
  Point point{.by_q = Matrix(n, n), .by_qd = Matrix(n, n), .by_name = Matrix::Zero(n, k)};
  jacobian(t, y.data(), y.data() + n, point.by_q, point.by_qd);
  if (parameters.empty()) return point;
  Vector qdd(n);
  accelerations_in_force(equations, t, y.data(), y.data() + n, qdd.data());
  forces.set_mass_matrix(y.data());
  forces.set_up();
  const Numbers q(y.head(n)), qd(y.segment(n, n));
  for (const Parameter& one : parameters) {
    point.by_name.col(one.column) = inverse_dynamics.change(one.mechanism, t, q, qd, qdd, forces);
  }
  return point;
}

Vector Sensitivities::Variation::state(const WatchedStep& step, double theta) const {
  const auto size = static_cast<int>(step.y.size());
  Vector y(2 * n);
  for (int i = 0; i < 2 * n; ++i) y[i] = horner<double>(step.rows + i, step.degree, size, theta);
  return y;
}

/// Whether d(dqd)/dt, with these values at the points, is a polynomial: by the last two of
/// Legendre's coefficients, for each name alone. Where they fall like a geometric series, the error
/// at the end of the step is of the order of their square. At a kink they do not.
bool Sensitivities::Variation::has_converged(const Collocation& points, const Matrix& found,
                                             double h) const {
  constexpr double rounding = 1e-14;
  constexpr double square_root_of_rounding = 3e-7;
  if (!found.allFinite()) return false;
  const int s = points.s;
  const auto coefficient = [&](int p) {
    Matrix sum = Matrix::Zero(n, k);
    for (int j = 0; j < s; ++j) sum += points.to_legendre(p, j) * found.middleRows(j * n, n);
    return Vector(sum.cwiseAbs().colwise().maxCoeff().transpose());
  };
  const Vector last = coefficient(s - 1).cwiseMax(coefficient(s - 2));
  const Vector middle = coefficient(s / 2).cwiseMax(coefficient(s / 2 - 1));
  for (Eigen::Index column = 0; column < k; ++column) {
    const double largest = found.col(column).cwiseAbs().maxCoeff();
    const double size = now.col(column).cwiseAbs().maxCoeff() + std::abs(h) * largest;
    const bool falls = last[column] * largest <= 100.0 * middle[column] * middle[column];
    const double allowed = falls ? square_root_of_rounding : rounding;
    if (std::abs(h) * last[column] > allowed * size) return false;
  }
  return true;
}

/// Advances through the part of a step between two shares of it.
void Sensitivities::Variation::advance(const WatchedStep& step, double from, double to,
                                       int halvings) {
  const Collocation& points = collocation_for(step.degree);
  const int s = points.s;
  const double h = (to - from) * step.h;
  Matrix system = Matrix::Identity(n * s, n * s);
  Matrix right(n * s, k);
  const Matrix angles = now.topRows(n), rates = now.bottomRows(n);
  for (int i = 0; i < s; ++i) {
    const double theta = from + points.theta[i] * (to - from);
    const Point here = at(t_start + theta * step.h, state(step, theta));
    const Collocation::Integrals& integrals = points.to_point[i];
    for (int j = 0; j < s; ++j) {
      const double by_angle = h * h * integrals.twice[j];
      const double by_rate = h * integrals.once[j];
      for (int r = 0; r < n; ++r) {
        for (int c = 0; c < n; ++c) {
          system(i * n + r, j * n + c) -= by_angle * here.by_q(r, c) + by_rate * here.by_qd(r, c);
        }
      }
    }
    right.middleRows(i * n, n) =
        here.by_q * (angles + points.theta[i] * h * rates) + here.by_qd * rates + here.by_name;
  }
  const Matrix found = system.partialPivLu().solve(right);  // d(dqd)/dt at the points, (s n, k)

  if (!has_converged(points, found, h)) {
    const double middle = 0.5 * (from + to);
    if (halvings == most_halvings_of_step || middle == from || middle == to) {
      refuse_from(t_start + from * step.h,
                  "the motion has a corner there, or grows beyond numbers");
      return;
    }
    advance(step, from, middle, halvings + 1);
    if (refusal.empty()) advance(step, middle, to, halvings + 1);
    return;
  }
  now.topRows(n) += h * rates;
  for (int j = 0; j < s; ++j) {
    const auto at_point = found.middleRows(j * n, n);
    now.topRows(n) += h * h * points.to_end.twice[j] * at_point;
    now.bottomRows(n) += h * points.to_end.once[j] * at_point;
  }
}

void Sensitivities::Variation::start(double t, std::span<const double> y) {
  if (has_started) throw std::invalid_argument("sensitivities: have seen a run already");
  if (y.size() < static_cast<std::size_t>(2 * n)) {
    throw std::invalid_argument("sensitivities: are for a scene with more links than the run's");
  }
  has_started = true;
  t_start = t;
  choose_modes_at(t, View(y.data(), 2 * n));
  const bool is_asked_for = !t_eval.empty() && t_eval.front() == t;
  if (is_asked_for) ++next_time;
  if (!keeps_times || is_asked_for) keep_now();
}

void Sensitivities::Variation::take(const WatchedStep& step) {
  if (step.share == 0.0) return;  // an event at the start of a step
  if (refusal.empty()) {
    const double middle = 0.5 * step.share;
    const double t = t_start + middle * step.h;
    try {
      choose_modes_at(t, state(step, middle));
    } catch (const std::invalid_argument& error) {
      refuse_from(t_start, error.what());
    }
  }
  // A time that is kept is the end of a part: there, the order is highest.
  double from = 0.0;
  for (; keeps_times && is_due(step); ++next_time) {
    const double t = t_eval[next_time];
    const double to = t == step.t ? step.share : (t - t_start) / step.h;
    if (refusal.empty()) advance(step, from, to, 0);
    keep_now();
    from = to;
  }
  if (from != step.share && refusal.empty()) advance(step, from, step.share, 0);
  t_start = step.t;
  if (keeps_times) return;
  if (keeps_end) values.clear();
  keep_now();
}

Sensitivities::Sensitivities(const Scene& scene, const std::vector<std::string>& names) {
  require_smooth(scene);
  variation_ = std::make_unique<Variation>(scene, names);
}
Sensitivities::~Sensitivities() = default;
Sensitivities::Sensitivities(Sensitivities&&) noexcept = default;

void Sensitivities::keep(Store store, const std::vector<double>& t_eval) {
  variation_->keeps_end = store == Store::end;
  variation_->keeps_times = store == Store::times || (store == Store::dense && !t_eval.empty());
  variation_->t_eval = t_eval;
}

void Sensitivities::starts(double t, std::span<const double> y) { variation_->start(t, y); }
void Sensitivities::steps(const WatchedStep& step) { variation_->take(step); }
void Sensitivities::jumps(double /*t*/, std::span<const double> /*y*/) {}

const std::string& Sensitivities::refusal() const { return variation_->refusal; }
const std::vector<double>& Sensitivities::values() const { return variation_->values; }
std::size_t Sensitivities::states() const { return static_cast<std::size_t>(2 * variation_->n); }
std::size_t Sensitivities::names() const { return static_cast<std::size_t>(variation_->k); }

}  // namespace pendcore
