/// \file
/// An explicit Runge-Kutta method applied to a system, as the loop sees it.
#pragma once

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "pendcore/integrate/runge_kutta/step.hpp"
#include "pendcore/integrate/stepper.hpp"

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

template <const auto& method, class System, bool compensated = false>
class RungeKuttaFixed final : public Stepper {
  using Memory = StepMemory<method, System, compensated>;
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
    if constexpr (compensated) forget(y, memory_.y, memory_.low.before);
    read(y, memory_.y);
    read(dydt, memory_.k[0]);
  }

  void get_state(double* y) const override { write(memory_.y, y); }
  void get_derivative(double* dydt) const override { write(memory_.k[0], dydt); }
  void get_new_state(double* y) const override { write(memory_.y_new, y); }

  void set_new_state(const double* y) override {
    if constexpr (compensated) forget(y, memory_.y_new, memory_.low.after);
    read(y, memory_.y_new);
  }

  void evaluate(double t, const double* y, double* dydt) override {
    evaluate_(&memory_.system, t, y, dydt);
    ++evaluations;
  }

  Attempt attempt(double t, double h, double gain) override {
    evaluations += stages - 1;
    t_ = t;
    has_dense_stages_ = Memory::all_stages == stages;
    return attempt_(&memory_, t, h, gain);
  }

  void stay() override {
    for (int i = 0; i < blocks; ++i) {
      memory_.y_new[i] = memory_.y[i];
      for (int s = 0; s < Memory::all_stages; ++s) memory_.k[s][i] = Block{};
    }
    has_dense_stages_ = true;
    if constexpr (compensated) {
      for (int i = 0; i < blocks; ++i) memory_.low.after[i] = memory_.low.before[i];
    }
  }

  void accept(double t_new) override {
    for (int i = 0; i < blocks; ++i) memory_.y[i] = memory_.y_new[i];
    if constexpr (compensated) {
      for (int i = 0; i < blocks; ++i) memory_.low.before[i] = memory_.low.after[i];
    }
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

  std::vector<double> saved_state() const override {
    std::vector<double> low;
    if constexpr (compensated) {
      low.resize(dimension());
      write(memory_.low.before, low.data());
    }
    return low;
  }
  void restore(const std::vector<double>& memory) override {
    if constexpr (compensated) {
      if (has_low_part(memory, dimension())) read(memory.data(), memory_.low.before);
    }
  }

  /// |k_last - k_before| / |y_last - y_before|: both stages lie at the end of the step.
  double stiffness(double h) override {
    if constexpr (method.info.stability == 0.0) {
      return 0.0;
    } else {
      static_assert(method.first_same_as_last && stages >= 3 && method.c[stages - 2].value() == 1.0,
                    "the test for stiffness needs two stages at the end of the step");
      double rates = 0.0;
      double states = 0.0;
      for (int i = 0; i < blocks; ++i) {
        const Block before =
            advance(memory_.y[i], h, method.a[stages - 2], StageBlock(memory_.k, i), stages - 2);
        const Block dk = memory_.k[stages - 1][i] - memory_.k[stages - 2][i];
        const Block dy = memory_.y_new[i] - before;
        rates += sum_of_lanes(Block(dk * dk));
        states += sum_of_lanes(Block(dy * dy));
      }
      return states > 0.0 ? std::abs(h) * std::sqrt(rates / states) : 0.0;
    }
  }

 private:
  /// Drops the low part of components that are set to another value.
  static void forget(const double* y, const Block* instead_of, Block* low) {
    for (int i = 0; i < blocks; ++i) {
      for (int j = 0; j < width; ++j) {
        if (y[i * width + j] != lane(instead_of[i], j)) set_lane(low[i], j, 0.0);
      }
    }
  }
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
  Attempt (*attempt_)(Memory*, double, double, double) =
      fastest<&attempt_step<method, System, compensated>, best_for(width)>();
  void (*dense_stages_)(Memory*, double, double) =
      fastest<&dense_stages_of_step<method, System, compensated>, best_for(width)>();
  void (*interpolant_)(const Block*, const Block (*)[blocks], double, double*) =
      fastest<&interpolant_of_step<method, Block, blocks>, best_for(width)>();
  void (*sample_)(const double*, TwoDouble, double, const double*, int, double*) =
      fastest<&sample_interpolant<Block, blocks, Memory::degree>, best_for(width)>();
  void (*evaluate_)(const System*, double, const double*,
                    double*) = fastest<&evaluate_system<System>, best_for(width)>();
};

}  // namespace pendcore
