#include "ensemble/lanes.hpp"

#include "ensemble/lane_loop.hpp"
#include "ensemble/runge_kutta_lanes.hpp"
#include "integrate/loop/first_step.hpp"
#include "pendcore/methods.hpp"
#include "scene/effects_of_scene.hpp"

namespace pendcore {
namespace {

template <const auto& method, class Form, InstructionSet set>
class RungeKuttaRunner final : public LaneLoop<width_on(set)> {
  static constexpr int width = width_on(set);
  using All = RungeKuttaLanes<method, Form, width>;
  using Equations = typename All::Equations;

 public:
  RungeKuttaRunner(const Scene& scene, double t0, double t_end, const Options& options)
      : LaneLoop<width>(scene, t0, t_end, options, method.info.name), n_(scene.links.size()) {
    Equations::prepare(all_.memory.system.dynamics, equations_of_motion(scene));
    for (int lane = 0; lane < width; ++lane) {
      for (int i = 0; i < 2; ++i) {
        Equations::put_state(all_.memory.rtol[i], lane, this->rtol().data() + i * n_);
        Equations::put_state(all_.memory.atol[i], lane, this->atol().data() + i * n_);
      }
    }
  }

 private:
  void get_derivative(int lane, double* dydt) override {
    for (int i = 0; i < 2; ++i) Equations::get_state(all_.memory.k[0][i], lane, dydt + i * n_);
  }
  std::vector<double> saved_state(int /*lane*/) override { return {}; }
  LaneSteps<width>& steps() override { return all_; }
  const LaneSteps<width>& steps() const override { return all_; }
  Attention take_steps() override {
    Attention attention = take_steps_(&all_, &this->interval(), rounds_at_once);
    const LaneBits every = all_.interpolates_every_step ? attention.recorded : 0;
    if ((attention.sampled | attention.searched | every) != 0) {
      attention.recorded |= attention.searched & interpolate_(&all_);
    }
    return attention;
  }
  bool put_equations(int lane) override {
    return Equations::put(all_.memory.system.dynamics, lane, this->equations());
  }
  void put_start(int lane, const std::vector<double>& y) override {
    const Options& options = this->options();
    double h = std::min(options.first_step.value_or(options.max_step), options.max_step);
    if (!options.first_step) {
      this->stepper(lane).start(y.data(), this->rate().data());
      h = first_step(this->stepper(lane), all_.t[lane], this->t_end(), options.max_step,
                     this->rtol().data(), this->atol().data())
              .h;
    }
    all_.h[lane] = this->direction() * h;
    for (int i = 0; i < 2; ++i) {
      Equations::put_state(all_.memory.y[i], lane, y.data() + i * n_);
      Equations::put_state(all_.memory.k[0][i], lane, this->rate().data() + i * n_);
    }
  }
  void put_state(int lane, const double* y) override {
    for (int i = 0; i < 2; ++i) Equations::put_state(all_.memory.y[i], lane, y + i * n_);
  }
  void get_state(int lane, double* y) const override {
    for (int i = 0; i < 2; ++i) Equations::get_state(all_.memory.y[i], lane, y + i * n_);
  }
  void get_state_before(int lane, double* y) const override {
    for (int i = 0; i < 2; ++i) Equations::get_state(all_.y_before[i], lane, y + i * n_);
  }
  bool write_interpolant(int lane, double* coefficients) const override {
    for (const auto& number : all_.rows) *coefficients++ = number[lane];
    return true;
  }
  long long evaluations_of(int lane) const override {
    constexpr int of_dense_output = All::Memory::all_stages - All::stages;
    const long long attempts = all_.accepted[lane] + all_.rejected[lane];
    return (this->options().first_step ? 1 : 2) + (All::stages - 1) * attempts +
           of_dense_output * this->interpolated(lane);
  }

  std::size_t n_;
  All all_{};
  Attention (*take_steps_)(All*, const LaneInterval*,
                           int) = only<&pendcore::take_steps<method, Form, width>, set>();
  LaneBits (*interpolate_)(All*) = only<&interpolate_step<method, Form, width>, set>();
};

template <class Form, InstructionSet set>
std::unique_ptr<LaneRunner> runge_kutta_lanes(std::string_view method, const Scene& scene,
                                              double t0, double t_end, const Options& options) {
  if (method == dormand_prince_5.info.name) {
    using Of = RungeKuttaRunner<dormand_prince_5, Form, set>;
    return std::make_unique<Of>(scene, t0, t_end, options);
  }
  if (method == dormand_prince_8.info.name) {
    using Of = RungeKuttaRunner<dormand_prince_8, Form, set>;
    return std::make_unique<Of>(scene, t0, t_end, options);
  }
  return nullptr;
}

template <InstructionSet set>
std::unique_ptr<LaneRunner> lanes_of(std::string_view method, const Scene& scene, double t0,
                                     double t_end, const Options& options) {
  if (method == taylor.info.name) {
    return options.first_step ? nullptr : make_series_lanes<set>(scene, t0, t_end, options);
  }
  switch (scene.links.size()) {
    case 1: return runge_kutta_lanes<SinglePendulum, set>(method, scene, t0, t_end, options);
    case 3: return runge_kutta_lanes<FreeChain<3>, set>(method, scene, t0, t_end, options);
    case 4: return runge_kutta_lanes<FreeChain<4>, set>(method, scene, t0, t_end, options);
    default: break;
  }
  const EquationsOfMotion equations = equations_of_motion(scene);
  if (std::holds_alternative<DoublePendulum>(equations.form)) {
    return runge_kutta_lanes<DoublePendulum, set>(method, scene, t0, t_end, options);
  }
  return runge_kutta_lanes<TwoLinksWithEffects, set>(method, scene, t0, t_end, options);
}

}  // namespace

std::vector<std::string_view> methods_with_lanes(const Scene& scene) {
  if (instruction_set() < least_of_special_kernels) return {};
  const EquationsOfMotion equations = equations_of_motion(scene);
  if (!equations.are_steady()) return {};
  std::vector<std::string_view> methods;
  if (std::holds_alternative<DoublePendulum>(equations.form) ||
      LaneEquations<TwoLinksWithEffects, Pack<4>>::has(equations) ||
      LaneEquations<SinglePendulum, Pack<4>>::has(equations) ||
      LaneEquations<FreeChain<3>, Pack<4>>::has(equations) ||
      LaneEquations<FreeChain<4>, Pack<4>>::has(equations)) {
    methods = {dormand_prince_5.info.name, dormand_prince_8.info.name};
  }
  const std::size_t n = scene.links.size();
  const bool has_series = n >= 2 && n <= most_links_in_lanes && !without_series(scene);
  if (has_series) methods.push_back(taylor.info.name);
  return methods;
}

std::unique_ptr<LaneRunner> make_lanes(const Scene& scene, double t0, double t_end,
                                       const Options& options) {
  const bool is_plain = !options.step && !options.compensated && !options.ledger &&
                        (options.store == Store::times || options.store == Store::end);
  if (!is_plain || t0 == t_end) return nullptr;
  const std::string_view method = find_method(chosen_method(scene, options)).first();
  if (std::ranges::count(methods_with_lanes(scene), method) == 0) return nullptr;
  const auto is_function = [](const Event& event) {
    return std::holds_alternative<events::Function>(event.function);
  };
  if (std::ranges::any_of(options.events, is_function)) return nullptr;
  if constexpr (PENDCORE_CLONES != 0) {
    if (instruction_set() == InstructionSet::x86_64_v4) {
      return lanes_of<InstructionSet::x86_64_v4>(method, scene, t0, t_end, options);
    }
  }
  return lanes_of<InstructionSet::x86_64_v3>(method, scene, t0, t_end, options);
}

}  // namespace pendcore
