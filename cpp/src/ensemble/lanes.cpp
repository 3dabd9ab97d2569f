#include "pendcore/ensemble/lanes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "pendcore/ensemble/runge_kutta_lanes.hpp"
#include "pendcore/ensemble/series_lanes.hpp"
#include "pendcore/integrate/loop/first_step.hpp"
#include "pendcore/integrate/methods.hpp"
#include "pendcore/integrate/taylor/dominant_eigenvalue.hpp"
#include "pendcore/simulate/event_finder.hpp"
#include "pendcore/simulate/initial_state.hpp"
#include "pendcore/simulate/method_choice.hpp"

namespace pendcore {
namespace {

/// As many lanes as a register of the processor holds.
constexpr int width_on(InstructionSet set) { return set == InstructionSet::x86_64_v4 ? 8 : 4; }
/// Steps between two looks at whether to go on: a fraction of a millisecond.
constexpr int rounds = 256;

/// Fills lanes with members and takes their steps, whatever the method.
template <int width>
class Runner : public LaneRunner {
 public:
  Runner(const Scene& scene, double t0, double t_end, const Options& options,
         std::string_view method)
      : scene_(scene),
        t0_(t0),
        t_end_(t_end),
        options_(options),
        method_(method),
        interval_{t_end, options.max_step, options.max_steps},
        rtol_(relative_tolerances(options, scene.links.size())),
        atol_(absolute_tolerances(options, scene.links.size())),
        rate_(2 * scene.links.size()) {}

  void run(LaneSource& source) override {
    bool goes_on = true;
    for (int lane = 0; lane < width; ++lane) fill(lane, source);
    while (steps().active != 0 && goes_on) {
      Attention attention = take_steps();
      for (int lane = 0; lane < width; ++lane) {
        const LaneBits bit = 1U << lane;
        if ((attention.looks & bit) != 0 && looks_stiff(lane)) attention.odd |= bit;
        const bool looks_for_events = (attention.events & bit) != 0 && (attention.odd & bit) == 0;
        const EventLook look = looks_for_events ? look_for_events(lane) : EventLook::goes_on;
        if ((attention.odd & bit) != 0 || look == EventLook::is_odd) {
          source.runs_alone(members_[lane].number);
        } else if (look == EventLook::ends) {
          end(lane, source, Status::event);
        } else if ((attention.ended & bit) != 0) {
          end(lane, source, Status::finished);
        } else if ((attention.used_up & bit) != 0) {
          end(lane, source, Status::max_steps);
        } else {
          continue;
        }
        fill(lane, source);
      }
      goes_on = source.goes_on();
    }
  }

 protected:
  virtual LaneSteps<width>& steps() = 0;
  virtual Attention take_steps() = 0;
  /// Puts the equations of `scene` into a lane; false if they have another form.
  virtual bool put_equations(int lane, const EquationsOfMotion& equations) = 0;
  /// Puts a start, at which the rates are rate(), into a lane.
  virtual void put_start(int lane, const std::vector<double>& y) = 0;
  virtual void get_state(int lane, double* y) = 0;
  virtual long long evaluations_of(int lane) = 0;
  /// What comes of a look for events in the last step of a lane.
  enum class EventLook : std::uint8_t { goes_on, ends, is_odd };
  virtual EventLook look_for_events(int /*lane*/) { return EventLook::goes_on; }
  /// Whether the last step of a lane suggests that the member is stiff.
  virtual bool looks_stiff(int /*lane*/) { return false; }

  Stepper& stepper() { return *stepper_; }
  const std::vector<double>& rate() const { return rate_; }
  const std::vector<double>& rtol() const { return rtol_; }
  const std::vector<double>& atol() const { return atol_; }
  const Options& options() const { return options_; }
  double direction() const { return t_end_ < t0_ ? -1.0 : 1.0; }
  double t_end() const { return t_end_; }
  const LaneInterval& interval() const { return interval_; }
  const Scene& scene() const { return scene_; }
  LaneMember& member(int lane) { return members_[lane]; }

 private:
  /// Begins the next member in a lane, if there is one.
  void fill(int lane, LaneSource& source) {
    LaneMember& member = members_[lane];
    steps().active &= ~(1U << lane);
    while (const Scene* scene = source.next(member)) {
      if (begin(lane, *scene)) {
        steps().active |= 1U << lane;
        return;
      }
      source.runs_alone(member.number);
    }
  }

  /// Returns false if the beginning is not that of a usual run.
  bool begin(int lane, const Scene& scene) {
    const std::vector<double>& y = members_[lane].state;
    if (stepper_ == nullptr || &scene != &scene_) {
      equations_ = equations_of_motion(scene);
      stepper_ = make_stepper(scene, *equations_, method_, false, false);
      stepper_->set_tolerances(rtol_.data(), atol_.data());
    }
    if (!put_equations(lane, *equations_)) return false;
    stepper_->evaluate(t0_, y.data(), rate_.data());
    if (bad_component(y) >= 0 || bad_component(rate_) >= 0) return false;
    LaneSteps<width>& at = steps();
    at.t[lane] = t0_;
    at.t_low[lane] = 0.0;
    at.log2_error_before[lane] = StepControl::log2_smallest_error;
    at.after_rejection[lane] = 0;
    at.accepted[lane] = at.rejected[lane] = 0;
    at.steps_to_look[lane] = first_stiffness_look;
    put_start(lane, y);
    return true;
  }

  void end(int lane, LaneSource& source, Status status) {
    LaneMember& member = members_[lane];
    get_state(lane, member.state.data());
    member.t = steps().t[lane];
    member.status = status;
    statistics_.accepted += steps().accepted[lane];
    statistics_.rejected += steps().rejected[lane];
    statistics_.nfev += evaluations_of(lane);
    source.ended(member);
  }

  const Scene& scene_;
  double t0_, t_end_;
  const Options& options_;
  std::string_view method_;
  LaneInterval interval_;
  std::vector<double> rtol_, atol_;
  std::vector<double> rate_;
  std::array<LaneMember, width> members_;
  std::optional<EquationsOfMotion> equations_;
  std::unique_ptr<Stepper> stepper_;  ///< for the beginnings
};

template <const auto& method, class Form, InstructionSet set>
class RungeKuttaRunner final : public Runner<width_on(set)> {
  static constexpr int width = width_on(set);
  using All = RungeKuttaLanes<method, Form, width>;
  using Equations = typename All::Equations;

 public:
  RungeKuttaRunner(const Scene& scene, double t0, double t_end, const Options& options)
      : Runner<width>(scene, t0, t_end, options, method.info.name), n_(scene.links.size()) {
    for (int lane = 0; lane < width; ++lane) {
      for (int i = 0; i < 2; ++i) {
        Equations::put_state(all_.memory.rtol[i], lane, this->rtol().data() + i * n_);
        Equations::put_state(all_.memory.atol[i], lane, this->atol().data() + i * n_);
      }
    }
  }

 private:
  LaneSteps<width>& steps() override { return all_; }
  Attention take_steps() override { return take_steps_(&all_, &this->interval(), rounds); }
  bool put_equations(int lane, const EquationsOfMotion& equations) override {
    const Form* const form = std::get_if<Form>(&equations.form);
    if (form != nullptr) Equations::put(all_.memory.system.dynamics, lane, *form);
    return form != nullptr;
  }
  void put_start(int lane, const std::vector<double>& y) override {
    const Options& options = this->options();
    double h = std::min(options.first_step.value_or(options.max_step), options.max_step);
    if (!options.first_step) {
      this->stepper().start(y.data(), this->rate().data());
      h = first_step(this->stepper(), all_.t[lane], this->t_end(), options.max_step,
                     this->rtol().data(), this->atol().data())
              .h;
    }
    all_.h[lane] = this->direction() * h;
    for (int i = 0; i < 2; ++i) {
      Equations::put_state(all_.memory.y[i], lane, y.data() + i * n_);
      Equations::put_state(all_.memory.k[0][i], lane, this->rate().data() + i * n_);
    }
  }
  void get_state(int lane, double* y) override {
    for (int i = 0; i < 2; ++i) Equations::get_state(all_.memory.y[i], lane, y + i * n_);
  }
  long long evaluations_of(int lane) override {
    const long long attempts = all_.accepted[lane] + all_.rejected[lane];
    return (this->options().first_step ? 1 : 2) + (All::stages - 1) * attempts;
  }

  std::size_t n_;
  All all_{};
  Attention (*take_steps_)(All*, const LaneInterval*,
                           int) = only<&pendcore::take_steps<method, Form, width>, set>();
};

template <InstructionSet set>
class SeriesRunner final : public Runner<width_on(set)> {
  static constexpr int width = width_on(set);
  using All = SeriesLanes<width>;

 public:
  SeriesRunner(const Scene& scene, double t0, double t_end, const Options& options)
      : Runner<width>(scene, t0, t_end, options, taylor.info.name) {
    double tightest = 1.0;
    for (int i = 0; i < All::size; ++i) {
      tightest = std::min(tightest, std::max(this->rtol()[i], this->atol()[i]));
      all_.rtol[i] = broadcast<Pack<width>>(this->rtol()[i]);
      all_.atol[i] = broadcast<Pack<width>>(this->atol()[i]);
    }
    all_.order = taylor_order(tightest);
    std::vector<FoundEvent> none;
    for (const auto& one : EventFinder(scene, options.events, none, {}).differences()) {
      levels_.push_back({one.plus, one.minus, one.value, one.every_turn});
    }
    all_.levels = levels_.data();
    all_.level_count = static_cast<int>(levels_.size());
    rows_.resize(static_cast<std::size_t>(all_.order + 1) * All::size);
    // Lanes without a member have numbers that do no harm.
    all_.sigma = all_.sigma_new = all_.largest = all_.largest_new = broadcast<Pack<width>>(1.0);
    all_.constants.delta = broadcast<Pack<width>>(1.0);
  }

 private:
  LaneSteps<width>& steps() override { return all_; }
  Attention take_steps() override { return take_steps_(&all_, &this->interval(), rounds); }
  bool put_equations(int lane, const EquationsOfMotion& equations) override {
    const auto* const form = std::get_if<DoublePendulum>(&equations.form);
    if (form == nullptr) return false;
    using Equations = LaneEquations<DoublePendulum, Pack<width>>;
    Equations::put(all_.constants.weight, lane, form->weight);
    Equations::put(all_.constants.coupling, lane, form->coupling);
    all_.constants.product[lane] = form->product;
    all_.constants.delta[lane] = form->delta;
    return true;
  }
  void put_start(int lane, const std::vector<double>& y) override {
    double rate = 0.0;  // as in Taylor::start()
    for (int i = 0; i < 2; ++i) {
      const double qd = this->rate()[i];
      rate = std::max({rate, qd * qd, std::abs(this->rate()[2 + i])});
    }
    for (int i = 0; i < All::size; ++i) all_.y[i][lane] = y[i];
    all_.sigma[lane] = taylor_detail::power_of_two_below(rate > 0.0 ? 1.0 / std::sqrt(rate) : 1.0);
    all_.begins[lane] = -1;
    all_.h[lane] = this->direction();
    look_count_[lane] = 0;
    if (levels_.empty()) return;
    this->member(lane).found.clear();
    finders_[lane].emplace(this->scene(), this->options().events, this->member(lane).found,
                           std::vector<long long>());
  }
  void get_state(int lane, double* y) override {
    for (int i = 0; i < All::size; ++i) y[i] = all_.y[i][lane];
  }

  /// Looks for events as a run does, on the series of the last step in powers of theta.
  typename Runner<width>::EventLook look_for_events(int lane) override {
    using Look = typename Runner<width>::EventLook;
    const double h = all_.h_before[lane];
    const double x = h / all_.sigma_new[lane];  // sigma before the step
    constexpr double no_large_powers = 256.0;
    if (!(std::abs(x) <= no_large_powers)) return Look::is_odd;
    double power = 1.0;
    for (int k = 0; k <= all_.order; ++k, power *= x) {
      for (int i = 0; i < All::size; ++i) {
        const int at = k * All::size + i;
        rows_[at] = k == 0 ? all_.y_new[i][lane] : power * all_.rows_new[at][lane];
      }
    }
    const double* const highest =
        rows_.data() + static_cast<std::ptrdiff_t>(All::size) * all_.order;
    if (!std::isfinite(highest[0] + highest[1] + highest[2] + highest[3])) return Look::is_odd;
    std::array<double, All::size> y{};
    get_state(lane, y.data());
    this->stepper().set_new_state(y.data());
    const TwoDouble t_old{all_.t_before[lane], all_.t_low_before[lane]};
    const double t_new = all_.t[lane];
    EventFinder& finder = *finders_[lane];
    const StepEnd found = finder.look(this->stepper(), rows_.data(), t_old, h, t_new);
    if (found.has_too_many_turns()) return Look::is_odd;
    if (finder.ended_by() < 0) return Look::goes_on;
    if (found.is_within()) {
      const double theta = found.theta;
      const TwoDouble t = time_in_step(t_old, h, theta, t_new);
      if (t.high == t_old.high) return Look::is_odd;
      this->stepper().sample(rows_.data(), {}, 1.0, &theta, 1, y.data());
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
    const double h = all_.h_before[lane];
    const double rate = taylor.info.stability * all_.order / std::abs(h);
    const auto rates = [this](double t, const double* state, double* dydt) {
      this->stepper().evaluate(t, state, dydt);
    };
    const double lambda = eigenvalue_(rates, 0.0, y.data(), rate);
    return std::abs(h) * lambda / all_.order > taylor.info.stability;
  }

  All all_{};
  std::array<long long, width> look_count_{};
  DominantEigenvalue eigenvalue_{2, 0};
  std::vector<LaneLevel> levels_;
  std::array<std::optional<EventFinder>, width> finders_;
  std::vector<double> rows_;
  Attention (*take_steps_)(All*, const LaneInterval*, int) = only<&take_series_steps<width>, set>();
};

template <InstructionSet set>
std::unique_ptr<LaneRunner> lanes_of(std::string_view method, const Scene& scene, double t0,
                                     double t_end, const Options& options) {
  if (method == dormand_prince_5.info.name) {
    using Of = RungeKuttaRunner<dormand_prince_5, DoublePendulum, set>;
    return std::make_unique<Of>(scene, t0, t_end, options);
  }
  if (method == dormand_prince_8.info.name) {
    using Of = RungeKuttaRunner<dormand_prince_8, DoublePendulum, set>;
    return std::make_unique<Of>(scene, t0, t_end, options);
  }
  if (method == taylor.info.name && !options.first_step) {
    return std::make_unique<SeriesRunner<set>>(scene, t0, t_end, options);
  }
  return nullptr;
}

}  // namespace

std::unique_ptr<LaneRunner> make_lanes(const Scene& scene, double t0, double t_end,
                                       const Options& options) {
  const bool is_plain =
      !options.step && !options.compensated && !options.ledger && options.store == Store::end;
  if (!is_plain || t0 == t_end || instruction_set() < least_of_special_kernels) return nullptr;
  if (!std::holds_alternative<DoublePendulum>(equations_of_motion(scene).form)) return nullptr;
  const std::string_view method = find_method(chosen_method(scene, options)).first();
  if (!options.events.empty()) {
    std::vector<FoundEvent> none;
    const bool are_differences =
        !EventFinder(scene, options.events, none, {}).differences().empty();
    if (method != taylor.info.name || !are_differences) return nullptr;
  }
  if constexpr (PENDCORE_CLONES != 0) {
    if (instruction_set() == InstructionSet::x86_64_v4) {
      return lanes_of<InstructionSet::x86_64_v4>(method, scene, t0, t_end, options);
    }
  }
  return lanes_of<InstructionSet::x86_64_v3>(method, scene, t0, t_end, options);
}

}  // namespace pendcore
