#include "analysis/changes_by_series.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <variant>

#include "arithmetic/epsilon.hpp"
#include "arithmetic/instruction_set.hpp"
#include "dynamics/series/chain_series_recurrence.hpp"
#include "dynamics/series/double_pendulum_along_names.hpp"
#include "integrate/horner.hpp"
#include "integrate/taylor/taylor_step.hpp"
#include "scene/effects_of_scene.hpp"

namespace pendcore {
namespace {

using Slopes = decltype(AlongNames::slope);
/// Ten names of two links at rtol = 1e-9 take the same with 16 to 24 within 4 %, and a tenth more
/// with 12 or 32.
constexpr int order = 22;

/// Two links that turn freely have a closed form; all other scenes with a series take the chain's.
using SeriesOfChain = ChainSeries<AlongNames, EffectsWithSlopes<AlongNames>>;
using AnySeries = std::variant<DoublePendulumAlongNames, SeriesOfChain>;

PENDCORE_INLINE void expand_series(const SeriesOfChain* series, double t, double sigma,
                                   AlongNames* rows) {
  series->expand(t, rows, sigma, order, rows);
}
PENDCORE_INLINE void expand_pendulum(const CoefficientsOfChanges* common, double t, double sigma,
                                     const DoublePendulumAlongNames* of, AlongNames* rows) {
  DoublePendulumAlongNames::Changes changes[] = {{*of, t, sigma, rows}};
  DoublePendulumAlongNames::expand<1>(*common, sigma, order, changes);
}
PENDCORE_INLINE void expand_two_pendulums(const CoefficientsOfChanges* common, double t,
                                          double sigma, const DoublePendulumAlongNames* first,
                                          AlongNames* first_rows,
                                          const DoublePendulumAlongNames* second,
                                          AlongNames* second_rows) {
  DoublePendulumAlongNames::Changes changes[] = {{*first, t, sigma, first_rows},
                                                 {*second, t, sigma, second_rows}};
  DoublePendulumAlongNames::expand<2>(*common, sigma, order, changes);
}
PENDCORE_INLINE void find_common_series(const DoublePendulumAlongNames* series, double t,
                                        const double* y, double sigma,
                                        CoefficientsOfChanges* common) {
  series->find_common(t, y, sigma, order, *common);
}

/// Computes the slopes of number i of a series at x, by its orders up to `last`.
PENDCORE_INLINE Slopes sum_of_slopes(const AlongNames* rows, int size, int last, double x, int i) {
  Slopes sum = rows[last * size + i].slope;
  for (int k = last; k-- > 0;) sum = fma(x, sum, rows[k * size + i].slope);
  return sum;
}

/// How slopes fall at a time x, the least of all names: N is the sum of the slopes that the last
/// four orders have there, M that of the four before (by symmetry three of four may vanish), and S
/// the largest change until halfway there, as a series may have any size beyond its reach.
struct Decay {
  double by_size = std::numeric_limits<double>::infinity();    ///< (S/N)(M/N)
  double by_orders = std::numeric_limits<double>::infinity();  ///< M/N
  bool is_too_near = false;  ///< whether the last orders of a name are rounding at x
};
PENDCORE_INLINE void find_decay(const AlongNames* rows, int size, double x, const bool* are_numbers,
                                Decay* decay) {
  double power = 1.0;  // x^(order - 7)
  for (int k = 7; k < order; ++k) power *= x;
  const auto sum_of_four = [&](int begin) __attribute__((always_inline)) {
    Slopes sum{};
    for (int k = begin; k < begin + 4; ++k, power *= x) {
      for (int i = 0; i < size; ++i) sum = sum + absolute(Slopes(power * rows[k * size + i].slope));
    }
    return sum;
  };
  Slopes change{};
  for (int i = 0; i < size; ++i) {
    const Slopes halfway = sum_of_slopes(rows, size, order / 2, 0.5 * x, i);
    change = larger(change, larger(absolute(rows[i].slope), absolute(halfway)));
  }
  const Slopes before = sum_of_four(order - 7);
  const Slopes last = sum_of_four(order - 3);
  for (int k = 0; k < names_at_once; ++k) {
    constexpr double largest_size = 1e300;  // beyond, sums may overflow
    const bool is_finite = change[k] < largest_size && last[k] < largest_size;  // false for NaN
    if (!are_numbers[k] || (is_finite && before[k] + last[k] == 0.0)) continue;
    const double rounding = 0.1 * epsilon * change[k];
    if (is_finite && last[k] <= rounding) {
      decay->is_too_near = true;
      decay->by_size = std::min(decay->by_size, 10.0 / epsilon);
      continue;
    }
    const double by_orders = is_finite ? before[k] / last[k] : 0.0;
    const double by_size = change[k] / last[k] * by_orders;
    decay->by_size = by_size > 0.0 ? std::min(decay->by_size, by_size) : 0.0;
    decay->by_orders = by_orders > 0.0 ? std::min(decay->by_orders, by_orders) : 0.0;
  }
}

/// How far series reach, as a share of x. If N and M are their highest orders, what is left out at
/// a share z is 2 N (N/M) z^(order + 4), and N/M is z^4 times what it is at x.
double share_of_reach(const Decay& decay, double tolerance) {
  const double where_half = std::sqrt(std::sqrt(0.5 * decay.by_orders));
  if (!(where_half > 0.0)) return 0.0;
  const double log2_room = coarse_log2(0.5 * tolerance * decay.by_size);
  return std::min(where_half, coarse_exp2(log2_room / (order + 4)));
}

PENDCORE_INLINE void sum_slopes(const AlongNames* rows, int size, double x, double* sums) {
  for (int i = 0; i < size; ++i) {
    store(sums + i * names_at_once, sum_of_slopes(rows, size, x == 0.0 ? 0 : order, x, i));
  }
}
PENDCORE_INLINE void sum_values(const AlongNames* rows, int size, double x, double* sums) {
  for (int i = 0; i < size; ++i) {
    sums[i] = rows[order * size + i].value;
    for (int k = order; k-- > 0;) sums[i] = fma(x, sums[i], rows[k * size + i].value);
  }
}
/// The same of the states of two links.
PENDCORE_INLINE void sum_states(const double* states, double x, double* sums) {
  store(sums, horner<Pack<4>>(states, order, 4, x));
}
/// Puts the slopes at x into row 0.
PENDCORE_INLINE void move_to(AlongNames* rows, int size, double x) {
  for (int i = 0; i < size; ++i) rows[i].slope = sum_of_slopes(rows, size, order, x, i);
}

}  // namespace

/// The series for some names at once.
struct ChangesBySeries::Part {
  AnySeries series;
  Eigen::Index first;  ///< of the names
  int count;
  std::vector<AlongNames> rows;
  std::array<bool, names_at_once> are_numbers{};

  Part(const Mechanism<AlongNames>& mechanism, const std::vector<char>& held,
       Eigen::Index first_name, int names)
      : series(series_of(mechanism, held)),
        first(first_name),
        count(names),
        rows((order + 1) * 2 * held.size()) {}

  int size() const { return static_cast<int>(rows.size()) / (order + 1); }
  /// Puts changes into row 0, those of names that have some.
  void start(const Matrix& changes) {
    for (int k = 0; k < count; ++k) are_numbers[k] = changes.col(first + k).allFinite();
    for (int i = 0; i < size(); ++i) {
      rows[i].slope = Slopes{};
      for (int k = 0; k < count; ++k) {
        if (are_numbers[k]) set_lane(rows[i].slope, k, changes(i, first + k));
      }
    }
  }
  /// Writes changes from eight numbers a row.
  void write(const double* numbers, Matrix& changes) const {
    for (int k = 0; k < count; ++k) {
      for (int i = 0; i < size(); ++i) {
        changes(i, first + k) = are_numbers[k] ? numbers[i * names_at_once + k]
                                               : std::numeric_limits<double>::quiet_NaN();
      }
    }
  }
  const DoublePendulumAlongNames* pendulum() const {
    return std::get_if<DoublePendulumAlongNames>(&series);
  }

 private:
  static AnySeries series_of(const Mechanism<AlongNames>& mechanism,
                             const std::vector<char>& held) {
    if (held.size() == 2) {
      DoublePendulumAlongNames::Effects effects(mechanism, held);
      if (DoublePendulumAlongNames::has(effects)) {
        return DoublePendulumAlongNames(mechanism, std::move(effects));
      }
    }
    SeriesOfChain chain(ConstantsOfChain<AlongNames>(mechanism),
                        std::make_shared<const EffectsWithSlopes<AlongNames>>(mechanism, held));
    chain.set_order(order);
    return chain;
  }
};

/// Expands all parts, which are of one kind: those of two links two at a time.
void ChangesBySeries::expand_parts(double t, const double* y, double sigma) {
  static const auto of_chain = fastest<&expand_series, wide_sets>();
  static const auto find_common = fastest<&find_common_series, wide_sets>();
  static const auto of_pendulum = fastest<&expand_pendulum, wide_sets>();
  static const auto of_two = fastest<&expand_two_pendulums, wide_sets>();
  if (const auto* const first = parts_.front().pendulum()) {
    find_common(first, t, y, sigma, common_.get());
  }
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    Part& part = parts_[i];
    const auto* const pendulum = part.pendulum();
    if (pendulum == nullptr) {
      of_chain(&std::get<SeriesOfChain>(part.series), t, sigma, part.rows.data());
    } else if (i + 1 == parts_.size()) {
      of_pendulum(common_.get(), t, sigma, pendulum, part.rows.data());
    } else {
      Part& next = parts_[++i];
      of_two(common_.get(), t, sigma, pendulum, part.rows.data(), next.pendulum(),
             next.rows.data());
    }
  }
}

ChangesBySeries::ChangesBySeries() : common_(std::make_unique<CoefficientsOfChanges>()) {}
ChangesBySeries::~ChangesBySeries() = default;

/// Makes the series of the laws that are in force; none where they have none.
void ChangesBySeries::take_laws(const VariationalEquations& equations) {
  laws_ = equations.changes_of_laws();
  reach_ = 0.0;
  parts_.clear();
  if (without_series(equations.scene())) return;
  std::vector<char> held(equations.links());
  if (const auto& effects = equations.equations().effects) held = effects->held;
  const auto names = static_cast<int>(equations.names().size());
  for (int first = 0; first < names; first += names_at_once) {
    std::vector<int> parameters(names_at_once, -1);
    for (std::size_t p = 0; p < equations.parameters().size(); ++p) {
      const auto k = static_cast<int>(equations.parameters()[p].column) - first;
      if (k >= 0 && k < names_at_once) parameters[k] = static_cast<int>(p);
    }
    const auto mechanism = equations.mechanism_along().with_slopes<AlongNames>(parameters);
    if (!are_all_couples(mechanism)) return parts_.clear();
    parts_.emplace_back(mechanism, held, first, std::min(names_at_once, names - first));
  }
}

bool ChangesBySeries::start(const VariationalEquations& equations, const Matrix& changes,
                            double first_reach, double tolerance) {
  tolerance_ = tolerance;
  if (laws_ != equations.changes_of_laws()) take_laws(equations);
  for (Part& part : parts_) part.start(changes);
  if (reach_ == 0.0) reach_ = first_reach;
  return !parts_.empty();
}

double ChangesBySeries::expand(double t, const double* y, bool forward) {
  static const auto find = fastest<&find_decay, wide_sets>();
  constexpr int most_tries = 8;
  constexpr double near_enough = 0.5;  // to where the series was looked at
  constexpr double farther = 4.0;      // at most
  for (Part& part : parts_) {
    for (int i = 0; i < part.size(); ++i) part.rows[i].value = y[i];
  }
  bool was_too_far = false;
  for (int tries = 0; tries < most_tries; ++tries) {
    const double sigma = taylor_detail::power_of_two_below(reach_);
    per_sigma_ = inverse_of_power_of_two(sigma);
    expand_parts(t, y, sigma);
    Decay decay;
    for (const Part& part : parts_) {
      find(part.rows.data(), part.size(), (forward ? reach_ : -reach_) * per_sigma_,
           part.are_numbers.data(), &decay);
    }
    const double share = std::min(farther, share_of_reach(decay, tolerance_));
    if (share < near_enough) {
      was_too_far = true;
      reach_ *= std::max(share, 0x1p-8);
    } else if (decay.is_too_near && !was_too_far && tries + 1 < most_tries) {
      reach_ *= farther;
    } else {
      return reach_ *= share;
    }
  }
  reach_ = 0.0;
  return 0.0;
}

void ChangesBySeries::state(double since, double* y) const {
  static const auto of_chain = fastest<&sum_values, wide_sets>();
  static const auto of_pendulum = fastest<&sum_states, wide_sets>();
  const Part& part = parts_.front();
  if (part.pendulum() != nullptr) return of_pendulum(common_->states, since * per_sigma_, y);
  of_chain(part.rows.data(), part.size(), since * per_sigma_, y);
}

void ChangesBySeries::move_start(double since) {
  static const auto move = fastest<&move_to, wide_sets>();
  for (Part& part : parts_) move(part.rows.data(), part.size(), since * per_sigma_);
}

void ChangesBySeries::evaluate(double since, Matrix& changes) {
  static const auto sum = fastest<&sum_slopes, wide_sets>();
  sums_.resize(static_cast<std::size_t>(changes.rows()) * names_at_once);
  for (const Part& part : parts_) {
    sum(part.rows.data(), part.size(), since * per_sigma_, sums_.data());
    part.write(sums_.data(), changes);
  }
}

}  // namespace pendcore
