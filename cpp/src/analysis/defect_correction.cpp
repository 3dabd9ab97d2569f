#include "pendcore/analysis/defect_correction.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "pendcore/analysis/defect_correction_kernels.hpp"
#include "pendcore/analysis/lobatto_points.hpp"
#include "pendcore/arithmetic/instruction_set.hpp"
#include "pendcore/dynamics/equations_of_motion.hpp"
#include "pendcore/simulate/switching.hpp"

namespace pendcore {
using namespace defect_detail;
namespace {

constexpr double lost = 0.2;  ///< of the total length
constexpr int divisions = 6;  ///< of a part, at which a dense run's errors are kept
constexpr double not_known = std::numeric_limits<double>::quiet_NaN();

}  // namespace

bool has_defect_correction(const Scene& scene) { return !Switching::is_needed(scene); }

/// A part of a step, from one theta of its curve on.
struct DefectCorrection::Part {
  double from, size;  ///< in theta
  double t_start, t;  ///< s, where the part begins, and where it ends
  double h;           ///< s
};

/// A neighbour of the run: its error now, and along the last part of a step.
struct DefectCorrection::Neighbour {
  Neighbour(const Scene& scene, std::shared_ptr<const EquationsOfMotion> of_scene,
            std::vector<double> angles, const LobattoPoints& its_points)
      : equations(std::move(of_scene)),
        qdd_of(right_hand_side(*equations)),
        points(its_points),
        set_out_kernel(set_out_for(its_points.count)),
        go_on_kernel(fastest<&defect_detail::go_on>()),
        n(scene.links.size()),
        q0(std::move(angles)),
        memory(n, points.count),
        along(n) {
    double total = 0.0;
    for (const Link& link : scene.links) total += link.length;
    for (const Link& link : scene.links) shares.push_back(link.length / total);
  }

  double* e_q() { return memory.end_e_q.data(); }
  double* e_qd() { return memory.end_e_qd.data(); }

  /// It is lost: nothing of its error is known any more.
  void forget() {
    std::ranges::fill(memory.e_q, not_known);
    std::ranges::fill(memory.end_e_q, not_known);
  }

  /// Begins at the start of the run, with the state y.
  void begin(double t, std::span<const double> y) {
    for (std::size_t link = 0; link < n; ++link) {
      e_q()[link] = q0[link] - y[link];
      memory.q[link] = q0[link];
      memory.qd[link] = y[n + link];
    }
    take(t);
  }

  void take(double t) {
    qdd_of(t, memory.q.data(), memory.qd.data(), memory.qdd.data());
    ++nfev;
  }

  void set_out(const CurveOfStep& curve, const Part& part) {
    std::swap(memory.e_q, memory.end_e_q);
    std::swap(memory.e_qd, memory.end_e_qd);
    set_out_kernel(points, curve, part.from, part.size, part.h, memory);
  }

  /// Goes on to point i and takes the right-hand side there, or to the end.
  void go_on(const Part& part, std::size_t i) {
    go_on_kernel(points, i, part.h, memory);
    if (i < points.count) take(part.t_start + points.theta[i] * part.h);
  }

  /// Where a step ends, the errors are those of the run's state again, (2 row) off the curve.
  void jump(const double* by) {
    for (std::size_t link = 0; link < n; ++link) {
      e_q()[link] += by[link];
      e_qd()[link] += by[memory.row + link];
    }
  }

  /// Makes the polynomials of the errors of the angles along the last part, of length h, s.
  void look_along(double h) {
    static const auto look = fastest<&defect_detail::look_along>();
    look(points, h, memory, along.data());
  }

  std::shared_ptr<const EquationsOfMotion> equations;
  RightHandSide qdd_of;
  const LobattoPoints& points;
  SetOut set_out_kernel;
  GoOn go_on_kernel;
  std::size_t n;
  std::vector<double> q0;
  std::vector<double> shares{};  ///< of the links in the total length
  Memory memory;
  std::vector<LobattoPoints::Polynomial> along;  ///< (n)
  long long nfev = 0;
};

DefectCorrection::DefectCorrection(int parts) : parts_(parts) {
  if (parts < 1) {
    throw std::invalid_argument("parts = " + std::to_string(parts) + ": must be >= 1");
  }
}
DefectCorrection::~DefectCorrection() = default;
DefectCorrection::DefectCorrection(DefectCorrection&&) noexcept = default;

void DefectCorrection::add(const Scene& scene, const std::vector<double>& q0, int points) {
  if (!has_defect_correction(scene)) {
    throw std::invalid_argument(
        "scene: a law switches or a joint may be held: its runs have no defect correction");
  }
  const std::size_t n = scene.links.size();
  if (q0.size() != n || (!neighbours_.empty() && links() != n)) {
    throw std::invalid_argument("q0: the neighbours must have as many links, and angles, alike");
  }
  if (&scene != last_scene_) {
    last_equations_ = std::make_shared<const EquationsOfMotion>(equations_of_motion(scene));
    last_scene_ = &scene;
  }
  neighbours_.push_back(
      std::make_unique<Neighbour>(scene, last_equations_, q0, lobatto_points(points)));
  if (!curve_) curve_ = std::make_unique<CurveOfStep>(n);
}

void DefectCorrection::keep(Store store, const std::vector<double>& t_eval) {
  store_ = store;
  t_eval_ = t_eval;
}

void DefectCorrection::starts(double t, std::span<const double> y) {
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

void DefectCorrection::steps(const WatchedStep& step) {
  if (step.share == 0.0) return;  // an event at the start of a step
  const double size = step.share / parts_;
  const double h = size * step.h;
  const double t_start = t_start_;
  if (store_ == Store::end) {
    t_.clear();
    errors_.clear();
  }
  if (!neighbours_.empty()) set_curve(step);
  for (int k = 0; k < parts_; ++k) {
    const bool is_last = k + 1 == parts_;
    const Part part{.from = k * size,
                    .size = size,
                    .t_start = t_start + k * h,
                    .t = is_last ? step.t : t_start + (k + 1) * h,
                    .h = h};
    if (!agreement_.is_lost()) go_on(part);
    if (is_last) jump(step);
    keep_errors(part, is_last);
  }
  t_start_ = step.t;
  if (!neighbours_.empty() && !agreement_.is_lost()) compare();
}

void DefectCorrection::set_curve(const WatchedStep& step) {
  static const auto take = fastest<&take_curve>();
  curve_->degree = static_cast<std::size_t>(step.degree) + 1;
  const std::size_t size = (curve_->degree + 1) * curve_->row;
  curve_->powers.resize(2 * size);
  curve_->farther.resize(size);
  take(step.rows, step.y.size(), step.h, curve_.get());
}

/// The neighbours go on side by side, so that a processor works on several of them at once.
void DefectCorrection::go_on(const Part& part) {
  for (const auto& one : neighbours_) one->set_out(*curve_, part);
  for (std::size_t i = 1; i <= LobattoPoints::most; ++i) {
    for (const auto& one : neighbours_) {
      if (i <= one->points.count) one->go_on(part, i);
    }
  }
}

void DefectCorrection::jump(const WatchedStep& step) {
  if (neighbours_.empty()) return;
  static const auto find = fastest<&find_jump>();
  jump_.resize(2 * curve_->row);
  find(*curve_, step.share, step.y.data(), jump_.data());
  for (const auto& one : neighbours_) one->jump(jump_.data());
}

void DefectCorrection::compare() {
  double between = 0.0;
  double largest = 0.0;
  for (std::size_t link = 0; link < links(); ++link) {
    const double share = neighbours_.front()->shares[link];
    const double first = neighbours_.front()->e_q()[link];
    const double second =
        neighbours_[std::min<std::size_t>(1, neighbours_.size() - 1)]->e_q()[link];
    between += share * std::abs(first - second);
    largest += share * std::max(std::abs(first), std::abs(second));
  }
  if (!(largest <= lost && between <= lost)) {  // NaN too
    agreement_.at_loss =
        std::isfinite(between + largest) ? largest : std::numeric_limits<double>::infinity();
    for (const auto& one : neighbours_) one->forget();
    return;
  }
  agreement_.between = std::max(agreement_.between, between);
  agreement_.largest = std::max(agreement_.largest, largest);
  agreement_.t_known = t_start_;
}

/// A scene whose laws do not change has no impacts: its state is only settled.
void DefectCorrection::jumps(double, std::span<const double>) {}

void DefectCorrection::keep_errors(const Part& part, bool ends_the_step) {
  if (store_ == Store::times) {
    theta_.clear();
    const std::size_t first = next_time_;
    for (; next_time_ < t_eval_.size(); ++next_time_) {
      const double t = t_eval_[next_time_];
      if ((t - part.t) * part.h > 0.0) break;
      if (ends_the_step && t == part.t) continue;
      theta_.push_back((t - part.t_start) / part.h);
    }
    const std::size_t within = theta_.size();
    keep_errors_within(part, t_eval_.data() + first);
    for (std::size_t i = first + within; i < next_time_; ++i) keep_errors_now(part.t);
    return;
  }
  if (store_ == Store::dense) {
    std::array<double, divisions> t;
    theta_.clear();
    for (int k = 1; k <= divisions - (ends_the_step ? 1 : 0); ++k) {
      theta_.push_back(static_cast<double>(k) / divisions);
      t[theta_.size() - 1] = k < divisions ? part.t_start + theta_.back() * part.h : part.t;
    }
    keep_errors_within(part, t.data());
  }
  if (ends_the_step) keep_errors_now(part.t);
}

/// Keeps errors at all theta_, where the times are t.
void DefectCorrection::keep_errors_within(const Part& part, const double* t) {
  if (theta_.empty()) return;
  t_.insert(t_.end(), t, t + theta_.size());
  double* const to = append(theta_.size());
  if (neighbours_.empty()) return;
  along_.clear();
  for (const auto& one : neighbours_) {
    one->look_along(part.h);
    along_.push_back(one->along.data());
  }
  static const auto find = fastest<&find_errors>();
  find({curve_.get(), part.from, part.size, along_, theta_, to});
}

void DefectCorrection::keep_errors_now(double t) {
  t_.push_back(t);
  double* to = append(1);
  for (const auto& one : neighbours_) to = std::copy_n(one->e_q(), one->n, to);
}

std::vector<double> DefectCorrection::errors_at_end() const {
  std::vector<double> errors;
  for (const auto& one : neighbours_) errors.insert(errors.end(), one->e_q(), one->e_q() + one->n);
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

/// Makes room for the errors at so many times.
double* DefectCorrection::append(std::size_t times) {
  const std::size_t size = times * neighbours() * links();
  errors_.resize(errors_.size() + size);
  return errors_.data() + (errors_.size() - size);
}

}  // namespace pendcore
