#include "analysis/defect_correction.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "analysis/defect_correction_kernels.hpp"
#include "dynamics/equations_of_motion.hpp"

namespace pendcore {
namespace {

constexpr double lost_share = 0.2;  ///< of the total length
constexpr int divisions = 6;        ///< of a step, at which a dense run's errors are kept
constexpr double not_known = std::numeric_limits<double>::quiet_NaN();

}  // namespace

bool has_defect_correction(const Scene& scene) { return !laws_may_change(scene); }

/// A step, or what of it there is before an event.
struct DefectCorrection::Step {
  double t_start, t;  ///< s, where it begins, and where it ends
  double h;           ///< s
  double size;        ///< in theta
};

/// A neighbour of the run: its error now, and in the last step.
struct DefectCorrection::Neighbour {
  Neighbour(const Scene& scene, std::shared_ptr<const EquationsOfMotion> of_scene,
            std::vector<double> angles, const LobattoPoints& its_points)
      : equations(std::move(of_scene)),
        qdd_of(right_hand_side(*equations)),
        points(its_points),
        begin_step(begin_step_with(its_points.count)),
        n(scene.links.size()),
        q0(std::move(angles)),
        state(n, points.count),
        polynomials(n) {
    double total = 0.0;
    for (const Link& link : scene.links) total += link.length;
    for (const Link& link : scene.links) shares.push_back(link.length / total);
  }

  std::span<const double> error() const { return {state.e_q_at_end.data(), n}; }

  /// Begins at the start of the run, with the state y.
  void begin(double t, std::span<const double> y) {
    for (std::size_t link = 0; link < n; ++link) {
      state.e_q_at_end[link] = q0[link] - y[link];
      state.q[link] = q0[link];
      state.qd[link] = y[n + link];
    }
    evaluate(t);
  }

  void evaluate(double t) {
    qdd_of(t, state.q.data(), state.qd.data(), state.qdd.data());
    ++nfev;
  }

  void begin_at(const CurveOfStep& curve, const Step& step) {
    std::swap(state.e_q, state.e_q_at_end);
    std::swap(state.e_qd, state.e_qd_at_end);
    begin_step(points, curve, step.size, step.h, state);
  }

  /// Goes on to point i and evaluates the right-hand side there, or to the end.
  void advance(const Step& step, std::size_t i) {
    on_this_processor<&advance_to_point>(points, i, step.h, state);
    if (i < points.count) evaluate(step.t_start + points.theta[i] * step.h);
  }

  /// Where a step ends, the errors are those of the run's state again; the curve is off that by so
  /// much, (2 width).
  void end_step(const std::vector<double>& offset) {
    for (std::size_t link = 0; link < n; ++link) {
      state.e_q_at_end[link] += offset[link];
      state.e_qd_at_end[link] += offset[state.width + link];
    }
  }

  std::shared_ptr<const EquationsOfMotion> equations;
  RightHandSide qdd_of;
  const LobattoPoints& points;
  decltype(begin_step_with(0)) begin_step;
  std::size_t n;
  std::vector<double> q0;
  std::vector<double> shares{};  ///< of the links in the total length
  CorrectionState state;
  std::vector<LobattoPoints::Polynomial> polynomials;  ///< of the errors in the last step, (n)
  long long nfev = 0;
};

/// What a step needs for a moment.
struct DefectCorrection::Scratch {
  CurveOfStep curve;
  std::vector<double> offset;  ///< (2 width)
  std::vector<double> theta{};
  std::vector<const LobattoPoints::Polynomial*> polynomials{};

  explicit Scratch(std::size_t n) : curve(n), offset(2 * curve.width) {}
};

DefectCorrection::DefectCorrection() = default;
DefectCorrection::~DefectCorrection() = default;
DefectCorrection::DefectCorrection(DefectCorrection&&) noexcept = default;

void DefectCorrection::add(const Scene& scene, const std::vector<double>& q0,
                           std::span<const int> points) {
  if (!has_defect_correction(scene)) {
    throw std::invalid_argument(
        "scene: a law switches or a joint may be held: its runs have no defect correction");
  }
  const std::size_t n = scene.links.size();
  if (q0.size() != n || (!neighbours_.empty() && links() != n)) {
    throw std::invalid_argument("q0: the neighbours must have as many links, and angles, alike");
  }
  const auto equations = std::make_shared<const EquationsOfMotion>(equations_of_motion(scene));
  for (const int count : points) {
    neighbours_.push_back(std::make_unique<Neighbour>(scene, equations, q0, lobatto_points(count)));
  }
  if (!scratch_) scratch_ = std::make_unique<Scratch>(n);
}

void DefectCorrection::keep(Store store, const Options& options) {
  store_ = store;
  t_eval_ = options.t_eval;
}

void DefectCorrection::starts(double t, std::span<const double> y) {
  if (neighbours_.empty()) throw std::invalid_argument("correction: it has no neighbour");
  if (has_started_) throw std::invalid_argument("correction: it has looked on a run already");
  if (y.size() < 2 * links()) {
    throw std::invalid_argument("correction: its neighbours have more links than the run");
  }
  has_started_ = true;
  t_start_ = t;
  agreement_.t_known = t;
  for (const auto& one : neighbours_) one->begin(t, y);
  t_.reserve(t_eval_.size());
  errors_.reserve(t_eval_.size() * neighbours() * links());
  const bool is_asked_for = !t_eval_.empty() && t_eval_.front() == t;
  if (is_asked_for) ++next_time_;
  if (store_ != Store::times || is_asked_for) keep_errors_now(t);
}

void DefectCorrection::steps(const WatchedStep& watched) {
  if (watched.share == 0.0) return;  // an event at the start of a step
  const Step step{t_start_, watched.t, watched.share * watched.h, watched.share};
  if (store_ == Store::end) {
    t_.clear();
    errors_.clear();
  }
  const bool goes_on = !agreement_.is_lost();
  if (goes_on) {
    take_curve(watched);
    go_on(step);
    end_step(watched);
  }
  keep_errors(step);
  t_start_ = step.t;
  if (goes_on) compare();
}

void DefectCorrection::take_curve(const WatchedStep& step) {
  CurveOfStep& curve = scratch_->curve;
  curve.degree = static_cast<std::size_t>(step.degree) + 1;
  const std::size_t size = (curve.degree + 1) * curve.width;
  curve.powers.resize(2 * size);
  curve.angle_offset.resize(size);
  on_this_processor<&set_curve>(step.rows(), step.y.size(), step.h, &curve);
}

/// The neighbours go on side by side, so that a processor works on several of them at once.
void DefectCorrection::go_on(const Step& step) {
  for (const auto& one : neighbours_) one->begin_at(scratch_->curve, step);
  for (std::size_t i = 1; i <= LobattoPoints::most; ++i) {
    for (const auto& one : neighbours_) {
      if (i <= one->points.count) one->advance(step, i);
    }
  }
}

void DefectCorrection::end_step(const WatchedStep& step) {
  Scratch& scratch = *scratch_;
  on_this_processor<&offset_from_state>(scratch.curve, step.share, step.y.data(),
                                        scratch.offset.data());
  for (const auto& one : neighbours_) one->end_step(scratch.offset);
}

void DefectCorrection::compare() {
  double between = 0.0;
  double largest = 0.0;
  for (std::size_t link = 0; link < links(); ++link) {
    const double share = neighbours_.front()->shares[link];
    const double first = neighbours_.front()->error()[link];
    const double second =
        neighbours_[std::min<std::size_t>(1, neighbours_.size() - 1)]->error()[link];
    between += share * std::abs(first - second);
    largest += share * std::max(std::abs(first), std::abs(second));
  }
  if (!(largest <= lost_share && between <= lost_share)) {  // NaN too
    agreement_.at_loss =
        std::isfinite(between + largest) ? largest : std::numeric_limits<double>::infinity();
    return;
  }
  agreement_.between = std::max(agreement_.between, between);
  agreement_.largest = std::max(agreement_.largest, largest);
  agreement_.t_known = t_start_;
}

void DefectCorrection::keep_errors(const Step& step) {
  std::vector<double>& theta = scratch_->theta;
  theta.clear();
  if (store_ == Store::times) {
    const std::size_t first = next_time_;
    for (; next_time_ < t_eval_.size(); ++next_time_) {
      const double t = t_eval_[next_time_];
      if ((t - step.t) * std::copysign(1.0, step.h) > 0.0) break;
      if (t == step.t) continue;
      theta.push_back((t - step.t_start) / step.h);
    }
    const std::size_t end = first + theta.size();
    keep_errors_within(step, t_eval_.data() + first);
    for (std::size_t i = end; i < next_time_; ++i) keep_errors_now(step.t);
    return;
  }
  if (store_ == Store::dense) {
    std::array<double, divisions - 1> t;
    for (int k = 1; k < divisions; ++k) {
      theta.push_back(static_cast<double>(k) / divisions);
      t[k - 1] = step.t_start + theta.back() * step.h;
    }
    keep_errors_within(step, t.data());
  }
  keep_errors_now(step.t);
}

/// Keeps the errors at all theta of the scratch, where the times are t.
void DefectCorrection::keep_errors_within(const Step& step, const double* t) {
  Scratch& scratch = *scratch_;
  if (scratch.theta.empty()) return;
  t_.insert(t_.end(), t, t + scratch.theta.size());
  double* const errors = append(scratch.theta.size());
  if (agreement_.is_lost()) return;
  scratch.polynomials.clear();
  for (const auto& one : neighbours_) {
    on_this_processor<&error_polynomials>(one->points, step.h, one->state, one->polynomials.data());
    scratch.polynomials.push_back(one->polynomials.data());
  }
  on_this_processor<&errors_within>(
      ErrorsWithin{&scratch.curve, step.size, scratch.polynomials, scratch.theta, errors});
}

void DefectCorrection::keep_errors_now(double t) {
  t_.push_back(t);
  double* to = append(1);
  if (agreement_.is_lost()) return;
  for (const auto& one : neighbours_) to = std::ranges::copy(one->error(), to).out;
}

std::vector<double> DefectCorrection::errors_at_end() const {
  std::vector<double> errors;
  for (const auto& one : neighbours_) {
    errors.insert(errors.end(), one->error().begin(), one->error().end());
  }
  if (agreement_.is_lost()) std::ranges::fill(errors, not_known);
  return errors;
}

long long DefectCorrection::nfev() const {
  long long sum = 0;
  for (const auto& one : neighbours_) sum += one->nfev;
  return sum;
}

std::size_t DefectCorrection::links() const {
  return neighbours_.empty() ? 0 : neighbours_.front()->n;
}

/// Makes room for the errors at so many times, which are not known yet.
double* DefectCorrection::append(std::size_t times) {
  const std::size_t size = times * neighbours() * links();
  errors_.resize(errors_.size() + size, not_known);
  return errors_.data() + (errors_.size() - size);
}

}  // namespace pendcore
