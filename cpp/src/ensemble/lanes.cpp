#include "pendcore/ensemble/lanes.hpp"

#include <algorithm>
#include <cmath>

#include "pendcore/ensemble/runge_kutta_lanes.hpp"
#include "pendcore/integrate/loop/first_step.hpp"
#include "pendcore/integrate/methods.hpp"
#include "pendcore/simulate/initial_state.hpp"
#include "pendcore/simulate/method_choice.hpp"

namespace pendcore {
namespace {

/// As many lanes as a register of the processor holds.
constexpr int width_on(InstructionSet set) { return set == InstructionSet::x86_64_v4 ? 8 : 4; }
/// Steps between two looks at whether to go on: a fraction of a millisecond.
constexpr int rounds = 256;

template <const auto& method, class Form, InstructionSet set>
class RungeKuttaRunner final : public LaneRunner {
  static constexpr int width = width_on(set);
  using All = RungeKuttaLanes<method, Form, width>;
  using Equations = typename All::Equations;

 public:
  RungeKuttaRunner(const Scene& scene, double t0, double t_end, const Options& options)
      : scene_(scene),
        t0_(t0),
        t_end_(t_end),
        options_(options),
        interval_{t_end, options.max_step, options.max_steps},
        rtol_(relative_tolerances(options, scene.links.size())),
        atol_(absolute_tolerances(options, scene.links.size())) {
    auto& memory = all_.memory;
    const int n = static_cast<int>(scene.links.size());
    for (int lane = 0; lane < width; ++lane) {
      for (int i = 0; i < 2; ++i) {
        Equations::put_state(memory.rtol[i], lane, rtol_.data() + i * n);
        Equations::put_state(memory.atol[i], lane, atol_.data() + i * n);
      }
    }
  }

  void run(LaneSource& source) override {
    bool goes_on = true;
    for (int lane = 0; lane < width; ++lane) fill(lane, source);
    while (all_.active != 0 && goes_on) {
      const Attention attention = take_steps_(&all_, &interval_, rounds);
      for (int lane = 0; lane < width; ++lane) {
        const LaneBits bit = 1U << lane;
        if (((attention.ended | attention.used_up | attention.odd) & bit) == 0) continue;
        if ((attention.odd & bit) != 0) {
          source.runs_alone(members_[lane].number);
        } else {
          end(lane, source, (attention.ended & bit) != 0 ? Status::finished : Status::max_steps);
        }
        fill(lane, source);
      }
      goes_on = source.goes_on();
    }
  }

 private:
  /// Begins the next member in a lane, if there is one.
  void fill(int lane, LaneSource& source) {
    LaneMember& member = members_[lane];
    all_.active &= ~(1U << lane);
    while (const Scene* scene = source.next(member)) {
      if (begin(lane, *scene)) {
        all_.active |= 1U << lane;
        return;
      }
      source.runs_alone(member.number);
    }
  }

  /// Returns false if the beginning is not that of a usual run.
  bool begin(int lane, const Scene& scene) {
    const std::vector<double>& y = members_[lane].state;
    const std::size_t n = scene.links.size();
    if (stepper_ == nullptr || &scene != &scene_) {
      const EquationsOfMotion equations = equations_of_motion(scene);
      const Form* form = std::get_if<Form>(&equations.form);
      if (form == nullptr) return false;
      stepper_ = make_stepper(scene, equations, method.info.name, false, false);
      stepper_->set_tolerances(rtol_.data(), atol_.data());
      equations_ = std::make_unique<Form>(*form);
    }
    Equations::put(all_.memory.system.dynamics, lane, *equations_);
    rate_.resize(2 * n);
    stepper_->evaluate(t0_, y.data(), rate_.data());
    if (bad_component(y) >= 0 || bad_component(rate_) >= 0) return false;
    stepper_->start(y.data(), rate_.data());
    double h = std::min(options_.first_step.value_or(options_.max_step), options_.max_step);
    if (!options_.first_step) {
      h = first_step(*stepper_, t0_, t_end_, options_.max_step, rtol_.data(), atol_.data()).h;
    }
    for (int i = 0; i < 2; ++i) {
      Equations::put_state(all_.memory.y[i], lane, y.data() + i * n);
      Equations::put_state(all_.memory.k[0][i], lane, rate_.data() + i * n);
    }
    all_.t[lane] = t0_;
    all_.t_low[lane] = 0.0;
    all_.h[lane] = std::copysign(h, t_end_ - t0_);
    all_.log2_error_before[lane] = StepControl::log2_smallest_error;
    all_.after_rejection[lane] = 0;
    all_.accepted[lane] = all_.rejected[lane] = 0;
    all_.steps_to_look[lane] = first_stiffness_look;
    return true;
  }

  void end(int lane, LaneSource& source, Status status) {
    LaneMember& member = members_[lane];
    const std::size_t n = scene_.links.size();
    for (int i = 0; i < 2; ++i) {
      Equations::get_state(all_.memory.y[i], lane, member.state.data() + i * n);
    }
    member.t = all_.t[lane];
    member.status = status;
    statistics_.accepted += all_.accepted[lane];
    statistics_.rejected += all_.rejected[lane];
    statistics_.nfev += (options_.first_step ? 1 : 2) +
                        (All::stages - 1) * (all_.accepted[lane] + all_.rejected[lane]);
    source.ended(member);
  }

  const Scene& scene_;
  double t0_, t_end_;
  const Options& options_;
  LaneInterval interval_;
  std::vector<double> rtol_, atol_;
  All all_{};
  std::array<LaneMember, width> members_;
  std::unique_ptr<Stepper> stepper_;  ///< for the beginnings
  std::unique_ptr<Form> equations_;
  std::vector<double> rate_;
  Attention (*take_steps_)(All*, const LaneInterval*,
                           int) = only<&take_steps<method, Form, width>, set>();
};

template <const auto& method>
std::unique_ptr<LaneRunner> lanes_of(const Scene& scene, double t0, double t_end,
                                     const Options& options) {
  const EquationsOfMotion equations = equations_of_motion(scene);
  if (!std::holds_alternative<DoublePendulum>(equations.form)) return nullptr;
  const auto on = [&]<InstructionSet set>() -> std::unique_ptr<LaneRunner> {
    using Runner = RungeKuttaRunner<method, DoublePendulum, set>;
    return std::make_unique<Runner>(scene, t0, t_end, options);
  };
  if constexpr (PENDCORE_CLONES != 0) {
    if (instruction_set() == InstructionSet::x86_64_v4) {
      return on.template operator()<InstructionSet::x86_64_v4>();
    }
  }
  return on.template operator()<InstructionSet::x86_64_v3>();
}

}  // namespace

std::unique_ptr<LaneRunner> make_lanes(const Scene& scene, double t0, double t_end,
                                       const Options& options) {
  const bool is_plain = !options.step && !options.compensated && !options.ledger &&
                        options.events.empty() && options.store == Store::end;
  if (!is_plain || t0 == t_end || instruction_set() < least_of_special_kernels) return nullptr;
  const MethodInfo& info = find_method(chosen_method(scene, options));
  if (info.first() == dormand_prince_5.info.name) {
    return lanes_of<dormand_prince_5>(scene, t0, t_end, options);
  }
  if (info.first() == dormand_prince_8.info.name) {
    return lanes_of<dormand_prince_8>(scene, t0, t_end, options);
  }
  return nullptr;
}

}  // namespace pendcore
