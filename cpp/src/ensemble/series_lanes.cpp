#include "ensemble/series_lanes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "ensemble/lane_loop.hpp"
#include "integrate/taylor/dominant_eigenvalue.hpp"

namespace pendcore {
namespace {

template <class Form, InstructionSet set>
class SeriesRunner final : public LaneLoop<width_on(set)> {
  static constexpr int width = width_on(set);
  using All = SeriesLanes<Form, width>;

 public:
  explicit SeriesRunner(const LaneTask& task) : LaneLoop<width>(task, taylor.info.name) {
    double tightest = 1.0;
    for (std::size_t i = 0; i < this->rtol_.size(); ++i) {
      tightest = std::min(tightest, std::max(this->rtol_[i], this->atol_[i]));
    }
    this->prepare(all_.equations);
    if constexpr (std::is_same_v<Form, BareDoublePendulumSeries<Pack<4>>>) {
      all_.expand_kernel = expand_bare_series_of_four();
    } else {
      all_.expand_kernel = only<&expand_in_lanes<Form, Pack<width>>, set>();
    }
    all_.make_room(taylor_order(tightest));
    for (int i = 0; i < all_.size(); ++i) {
      all_.rtol[i] = broadcast<Pack<width>>(this->rtol_[i]);
      all_.atol[i] = broadcast<Pack<width>>(this->atol_[i]);
    }
    all_.log2_count = approximate_log2(static_cast<double>(all_.size()));
    // Lanes without a member have numbers that do no harm.
    all_.sigma = all_.sigma_new = all_.largest = all_.largest_new = broadcast<Pack<width>>(1.0);
  }

 private:
  void get_derivative(int lane, double* dydt) override {
    for (int i = 0; i < all_.size(); ++i) {
      dydt[i] = all_.rows[all_.size() + i][lane] / all_.sigma[lane];
    }
  }
  std::vector<double> saved_state(int lane) override { return {all_.sigma[lane]}; }
  LaneSteps<width>& steps() override { return all_; }
  Attention take_steps() override { return take_steps_(&all_, &this->interval_, rounds_at_once); }
  void put_equations(int lane, const Scene& scene) override {
    all_.equations.put(lane, scene, *this->equations_);
  }
  void put_start(int lane, const std::vector<double>& y) override {
    put_state(lane, y.data());
    const double rate = taylor_detail::squared_rate(this->rate_.data(), all_.links());
    all_.sigma[lane] = taylor_detail::first_sigma(rate);
    all_.begins[lane] = -1;
    all_.h[lane] = this->direction();
    look_count_[lane] = 0;
  }
  void put_state(int lane, const double* y) override {
    for (int i = 0; i < all_.size(); ++i) all_.y[i][lane] = y[i];
  }
  void get_state(int lane, double* y) const override {
    for (int i = 0; i < all_.size(); ++i) y[i] = all_.y[i][lane];
  }
  void get_state_before(int lane, double* y) const override {
    for (int i = 0; i < all_.size(); ++i) y[i] = all_.y_new[i][lane];  // they have been swapped
  }
  /// A single run does otherwise if powers may be too large.
  bool write_interpolant(int lane, double* coefficients) const override {
    get_state_before(lane, coefficients);
    const double x = all_.h_before[lane] / all_.sigma_new[lane];  // sigma before the step
    double power = x;
    for (int k = 1; k <= all_.order; ++k, power *= x) {
      for (int at = k * all_.size(); at < (k + 1) * all_.size(); ++at) {
        coefficients[at] = power * all_.rows_new[at][lane];
      }
    }
    return std::abs(x) <= taylor_detail::no_large_powers;
  }
  long long evaluations_of(int lane) override {
    return 1 + all_.accepted[lane] + all_.rejected[lane] +
           evaluations_of_stiffness * look_count_[lane];
  }
  /// As Taylor::stiffness() does.
  bool looks_stiff(int lane) override {
    ++look_count_[lane];
    std::vector<double> last(all_.size());
    std::vector<double> y(all_.size());
    for (int i = 0; i < all_.size(); ++i) {
      last[i] = all_.rows_new[all_.order * all_.size() + i][lane];
      y[i] = all_.y_new[i][lane];
    }
    const auto rates = [this, lane](double t, const double* state, double* dydt) {
      this->stepper(lane).evaluate(t, state, dydt);
    };
    return stiffness_of_series(rates, all_.t_before[lane], y, std::move(last), all_.h_before[lane],
                               all_.order) > taylor.info.stability;
  }

  All all_{};
  std::array<long long, width> look_count_{};
  Attention (*take_steps_)(All*, const LaneInterval*,
                           int) = only<&take_series_steps<Form, width>, set>();
};

}  // namespace

template <InstructionSet set>
std::unique_ptr<LaneRunner> make_series_lanes(const LaneTask& task) {
  using Real = Pack<width_on(set)>;
  std::unique_ptr<LaneRunner> runner;
  with_first_form<BareDoublePendulumSeries<Real>, LoadedDoublePendulumSeries<Real>,
                  FewLinksSeriesInLanes<Real, 3>, FewLinksSeriesInLanes<Real, 4>,
                  ChainSeriesInLanes<Real, 2>, ChainSeriesInLanes<Real, 0>>(
      task.scene, *task.equations,
      [&]<class Form>() { runner = std::make_unique<SeriesRunner<Form, set>>(task); });
  return runner;
}

template std::unique_ptr<LaneRunner> make_series_lanes<InstructionSet::x86_64_v3>(const LaneTask&);
#if PENDCORE_CLONES
template std::unique_ptr<LaneRunner> make_series_lanes<InstructionSet::x86_64_v4>(const LaneTask&);
#endif

}  // namespace pendcore
