#include "ensemble/lanes.hpp"

#include "ensemble/lane_loop.hpp"
#include "ensemble/runge_kutta_lanes.hpp"
#include "integrate/loop/first_step.hpp"
#include "pendcore/methods.hpp"
#include "scene/effects_of_scene.hpp"

namespace pendcore {
namespace {

template <const auto& method, template <class> class Form, InstructionSet set>
class RungeKuttaRunner final : public LaneLoop<width_on(set)> {
  static constexpr int width = width_on(set);
  using All = RungeKuttaLanes<method, Form, width>;
  using Block = typename All::Block;

 public:
  explicit RungeKuttaRunner(const LaneTask& task)
      : LaneLoop<width>(task, method.info.name), n_(task.scene.links.size()) {
    this->prepare(all_.memory.system.dynamics);
    for (int lane = 0; lane < width; ++lane) {
      for (int i = 0; i < 2; ++i) {
        put_row(all_.memory.rtol[i], lane, this->rtol().data() + i * n_);
        put_row(all_.memory.atol[i], lane, this->atol().data() + i * n_);
      }
    }
  }

 private:
  static void put_row(Block& row, int lane, const double* from) {
    for (int i = 0; i < All::links; ++i) {
      auto of_link = number_of(row, i);
      of_link[lane] = from[i];
      set_number(row, i, of_link);
    }
  }
  static void get_row(const Block& row, int lane, double* to) {
    for (int i = 0; i < All::links; ++i) to[i] = number_of(row, i)[lane];
  }
  void get_derivative(int lane, double* dydt) override {
    for (int i = 0; i < 2; ++i) get_row(all_.memory.k[0][i], lane, dydt + i * n_);
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
  void put_equations(int lane, const Scene& scene) override {
    all_.memory.system.dynamics.put(lane, scene, this->equations());
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
      put_row(all_.memory.y[i], lane, y.data() + i * n_);
      put_row(all_.memory.k[0][i], lane, this->rate().data() + i * n_);
    }
  }
  void put_state(int lane, const double* y) override {
    for (int i = 0; i < 2; ++i) put_row(all_.memory.y[i], lane, y + i * n_);
  }
  void get_state(int lane, double* y) const override {
    for (int i = 0; i < 2; ++i) get_row(all_.memory.y[i], lane, y + i * n_);
  }
  void get_state_before(int lane, double* y) const override {
    for (int i = 0; i < 2; ++i) get_row(all_.y_before[i], lane, y + i * n_);
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

template <template <class> class Form, InstructionSet set>
std::unique_ptr<LaneRunner> runge_kutta_lanes(std::string_view method, const LaneTask& task) {
  if (method == dormand_prince_5.info.name) {
    return std::make_unique<RungeKuttaRunner<dormand_prince_5, Form, set>>(task);
  }
  return std::make_unique<RungeKuttaRunner<dormand_prince_8, Form, set>>(task);
}

template <class Use>
bool with_form(const Scene& scene, const EquationsOfMotion& equations, const Use& use) {
  return with_first_form<OneLinkWithCouples, OneLinkWithEverything, TwoBareLinksInLanes,
                         TwoLinksWithCouples, TwoLinksWithWaves, TwoLinksWithLaws,
                         TwoLinksWithEverything, ThreeLinksInLanes, FourLinksInLanes>(
      scene, equations, use);
}

template <InstructionSet set>
std::unique_ptr<LaneRunner> lanes_of(std::string_view method, const LaneTask& task) {
  if (method == taylor.info.name) return make_series_lanes<set>(task);
  std::unique_ptr<LaneRunner> runner;
  with_form(task.scene, *task.equations, [&]<template <class> class Form>() {
    runner = runge_kutta_lanes<Form, set>(method, task);
  });
  return runner;
}

/// Whether the lanes of a method have the equations of a scene.
bool has_lanes(std::string_view method, const Scene& scene, const EquationsOfMotion& equations) {
  if (instruction_set() < least_of_special_kernels || !equations.are_steady()) return false;
  if (method == taylor.info.name) {
    const std::size_t n = scene.links.size();
    return n >= 2 && n <= most_links_in_lanes && !without_series(scene);
  }
  const bool is_embedded =
      method == dormand_prince_5.info.name || method == dormand_prince_8.info.name;
  return is_embedded && with_form(scene, equations, []<template <class> class>() {});
}

}  // namespace

std::vector<std::string_view> methods_with_lanes(const Scene& scene) {
  const EquationsOfMotion equations = equations_of_motion(scene);
  std::vector<std::string_view> methods{dormand_prince_5.info.name, dormand_prince_8.info.name,
                                        taylor.info.name};
  std::erase_if(methods, [&](std::string_view one) { return !has_lanes(one, scene, equations); });
  return methods;
}

std::unique_ptr<LaneRunner> make_lanes(const Scene& scene, double t0, double t_end,
                                       const Options& options) {
  const bool is_plain = !options.step && !options.compensated && !options.ledger &&
                        (options.store == Store::times || options.store == Store::end);
  if (!is_plain || t0 == t_end) return nullptr;
  const std::string_view method = find_method(chosen_method(scene, options)).first();
  if (method == taylor.info.name && options.first_step) return nullptr;
  const auto equations = std::make_shared<const EquationsOfMotion>(equations_of_motion(scene));
  if (!has_lanes(method, scene, *equations)) return nullptr;
  const auto is_function = [](const Event& event) {
    return std::holds_alternative<events::Function>(event.function);
  };
  if (std::ranges::any_of(options.events, is_function)) return nullptr;
  const LaneTask task{scene, equations, t0, t_end, options};
  if constexpr (PENDCORE_CLONES != 0) {
    if (instruction_set() == InstructionSet::x86_64_v4) {
      return lanes_of<InstructionSet::x86_64_v4>(method, task);
    }
  }
  return lanes_of<InstructionSet::x86_64_v3>(method, task);
}

}  // namespace pendcore
