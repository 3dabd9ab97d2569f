#include "analysis/sensitivities.hpp"

#include <algorithm>
#include <cmath>
#include <Eigen/LU>
#include <limits>
#include <stdexcept>

#include "analysis/gauss_collocation.hpp"
#include "analysis/saltation.hpp"
#include "integrate/horner.hpp"
#include "text/message.hpp"

namespace pendcore {
namespace {

constexpr int most_halvings_of_step = 44;

}  // namespace

struct Sensitivities::Variation {
  Variation(const Scene& scene, const std::vector<std::string>& names)
      : equations(scene, names), n(equations.links()), now(equations.changes_of_start()) {}

  void start(double t, std::span<const double> y);
  void take(const WatchedStep& step);
  void change_laws(const WatchedChange& change);
  void refuse_from(double t, const std::string& why);
  bool has_converged(const GaussCollocation& points, const Matrix& found, double h) const;
  void advance(const WatchedStep& step, double from, double to, int halvings);
  Vector state(const WatchedStep& step, double theta) const;
  /// Whether the next time that is kept lies in a step.
  bool is_due(const WatchedStep& step) const {
    return next_time < t_eval.size() && (t_eval[next_time] - step.t) * step.h <= 0.0;
  }
  void keep(double t);
  void take_back_last() { values.resize(values.size() - static_cast<std::size_t>(now.size())); }

  VariationalEquations equations;
  std::optional<Saltation> saltation{};  ///< of a scene whose laws change
  int n;
  Matrix now;  ///< (2n, k); NaN where there are none
  double t_start = 0.0;

  bool has_started = false;
  bool keeps_end = true;
  bool keeps_times = false;
  std::vector<double> t_eval{};
  std::size_t next_time = 0;
  double t_kept = std::numeric_limits<double>::quiet_NaN();  ///< s, of the last values
  std::vector<double> values{};
  std::string refusal{};
  bool is_over = false;  ///< no name has a derivative any more
};

void Sensitivities::Variation::keep(double t) {
  if (keeps_end) values.clear();
  values.insert(values.end(), now.data(), now.data() + now.size());
  t_kept = t;
}

/// From a time on, there are no derivatives.
void Sensitivities::Variation::refuse_from(double t, const std::string& why) {
  refusal = "sensitivities: none after t = " + text(t) + " s: " + why;
  is_over = true;
  now.setConstant(std::numeric_limits<double>::quiet_NaN());
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
bool Sensitivities::Variation::has_converged(const GaussCollocation& points, const Matrix& found,
                                             double h) const {
  constexpr double rounding = 1e-14;
  constexpr double square_root_of_rounding = 3e-7;
  const int s = points.s;
  const auto coefficient = [&](int p) {
    Matrix sum = Matrix::Zero(n, now.cols());
    for (int j = 0; j < s; ++j) sum += points.to_legendre(p, j) * found.middleRows(j * n, n);
    return Vector(sum.cwiseAbs().colwise().maxCoeff().transpose());
  };
  const Vector last = coefficient(s - 1).cwiseMax(coefficient(s - 2));
  const Vector middle = coefficient(s / 2).cwiseMax(coefficient(s / 2 - 1));
  for (Eigen::Index column = 0; column < now.cols(); ++column) {
    if (!now.col(column).allFinite()) continue;
    if (!found.col(column).allFinite()) return false;
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
  const GaussCollocation& points = collocation_for(step.degree);
  const int s = points.s;
  const double h = (to - from) * step.h;
  Matrix system = Matrix::Identity(n * s, n * s);
  Matrix right(n * s, now.cols());
  const Matrix angles = now.topRows(n), rates = now.bottomRows(n);
  for (int i = 0; i < s; ++i) {
    const double theta = from + points.theta[i] * (to - from);
    const VariationalEquations::Point here =
        equations.at(t_start + theta * step.h, state(step, theta));
    const GaussCollocation::Integrals& integrals = points.to_point[i];
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
    if (!is_over) advance(step, middle, to, halvings + 1);
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
  equations.choose_laws(t, y.data());
  const bool is_asked_for = !t_eval.empty() && t_eval.front() == t;
  if (is_asked_for) ++next_time;
  if (!keeps_times || is_asked_for) keep(t);
}

void Sensitivities::Variation::take(const WatchedStep& step) {
  if (step.share == 0.0) return;  // an event at the start of a step
  // A time that is kept is the end of a part: there, the order is highest.
  double from = 0.0;
  for (; keeps_times && is_due(step); ++next_time) {
    const double t = t_eval[next_time];
    const double to = t == step.t ? step.share : (t - t_start) / step.h;
    if (!is_over) advance(step, from, to, 0);
    keep(t);
    from = to;
  }
  if (from != step.share && !is_over) advance(step, from, step.share, 0);
  t_start = step.t;
  if (!keeps_times) keep(step.t);
}

/// The run keeps a state after a jump beside the one before it, where it keeps its steps; otherwise
/// the state after takes its place.
void Sensitivities::Variation::change_laws(const WatchedChange& change) {
  if (!saltation) saltation.emplace(equations);
  if (!is_over) {
    try {
      if (change.at_start) {
        refusal = saltation->start(change, now);
        is_over = !now.array().isFinite().any();
      } else if (const std::string why = saltation->pass(change, now); !why.empty()) {
        refuse_from(change.t, why);
      }
    } catch (const std::invalid_argument& error) {
      refuse_from(change.t, error.what());
    }
  }
  const bool keeps_steps = !keeps_end && !keeps_times;
  if (t_kept != change.t && !(keeps_steps && change.jumped)) return;
  if (!keeps_end && !(keeps_steps && change.jumped)) take_back_last();
  keep(change.t);
}

Sensitivities::Sensitivities(const Scene& scene, const std::vector<std::string>& names)
    : variation_(std::make_unique<Variation>(scene, names)) {}
Sensitivities::~Sensitivities() = default;
Sensitivities::Sensitivities(Sensitivities&&) noexcept = default;

void Sensitivities::keep(Store store, const std::vector<double>& t_eval) {
  variation_->keeps_end = store == Store::end;
  variation_->keeps_times = store == Store::times || (store == Store::dense && !t_eval.empty());
  variation_->t_eval = t_eval;
}

void Sensitivities::starts(double t, std::span<const double> y) { variation_->start(t, y); }
void Sensitivities::steps(const WatchedStep& step) { variation_->take(step); }
void Sensitivities::changes(const WatchedChange& change) { variation_->change_laws(change); }

const std::string& Sensitivities::refusal() const { return variation_->refusal; }
const std::vector<double>& Sensitivities::values() const { return variation_->values; }
std::size_t Sensitivities::states() const { return static_cast<std::size_t>(2 * variation_->n); }
std::size_t Sensitivities::names() const {
  return static_cast<std::size_t>(variation_->now.cols());
}

}  // namespace pendcore
