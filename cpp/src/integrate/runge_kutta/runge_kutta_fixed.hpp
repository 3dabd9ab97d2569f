/// \file
/// An explicit Runge-Kutta method applied to a system, as the loop sees it.
#pragma once

#include <cmath>
#include <memory>
#include <tuple>
#include <utility>

#include "integrate/horner.hpp"
#include "integrate/runge_kutta/step.hpp"
#include "integrate/stepper.hpp"

namespace pendcore {

/// The right-hand side on plain numbers.
template <class System>
PENDCORE_INLINE void evaluate_system(const System* system, double t, const double* y,
                                     double* dydt) {
  using Block = typename System::Block;
  constexpr int width = Lanes<Block>::width;
  Block state[System::blocks];
  Block rate[System::blocks];
  for (int i = 0; i < System::blocks; ++i) state[i] = load<Block>(y + i * width);
  (*system)(t, state, rate);
  for (int i = 0; i < System::blocks; ++i) store(dydt + i * width, rate[i]);
}

template <const auto& method, class System, Sets sets = usual_sets>
class RungeKuttaFixed final : public Stepper {
  using Memory = StepMemory<method, System>;
  using Block = typename Memory::Block;
  static constexpr int blocks = Memory::blocks;
  static constexpr int width = Lanes<Block>::width;
  static constexpr int stages = Memory::stages;

 public:
  /// `owner` keeps alive what the system points to.
  explicit RungeKuttaFixed(const System& system, std::shared_ptr<const void> owner = nullptr)
      : memory_{system}, owner_(std::move(owner)) {}

  const MethodInfo& info() const override { return method.info; }
  int dimension() const override { return blocks * width; }
  int interpolant_degree() const override { return Memory::degree; }

  void set_tolerances(const double* rtol, const double* atol) override {
    read(rtol, memory_.rtol);
    read(atol, memory_.atol);
  }

  void start(const double* y, const double* dydt) override {
    read(y, memory_.y);
    read(dydt, memory_.k[0]);
  }

  void get_state(double* y) const override { write(memory_.y, y); }
  void get_derivative(double* dydt) const override { write(memory_.k[0], dydt); }
  void get_new_state(double* y) const override { write(memory_.y_new, y); }

  void set_new_state(const double* y) override { read(y, memory_.y_new); }
  void get_new_derivative(double* dydt) const override {
    if constexpr (!method.first_same_as_last) return Stepper::get_new_derivative(dydt);
    write(memory_.k[stages - 1], dydt);
  }

  void evaluate(double t, const double* y, double* dydt) override {
    evaluate_(&memory_.system, t, y, dydt);
    ++evaluations;
  }

  Attempt attempt(const TwoDouble& t, double h, double gain) override {
    evaluations += stages - 1;
    t_ = t.high;
    has_dense_stages_ = Memory::all_stages == stages;
    return attempt_(&memory_, t.high, h, gain);
  }

  void stay() override {
    for (int i = 0; i < blocks; ++i) {
      memory_.y_new[i] = memory_.y[i];
      for (int s = 0; s < Memory::all_stages; ++s) memory_.k[s][i] = Block{};
    }
    has_dense_stages_ = true;
  }

  void accept(double t_new) override {
    for (int i = 0; i < blocks; ++i) memory_.y[i] = memory_.y_new[i];
    if constexpr (method.first_same_as_last) {
      for (int i = 0; i < blocks; ++i) memory_.k[0][i] = memory_.k[stages - 1][i];
    } else {
      double y[blocks * width];
      double rate[blocks * width];
      write(memory_.y_new, y);
      evaluate(t_new, y, rate);
      read(rate, memory_.k[0]);
    }
  }

  void interpolant(double h, double* coefficients) override {
    if (!has_dense_stages_) {
      evaluations += Memory::all_stages - stages;
      dense_stages_(&memory_, t_, h);
      has_dense_stages_ = true;
    }
    interpolant_(memory_.y, memory_.k, h, coefficients);
  }

  void sample(const double* coefficients, const TwoDouble& start, double h, const double* times,
              int count, double* states) const override {
    sample_(coefficients, start, h, times, count, states);
  }

  double stiffness(double h) override {
    if constexpr (method.info.stability == 0.0) {
      return 0.0;
    } else {
      return stiffness_of_step<method>(h, blocks, [this](int i) {
        return std::tuple(memory_.y[i], memory_.y_new[i], StageBlock(memory_.k, i));
      });
    }
  }

 private:
  static void read(const double* from, Block* to) {
    for (int i = 0; i < blocks; ++i) to[i] = load<Block>(from + i * width);
  }
  static void write(const Block* from, double* to) {
    for (int i = 0; i < blocks; ++i) store(to + i * width, from[i]);
  }

  Memory memory_;
  std::shared_ptr<const void> owner_;
  double t_ = 0.0;  ///< the time of the attempt
  bool has_dense_stages_ = false;
  Attempt (*attempt_)(Memory*, double, double,
                      double) = fastest<&attempt_step<method, System>, sets>();
  void (*dense_stages_)(Memory*, double,
                        double) = fastest<&dense_stages_of_step<method, System>, sets>();
  void (*interpolant_)(const Block*, const Block (*)[blocks], double,
                       double*) = fastest<&interpolant_of_step<method, Block, blocks>, sets>();
  void (*sample_)(const double*, TwoDouble, double, const double*, int,
                  double*) = fastest<&sample_blocks<Block, blocks, Memory::degree>, sets>();
  void (*evaluate_)(const System*, double, const double*,
                    double*) = fastest<&evaluate_system<System>, sets>();
};

}  // namespace pendcore
