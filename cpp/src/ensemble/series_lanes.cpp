#include "pendcore/ensemble/series_lanes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "pendcore/ensemble/lane_loop.hpp"
#include "pendcore/integrate/taylor/dominant_eigenvalue.hpp"
#include "pendcore/simulate/event_finder.hpp"
#include "pendcore/simulate/recorder.hpp"

namespace pendcore {
namespace {

template <template <class> class Form, InstructionSet set>
class SeriesRunner final : public LaneLoop<width_on(set)> {
  static constexpr int width = width_on(set);
  using All = SeriesLanes<Form, width>;
  using One = typename All::Equations::One;

 public:
  /// `one` has the kinds of the laws of all members.
  SeriesRunner(const One& one, const Scene& scene, double t0, double t_end, const Options& options)
      : LaneLoop<width>(scene, t0, t_end, options, taylor.info.name) {
    all_.equations.prepare(one);
    double tightest = 1.0;
    for (int i = 0; i < All::size; ++i) {
      tightest = std::min(tightest, std::max(this->rtol()[i], this->atol()[i]));
      all_.rtol[i] = broadcast<Pack<width>>(this->rtol()[i]);
      all_.atol[i] = broadcast<Pack<width>>(this->atol()[i]);
    }
    all_.order = taylor_order(tightest);
    all_.log2_count = approximate_log2(static_cast<double>(All::size));
    std::vector<FoundEvent> none;
    differences_ = EventFinder(scene, options.events, none, {}).differences();
    all_.differences = differences_;
    all_.has_times = !options.t_eval.empty();
    rows_.resize(static_cast<std::size_t>(all_.order + 1) * All::size);
    // Lanes without a member have numbers that do no harm.
    all_.sigma = all_.sigma_new = all_.largest = all_.largest_new = broadcast<Pack<width>>(1.0);
  }

 private:
  void get_derivative(int lane, double* dydt) override {
    for (int i = 0; i < All::size; ++i) {
      dydt[i] = all_.rows[All::size + i][lane] / all_.sigma[lane];
    }
  }
  std::vector<double> saved_state(int lane) override { return {all_.sigma[lane]}; }
  LaneSteps<width>& steps() override { return all_; }
  Attention take_steps() override { return take_steps_(&all_, &this->interval(), rounds_at_once); }
  void equations_are_new(const Scene& scene, const EquationsOfMotion& equations) override {
    one_ = All::Equations::one_of(scene, equations);
  }
  bool put_equations(int lane) override { return one_ && all_.equations.put(lane, *one_); }
  void put_start(int lane, const std::vector<double>& y) override {
    for (int i = 0; i < All::size; ++i) all_.y[i][lane] = y[i];
    const double rate = taylor_detail::squared_rate(this->rate().data(), All::Equations::links);
    all_.sigma[lane] = taylor_detail::first_sigma(rate);
    all_.begins[lane] = -1;
    all_.h[lane] = this->direction();
    look_count_[lane] = 0;
    this->member(lane).samples.clear();
    if (all_.has_times) {
      if (this->options().t_eval.front() == all_.t[lane]) this->member(lane).samples = y;
      find_next_time(lane);
    }
    if (differences_.empty()) return;
    this->member(lane).found.clear();
    finders_[lane] = std::make_unique<EventFinder>(
        this->scene(), this->options().events, this->member(lane).found, std::vector<long long>());
  }
  void get_state(int lane, double* y) override {
    for (int i = 0; i < All::size; ++i) y[i] = all_.y[i][lane];
  }

  /// Writes the series of the last step in powers of theta to rows_, as a run does; false if its
  /// powers may be too large.
  bool write_interpolant(int lane) {
    const double x = all_.h_before[lane] / all_.sigma_new[lane];  // sigma before the step
    if (!(std::abs(x) <= taylor_detail::no_large_powers)) return false;
    double power = 1.0;
    for (int k = 0; k <= all_.order; ++k, power *= x) {
      for (int i = 0; i < All::size; ++i) {
        const int at = k * All::size + i;
        rows_[at] = k == 0 ? all_.y_new[i][lane] : power * all_.rows_new[at][lane];
      }
    }
    const auto is_finite = [](double term) { return std::isfinite(term); };
    return std::all_of(rows_.end() - All::size, rows_.end(), is_finite);
  }

  /// Sets the next time to sample.
  void find_next_time(int lane) {
    const std::vector<double>& times = this->options().t_eval;
    const std::size_t next = this->member(lane).samples.size() / All::size;
    all_.next_time[lane] = next < times.size()
                               ? times[next]
                               : this->direction() * std::numeric_limits<double>::infinity();
  }
  /// As Recorder::sample_step() does.
  bool sample_step(int lane) override {
    const std::vector<double>& times = this->options().t_eval;
    std::vector<double>& samples = this->member(lane).samples;
    const double h = all_.h_before[lane];
    const double t_new = all_.t[lane];
    const std::size_t first = samples.size() / All::size;
    const std::size_t end = first_not_before(times, first, t_new, h);
    if (end > first) {
      if (!write_interpolant(lane)) return false;
      samples.resize(end * All::size);
      const TwoDouble t_old{all_.t_before[lane], all_.t_low_before[lane]};
      this->stepper(lane).sample(rows_.data(), t_old, h, &times[first],
                                 static_cast<int>(end - first), &samples[first * All::size]);
    }
    if (end < times.size() && times[end] == t_new) {
      samples.resize((end + 1) * All::size);
      get_state(lane, &samples[end * All::size]);
    }
    find_next_time(lane);
    return true;
  }

  /// Looks for events as a run does.
  typename LaneLoop<width>::EventLook look_for_events(int lane) override {
    using Look = typename LaneLoop<width>::EventLook;
    if (!write_interpolant(lane)) return Look::is_odd;
    const double h = all_.h_before[lane];
    std::array<double, All::size> y{};
    get_state(lane, y.data());
    this->stepper(lane).set_new_state(y.data());
    const TwoDouble t_old{all_.t_before[lane], all_.t_low_before[lane]};
    const double t_new = all_.t[lane];
    EventFinder& finder = *finders_[lane];
    const StepEnd found = finder.look(this->stepper(lane), rows_.data(), t_old, h, t_new);
    if (found.has_too_many_turns()) return Look::is_odd;
    if (finder.ended_by() < 0) return Look::goes_on;
    if (found.is_within()) {
      const double theta = found.theta;
      const TwoDouble t = time_in_step(t_old, h, theta, t_new);
      if (t.high == t_old.high) return Look::is_odd;
      this->stepper(lane).sample(rows_.data(), {}, 1.0, &theta, 1, y.data());
      for (int i = 0; i < All::size; ++i) all_.y[i][lane] = y[i];
      all_.t[lane] = t.high;
    }
    return Look::ends;
  }
  long long evaluations_of(int lane) override {
    return 1 + all_.accepted[lane] + all_.rejected[lane] +
           DominantEigenvalue::evaluations * look_count_[lane];
  }
  /// As Taylor::stiffness() does.
  bool looks_stiff(int lane) override {
    ++look_count_[lane];
    double* const direction = eigenvalue_.direction();
    std::array<double, All::size> y{};
    for (int i = 0; i < All::size; ++i) {
      direction[i] = all_.rows_new[all_.order * All::size + i][lane];
      y[i] = all_.y_new[i][lane];
    }
    const auto rates = [this, lane](double t, const double* state, double* dydt) {
      this->stepper(lane).evaluate(t, state, dydt);
    };
    return stiffness_of_series(eigenvalue_, rates, all_.t_before[lane], y.data(),
                               all_.h_before[lane], all_.order) > taylor.info.stability;
  }

  All all_{};
  std::array<long long, width> look_count_{};
  DominantEigenvalue eigenvalue_{All::Equations::links, 0};
  std::optional<One> one_;
  std::vector<EventFinder::Difference> differences_;
  std::array<std::unique_ptr<EventFinder>, width> finders_;
  std::vector<double> rows_;
  Attention (*take_steps_)(All*, const LaneInterval*,
                           int) = only<&take_series_steps<Form, width>, set>();
};

template <InstructionSet set, template <class> class... Forms>
std::unique_ptr<LaneRunner> first_of(const Scene& scene, double t0, double t_end,
                                     const Options& options) {
  const EquationsOfMotion equations = equations_of_motion(scene);
  std::unique_ptr<LaneRunner> runner;
  const auto try_form = [&]<template <class> class Form>() {
    if (runner) return;
    const auto one = Form<Pack<width_on(set)>>::one_of(scene, equations);
    if (!one) return;
    runner = std::make_unique<SeriesRunner<Form, set>>(*one, scene, t0, t_end, options);
  };
  (try_form.template operator()<Forms>(), ...);
  return runner;
}

}  // namespace

template <InstructionSet set>
std::unique_ptr<LaneRunner> make_series_lanes(const Scene& scene, double t0, double t_end,
                                              const Options& options) {
  return first_of<set, BareDoublePendulumSeries, LoadedDoublePendulumSeries, ThreeLinksSeries,
                  FourLinksSeries>(scene, t0, t_end, options);
}

template std::unique_ptr<LaneRunner> make_series_lanes<InstructionSet::x86_64_v3>(const Scene&,
                                                                                  double, double,
                                                                                  const Options&);
#if PENDCORE_CLONES
template std::unique_ptr<LaneRunner> make_series_lanes<InstructionSet::x86_64_v4>(const Scene&,
                                                                                  double, double,
                                                                                  const Options&);
#endif

}  // namespace pendcore
