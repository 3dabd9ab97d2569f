#include "pendcore/analysis/defect_correction.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "pendcore/analysis/lobatto_points.hpp"
#include "pendcore/arithmetic/instruction_set.hpp"
#include "pendcore/arithmetic/pack.hpp"
#include "pendcore/dynamics/equations_of_motion.hpp"
#include "pendcore/simulate/switching.hpp"

namespace pendcore {
namespace {

constexpr double lost = 0.2;  ///< of the total length
constexpr double not_known = std::numeric_limits<double>::quiet_NaN();

/// The dense output of a step at so many points, for a block of its columns, and its slopes times a
/// factor. The points are the inner loop, so that none waits for another.
template <class Block, int count>
PENDCORE_INLINE void evaluate_block(const double* rows, int degree, std::ptrdiff_t row,
                                    const double* at, double factor, std::ptrdiff_t to_row,
                                    double* y, double* slope) {
  Block value[count];
  Block derivative[count];
  const Block top = load<Block>(rows + degree * row);
  for (int i = 0; i < count; ++i) {
    value[i] = top;
    derivative[i] = broadcast<Block>(0.0);
  }
  for (std::ptrdiff_t p = degree - 1; p >= 0; --p) {
    const Block c = load<Block>(rows + p * row);
#pragma GCC unroll 16
    for (int i = 0; i < count; ++i) {
      derivative[i] = fma(at[i], derivative[i], value[i]);
      value[i] = fma(at[i], value[i], c);
    }
  }
#pragma GCC unroll 16
  for (int i = 0; i < count; ++i) {
    store(y + i * to_row, value[i]);
    store(slope + i * to_row, factor * derivative[i]);
  }
}

/// The same for all of the columns, an even number.
template <int count>
PENDCORE_INLINE void evaluate_dense_output(const double* rows, int degree, std::ptrdiff_t row,
                                           const double* at, double factor, std::ptrdiff_t columns,
                                           double* y, double* slope) {
  std::ptrdiff_t k = 0;
  for (; k + 4 <= columns; k += 4) {
    evaluate_block<Pack<4>, count>(rows + k, degree, row, at, factor, columns, y + k, slope + k);
  }
  for (; k + 2 <= columns; k += 2) {
    evaluate_block<Pair, count>(rows + k, degree, row, at, factor, columns, y + k, slope + k);
  }
}

using Evaluate = void (*)(const double*, int, std::ptrdiff_t, const double*, double, std::ptrdiff_t,
                          double*, double*);

Evaluate evaluation_at(std::size_t points) {
  static const std::array<Evaluate, 5> all = {
      fastest<&evaluate_dense_output<5>>(), fastest<&evaluate_dense_output<6>>(),
      fastest<&evaluate_dense_output<7>>(), fastest<&evaluate_dense_output<8>>(),
      fastest<&evaluate_dense_output<9>>()};
  return all.at(points - 5);
}

}  // namespace

bool has_defect_correction(const Scene& scene) { return !Switching::is_needed(scene); }

/// A part of a step, from one theta of its dense output on.
struct DefectCorrection::Part {
  const WatchedStep& step;
  double from, size;  ///< in theta
  double t_start, t;  ///< s, where the part begins, and where it ends
  double h;           ///< s
  bool ends_the_step;

  double theta(double share) const { return from + share * size; }
  /// By how much the run's state is off the end of the dense output: a sum was rounded there. The
  /// state at the start comes last, so that little is rounded here.
  double jump(std::size_t column) const {
    const double end = theta(1.0);
    double turned = 0.0;
    for (std::size_t p = static_cast<std::size_t>(step.degree); p > 0; --p) {
      turned = end * (turned + step.rows[p * step.y.size() + column]);
    }
    return turned + (step.rows[column] - step.y[column]);
  }
};

/// A neighbour of the run: its error now, and along the last part of a step.
struct DefectCorrection::Neighbour {
  Neighbour(const Scene& scene, std::vector<double> angles, const LobattoPoints& its_points)
      : equations(equations_of_motion(scene)),
        qdd_of(right_hand_side(equations)),
        points(its_points),
        evaluate(evaluation_at(its_points.count)),
        n(scene.links.size()),
        q0(std::move(angles)) {
    for (auto* one : {&e_q, &e_qd, &e_q_before, &e_qd_before, &q, &qd, &qdd}) one->resize(n);
    r.resize(points.count * n);
    s.resize(points.count * n);
    y.resize(points.count * 2 * n);
    slope.resize(points.count * 2 * n);
    double total = 0.0;
    for (const Link& link : scene.links) total += link.length;
    for (const Link& link : scene.links) shares.push_back(link.length / total);
  }

  /// It is lost: nothing of its error is known any more.
  void forget() {
    std::ranges::fill(e_q, not_known);
    std::ranges::fill(e_q_before, not_known);
  }

  /// Goes to the end of a part of a step. Returns the right-hand sides taken.
  int go_on(const Part& part) {
    e_q_before = e_q;
    e_qd_before = e_qd;
    LobattoPoints::Numbers at{};
    for (std::size_t i = 0; i < points.count; ++i) at[i] = part.theta(points.theta[i]);
    evaluate(part.step.rows, part.step.degree, static_cast<std::ptrdiff_t>(part.step.y.size()),
             at.data(), part.size, static_cast<std::ptrdiff_t>(2 * n), y.data(), slope.data());
    for (std::size_t i = 0; i < points.count; ++i) {
      for (std::size_t link = 0; link < n; ++link) {
        const std::size_t angle = i * 2 * n + link;
        s[i * n + link] = part.h * y[angle + n] - slope[angle];
        r[i * n + link] = -slope[angle + n];
      }
    }
    for (std::size_t i = 0; i < points.count; ++i) {
      // At the first point the last right-hand side of the part before serves again. Its state
      // lacked only what the last point itself added to the error.
      if (i > 0 || is_first) {
        set_state(part, i);
        qdd_of(part.t_start + points.theta[i] * part.h, q.data(), qd.data(), qdd.data());
      }
      for (std::size_t link = 0; link < n; ++link) r[i * n + link] += part.h * qdd[link];
    }
    const LobattoPoints::Within& end = points.equal_parts.back();
    angles_at(end, part.h, e_q.data());
    for (std::size_t link = 0; link < n; ++link) {
      for (std::size_t j = 0; j < points.count; ++j) e_qd[link] += end.once[j] * r[j * n + link];
      if (!part.ends_the_step) continue;
      e_q[link] += part.jump(link);
      e_qd[link] += part.jump(n + link);
    }
    const int taken = static_cast<int>(points.count) - (is_first ? 0 : 1);
    is_first = false;
    return taken;
  }

  /// The errors of the angles within the last part, of length h, s.
  void angles_at(const LobattoPoints::Within& at, double h, double* errors) const {
    for (std::size_t link = 0; link < n; ++link) {
      double angle = e_q_before[link] + at.theta * h * e_qd_before[link];
      for (std::size_t j = 0; j < points.count; ++j) {
        angle += h * at.twice[j] * r[j * n + link] + at.once[j] * s[j * n + link];
      }
      errors[link] = angle;
    }
  }

  EquationsOfMotion equations;
  RightHandSide qdd_of;
  const LobattoPoints& points;
  Evaluate evaluate;
  std::size_t n;
  std::vector<double> q0;
  std::vector<double> shares{};  ///< of the links in the total length
  std::vector<double> e_q{}, e_qd{}, e_q_before{}, e_qd_before{}, q{}, qd{}, qdd{};
  std::vector<double> r{}, s{};      ///< (points, n)
  std::vector<double> y{}, slope{};  ///< the dense output and its slopes, (points, 2n)
  bool is_first = true;

 private:
  /// Sets q and qd at a point to the run's and their errors, as the points before it have them.
  void set_state(const Part& part, std::size_t i) {
    const double theta = points.theta[i];
    const double* const once = points.of_earlier[i].data();
    const double* const twice = points.twice_of_earlier[i].data();
    const double* const all = points.of_all[i].data();
    for (std::size_t link = 0; link < n; ++link) {
      double rate = 0.0;
      double angle = 0.0;
      double sum = 0.0;
      for (std::size_t j = 0; j < i; ++j) {
        rate += once[j] * r[j * n + link];
        angle += twice[j] * r[j * n + link];
      }
      for (std::size_t j = 0; j < points.count; ++j) sum += all[j] * s[j * n + link];
      q[link] = y[i * 2 * n + link] + (e_q[link] + part.h * (theta * e_qd[link] + angle) + sum);
      qd[link] = y[i * 2 * n + n + link] + (e_qd[link] + rate);
    }
  }
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
  neighbours_.push_back(std::make_unique<Neighbour>(scene, q0, lobatto_points(points)));
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
  for (const auto& one : neighbours_) {
    for (std::size_t link = 0; link < one->n; ++link) one->e_q[link] = one->q0[link] - y[link];
  }
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
  for (int k = 0; k < parts_; ++k) {
    const bool is_last = k + 1 == parts_;
    const Part part{.step = step,
                    .from = k * size,
                    .size = size,
                    .t_start = t_start + k * h,
                    .t = is_last ? step.t : t_start + (k + 1) * h,
                    .h = h,
                    .ends_the_step = is_last};
    if (!agreement_.is_lost()) {
      for (const auto& one : neighbours_) nfev_ += one->go_on(part);
    }
    keep_errors(part);
  }
  t_start_ = step.t;
  if (!neighbours_.empty() && !agreement_.is_lost()) compare();
}

void DefectCorrection::compare() {
  double between = 0.0;
  double largest = 0.0;
  for (std::size_t link = 0; link < links(); ++link) {
    const double share = neighbours_.front()->shares[link];
    const double first = neighbours_.front()->e_q[link];
    const double second = neighbours_[std::min<std::size_t>(1, neighbours_.size() - 1)]->e_q[link];
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

void DefectCorrection::keep_errors(const Part& part) {
  const auto keep_at = [&](double t, const auto& weights_of) {
    double* to = append(t);
    for (const auto& one : neighbours_) {
      one->angles_at(weights_of(one->points), part.h, to);
      to += one->n;
    }
  };
  if (store_ == Store::times) {
    for (; next_time_ < t_eval_.size(); ++next_time_) {
      const double t = t_eval_[next_time_];
      if ((t - part.t) * part.h > 0.0) break;
      const double theta = (t - part.t_start) / part.h;
      if (t == part.t) {
        keep_errors_now(part.t);
      } else {
        keep_at(t, [theta](const LobattoPoints& points) { return points.at(theta); });
      }
    }
    return;
  }
  if (store_ == Store::dense) {
    for (std::size_t k = 1; k < LobattoPoints::divisions; ++k) {
      const double theta = static_cast<double>(k) / LobattoPoints::divisions;
      keep_at(part.t_start + theta * part.h,
              [k](const LobattoPoints& points) { return points.equal_parts[k]; });
    }
  }
  if (part.ends_the_step || store_ == Store::dense) keep_errors_now(part.t);
}

void DefectCorrection::keep_errors_now(double t) { std::ranges::copy(errors_at_end(), append(t)); }

std::vector<double> DefectCorrection::errors_at_end() const {
  std::vector<double> errors;
  for (const auto& one : neighbours_) errors.insert(errors.end(), one->e_q.begin(), one->e_q.end());
  return errors;
}

std::size_t DefectCorrection::links() const {
  return neighbours_.empty() ? 0 : neighbours_.front()->n;
}

double* DefectCorrection::append(double t) {
  t_.push_back(t);
  const std::size_t size = neighbours() * links();
  errors_.resize(errors_.size() + size);
  return errors_.data() + errors_.size() - size;
}

}  // namespace pendcore
