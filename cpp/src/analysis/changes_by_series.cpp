#include "analysis/changes_by_series.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <utility>
#include <variant>

#include "arithmetic/epsilon.hpp"
#include "arithmetic/instruction_set.hpp"
#include "dynamics/series/chain_series_recurrence.hpp"
#include "dynamics/series/double_pendulum_along_names.hpp"
#include "integrate/taylor/taylor_step.hpp"
#include "scene/effects_of_scene.hpp"

namespace pendcore {
namespace {

using Slopes = decltype(AlongNames::slope);
constexpr int lowest_order = 8;  // the last eight orders are looked at
constexpr int usual_order = 20;

/// Two links that turn freely have a closed form; all other scenes with a series take the chain's.
using SeriesOfChain = ChainSeries<AlongNames, EffectsWithSlopes<AlongNames>>;
using AnySeries = std::variant<DoublePendulumAlongNames, SeriesOfChain>;

PENDCORE_INLINE void expand_series(const SeriesOfChain* series, double t, double sigma, int order,
                                   AlongNames* rows) {
  series->expand(t, rows, sigma, order, rows);
}
PENDCORE_INLINE void expand_pendulum(const DoublePendulumAlongNames* series,
                                     const ChangesInCommon* common, double t, double sigma,
                                     int order, AlongNames* rows) {
  series->expand(*common, t, sigma, order, rows);
}
PENDCORE_INLINE void find_common_series(const DoublePendulumAlongNames* series, double t,
                                        const double* y, double sigma, int order,
                                        ChangesInCommon* common) {
  series->find_common(t, y, sigma, order, *common);
}

/// Computes the slopes of number i of a series at x.
PENDCORE_INLINE Slopes sum_of_slopes(const AlongNames* rows, int size, int order, double x, int i) {
  Slopes sum = rows[order * size + i].slope;
  for (int k = order; k-- > 0;) sum = fma(x, sum, rows[k * size + i].slope);
  return sum;
}

/// The largest slopes of a series: at both ends of a step, and those that the last four orders have
/// at x, its end, and the four before. By symmetry three of four may vanish.
struct Sizes {
  double of_change[names_at_once], last[names_at_once], before[names_at_once];
};
/// Computes them, and the slopes at the end of the step.
PENDCORE_INLINE void find_sizes(const AlongNames* rows, int size, int order, double x, Sizes* sizes,
                                double* ends) {
  double power = 1.0;  // x^(order - 7)
  for (int k = 7; k < order; ++k) power *= x;
  const auto largest = [&](int begin, double at) __attribute__((always_inline)) {
    Slopes found{};
    for (int k = begin; k < begin + 4; ++k, at *= x) {
      for (int i = 0; i < size; ++i) {
        found = larger(found, absolute(Slopes(at * rows[k * size + i].slope)));
      }
    }
    return found;
  };
  Slopes of_change{};
  for (int i = 0; i < size; ++i) {
    const Slopes at_end = sum_of_slopes(rows, size, order, x, i);
    store(ends + i * names_at_once, at_end);
    of_change = larger(of_change, larger(absolute(rows[i].slope), absolute(at_end)));
  }
  store(sizes->of_change, of_change);
  store(sizes->before, largest(order - 7, power));
  store(sizes->last, largest(order - 3, power * (x * x) * (x * x)));
}

PENDCORE_INLINE void sum_slopes(const AlongNames* rows, int size, int order, double x,
                                double* sums) {
  for (int i = 0; i < size; ++i) {
    store(sums + i * names_at_once, sum_of_slopes(rows, size, order, x, i));
  }
}

}  // namespace

/// The series for some names at once.
struct ChangesBySeries::Part {
  AnySeries series;
  Eigen::Index first;  ///< of the names
  int count;
  std::vector<AlongNames> rows;
  std::vector<double> ends;  ///< the changes at the end of the step, eight of each number

  Part(const Mechanism<AlongNames>& mechanism, const std::vector<char>& held,
       Eigen::Index first_name, int names)
      : series(series_of(mechanism, held)), first(first_name), count(names) {}

  void set_order(int order, Eigen::Index size) {
    std::visit([order](auto& one) { one.set_order(order); }, series);
    rows.resize(static_cast<std::size_t>((order + 1) * size));
    ends.resize(static_cast<std::size_t>(size) * names_at_once);
  }
  void expand(const ChangesInCommon& common, double t, double sigma, int order) {
    static const auto of_chain = fastest<&expand_series, wide_sets>();
    static const auto of_pendulum = fastest<&expand_pendulum, wide_sets>();
    if (const auto* const chain = std::get_if<SeriesOfChain>(&series)) {
      of_chain(chain, t, sigma, order, rows.data());
    } else {
      of_pendulum(&std::get<DoublePendulumAlongNames>(series), &common, t, sigma, order,
                  rows.data());
    }
  }

  /// Finds what the changes of all names have in common, if they are those of two links.
  void find_common(double t, const double* y, double sigma, int order,
                   ChangesInCommon& common) const {
    static const auto compute = fastest<&find_common_series, wide_sets>();
    const auto* const pendulum = std::get_if<DoublePendulumAlongNames>(&series);
    if (pendulum != nullptr) compute(pendulum, t, y, sigma, order, &common);
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
    return SeriesOfChain(ConstantsOfChain<AlongNames>(mechanism),
                         std::make_shared<const EffectsWithSlopes<AlongNames>>(mechanism, held));
  }
};

ChangesBySeries::ChangesBySeries() : common_(std::make_unique<ChangesInCommon>()) {}
ChangesBySeries::~ChangesBySeries() = default;

/// Makes the series of the laws that are in force; none where they have none.
void ChangesBySeries::take_laws(const VariationalEquations& equations) {
  laws_ = equations.changes_of_laws();
  order_ = 0;
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

void ChangesBySeries::set_order(int order, Eigen::Index size) {
  order_ = order;
  for (Part& part : parts_) part.set_order(order, size);
}

bool ChangesBySeries::expand(const VariationalEquations& equations, double t, const double* y,
                             double h, const Matrix& changes, double tolerance) {
  if (laws_ != equations.changes_of_laws()) take_laws(equations);
  if (parts_.empty()) return false;
  const double sigma = taylor_detail::power_of_two_below(std::abs(h));
  x_ = h * inverse_of_power_of_two(sigma);
  if (order_ == 0) {
    set_order(usual_order, changes.rows());
  } else if (wanted_order_ < order_ && order_ > lowest_order) {
    set_order(order_ - 2, changes.rows());
  }
  wanted_order_ = lowest_order;
  int in_common = 0;  // the order up to which that is known
  for (Part& part : parts_) {
    for (;;) {
      for (Eigen::Index i = 0; i < changes.rows(); ++i) {
        AlongNames& start = part.rows[i] = AlongNames(y[i]);
        for (int k = 0; k < part.count; ++k) {
          set_lane(start.slope, k, changes(i, part.first + k));
        }
      }
      if (in_common != order_) {
        part.find_common(t, y, sigma, order_, *common_);
        in_common = order_;
      }
      part.expand(*common_, t, sigma, order_);
      const auto [has_converged, wanted] = look_at(part, tolerance);
      wanted_order_ = std::max(wanted_order_, wanted);
      if (has_converged) break;
      const int order = std::max(wanted, order_ + 2);
      if (order > highest_order) return false;
      set_order(order, changes.rows());
    }
  }
  return true;
}

/// Looks at all changes that are numbers at the end of a step.
ChangesBySeries::Convergence ChangesBySeries::look_at(Part& part, double tolerance) const {
  constexpr double safety = 0.1;          // for the order of the next step
  constexpr double largest_size = 1e300;  // beyond, sums may overflow
  constexpr Convergence none{.is_there = false, .wanted_order = highest_order + 1};
  static const auto measure = fastest<&find_sizes, wide_sets>();
  Sizes sizes;
  const auto size_of_state = static_cast<int>(part.ends.size()) / names_at_once;
  measure(part.rows.data(), size_of_state, order_, x_, &sizes, part.ends.data());
  Convergence found{.is_there = true, .wanted_order = lowest_order};
  const std::span<const AlongNames> start(part.rows.data(),
                                          static_cast<std::size_t>(size_of_state));
  for (int k = 0; k < part.count; ++k) {
    const auto is_number = [k](const AlongNames& x) { return std::isfinite(x.slope[k]); };
    if (!std::ranges::all_of(start, is_number)) continue;
    const double size = sizes.of_change[k];
    if (sizes.last[k] <= 0.1 * epsilon * size && size < largest_size) continue;
    const double allowed = tolerance * size;
    const double ratio = sizes.last[k] / sizes.before[k];
    const bool may_fall = ratio < 1.0 || order_ < usual_order;
    if (!(may_fall && allowed > 0.0 && size < largest_size)) return none;
    if (!(ratio <= 0.5)) {
      found = {.is_there = false, .wanted_order = std::max(found.wanted_order, order_ + 6)};
      continue;
    }
    double left_out = sizes.last[k] * ratio / (1.0 - ratio);
    found.is_there &= left_out <= allowed;
    const double of_two_orders = std::sqrt(ratio);
    int order = order_;
    while (order <= highest_order && left_out > safety * allowed) {
      left_out *= of_two_orders;
      order += 2;
    }
    while (order > lowest_order && left_out <= safety * of_two_orders * allowed) {
      left_out /= of_two_orders;
      order -= 2;
    }
    found.wanted_order = std::max(found.wanted_order, order);
  }
  return found;
}

void ChangesBySeries::evaluate(double share, Matrix& changes) {
  static const auto sum = fastest<&sum_slopes, wide_sets>();
  const auto size = static_cast<int>(changes.rows());
  sums_.resize(static_cast<std::size_t>(size) * names_at_once);
  for (const Part& part : parts_) {
    const bool at_end = share == 1.0;
    if (!at_end) sum(part.rows.data(), size, order_, share * x_, sums_.data());
    const double* const sums = at_end ? part.ends.data() : sums_.data();
    for (Eigen::Index i = 0; i < changes.rows(); ++i) {
      for (int k = 0; k < part.count; ++k) changes(i, part.first + k) = sums[i * names_at_once + k];
    }
  }
}

}  // namespace pendcore
