/// \file
/// Fills the lanes of an explicit Runge-Kutta method, and takes their steps.
#pragma once

#include <algorithm>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "ensemble/lane_loop.hpp"
#include "ensemble/runge_kutta_lanes.hpp"
#include "integrate/loop/first_step.hpp"
#include "pendcore/methods.hpp"
#include "simulate/kinks_of_run.hpp"

namespace pendcore {

template <const auto& method, class Equations, InstructionSet set>
class RungeKuttaRunner final : public LaneLoop<width_on(set)> {
  static constexpr int width = width_on(set);
  using All = RungeKuttaLanes<method, Equations, width>;
  using Block = typename All::Block;

 public:
  RungeKuttaRunner(const LaneTask& task, Equations equations)
      : LaneLoop<width>(task, method.info.name), n_(task.scene.links.size()) {
    all_.memory.system.dynamics = std::move(equations);
    this->prepare(all_.memory.system.dynamics);
    if constexpr (All::may_end_at_kinks) {
      if (ends_at_kinks(method.info, tightest_tolerance(task.options, n_))) watch_kinks(task.scene);
    }
    for (int lane = 0; lane < width; ++lane) {
      for (int i = 0; i < 2; ++i) {
        put_row(all_.memory.rtol[i], lane, this->rtol_.data() + i * n_);
        put_row(all_.memory.atol[i], lane, this->atol_.data() + i * n_);
      }
    }
  }

 private:
  void watch_kinks(const Scene& scene) {
    all_.air.prepare(scene, all_.memory.system.dynamics.drives());
    all_.air.set_tolerances(this->rtol_, this->atol_);
    for (int lane = 0; lane < width; ++lane) all_.air.put(scene, lane);
    all_.find_kinks = only<&find_first_kinks<method, Equations, width>, set>();
    all_.speeds = all_.speeds_after = all_.air.room_for_speeds();
  }
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
  Attention take_steps() override {
    Attention attention = take_steps_(&all_, &this->interval_, rounds_at_once);
    const LaneBits every = all_.interpolates_every_step ? attention.recorded : 0;
    if ((attention.sampled | attention.searched | every) != 0) {
      attention.recorded |= attention.searched & interpolate_(&all_);
    }
    return attention;
  }
  void put_equations(int lane, const Scene& scene) override {
    all_.memory.system.dynamics.put(lane, scene, *this->equations_);
    if (all_.air.count() != 0) all_.air.put(scene, lane);
  }
  void put_start(int lane, const std::vector<double>& y) override {
    all_.are_speeds_known = false;
    const Options& options = this->options_;
    double h = std::min(options.first_step.value_or(options.max_step), options.max_step);
    if (!options.first_step) {
      this->stepper(lane).start(y.data(), this->rate_.data());
      h = first_step(this->stepper(lane), all_.t[lane], this->t_end_, options.max_step,
                     this->rtol_.data(), this->atol_.data())
              .h;
    }
    all_.h[lane] = this->direction() * h;
    for (int i = 0; i < 2; ++i) {
      put_row(all_.memory.y[i], lane, y.data() + i * n_);
      put_row(all_.memory.k[0][i], lane, this->rate_.data() + i * n_);
    }
  }
  void put_state(int lane, const double* y) override {
    all_.are_speeds_known = false;
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
  long long evaluations_of(int lane) override {
    constexpr int of_dense_output = All::Memory::all_stages - All::stages;
    const long long attempts = all_.accepted[lane] + all_.rejected[lane];
    return (this->options_.first_step ? 1 : 2) + (All::stages - 1) * attempts +
           of_dense_output * this->interpolated(lane);
  }

  std::size_t n_;
  All all_{};
  Attention (*take_steps_)(All*, const LaneInterval*,
                           int) = only<&pendcore::take_steps<method, Equations, width>, set>();
  LaneBits (*interpolate_)(All*) = only<&interpolate_step<method, Equations, width>, set>();
};

template <const auto& method, InstructionSet set>
std::unique_ptr<LaneRunner> runner_of(const LaneTask& task) {
  using Real = Pack<width_on(set)>;
  std::unique_ptr<LaneRunner> runner;
  with_runge_kutta_form<Real>(task.scene, *task.equations, [&]<class Form>() {
    using Row = typename Form::Links;
    if constexpr (Form::is_called) {
      using System = FirstOrder<Form>;
      const auto form = std::make_shared<System>();
      using Called = CalledEquations<Real, Row>;
      runner = std::make_unique<RungeKuttaRunner<method, Called, set>>(
          task, Called{.form = form,
                       .compute = only<&derivative_in_lanes<System, Real, Row>, set>(),
                       .prepare = [form](const auto&... one) { form->dynamics.prepare(one...); },
                       .put = [form](const auto&... one) { form->dynamics.put(one...); },
                       .drives = [form] { return form->dynamics.drives(); }});
    } else {
      runner = std::make_unique<RungeKuttaRunner<method, Form, set>>(task, Form());
    }
  });
  return runner;
}

template <InstructionSet set>
std::unique_ptr<LaneRunner> make_runge_kutta_lanes(std::string_view method, const LaneTask& task) {
  return method == dormand_prince_5.info.name ? runner_of<dormand_prince_5, set>(task)
                                              : runner_of<dormand_prince_8, set>(task);
}

}  // namespace pendcore
