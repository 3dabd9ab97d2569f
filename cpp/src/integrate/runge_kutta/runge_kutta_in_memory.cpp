#include "integrate/runge_kutta/runge_kutta_in_memory.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

#include "integrate/method_list.hpp"
#include "integrate/runge_kutta/compensation.hpp"
#include "integrate/runge_kutta/step.hpp"

namespace pendcore {
namespace {

/// The data of one step: rows of blocks.
struct StepInMemory {
  const GeneralSystem* system;
  int stages;
  int size;        ///< of the state, filled up to whole blocks
  int error_size;  ///< of its part in the error norm
  double count;    ///< numbers in that part
  Matrix k = Matrix::Zero(stages, size);
  Vector y = Vector::Zero(size), y_new = y, rtol = y;
  Vector atol = Vector::Ones(size);  ///< also in places without a component
  Vector low = y, low_new = y;       ///< rounding errors of y and y_new, if compensated
};

/// One block of the stages k, rows of `size` numbers.
template <class Block>
struct StageInMemory {
  const double* k;
  int size;
  PENDCORE_INLINE Block operator()(int j) const { return load<Block>(k + j * size); }
};

/// Stages first .. end - 1, as in step.hpp.
template <const auto& method, class Block, int first, int end>
PENDCORE_INLINE void stages_in_memory(StepInMemory* memory, double t, double h, double* z) {
  constexpr int width = Lanes<Block>::width;
  const int size = memory->size;
  const double* const y = memory->y.data();
  double* const k = memory->k.data();
  const auto block = [=](int at) { return StageInMemory<Block>{k + at, size}; };
  if constexpr (method.written_out) {
#pragma GCC unroll 16
    for (int s = first; s < end; ++s) {
      for (int at = 0; at < size; at += width) {
        store(z + at, advance(load<Block>(y + at), h, method.a[s], block(at), s));
      }
      (*memory->system)(t + method.c[s].value * h, z, k + s * size);
    }
  } else {
    static constexpr auto rows = rows_of(method);
#pragma GCC unroll 1
    for (int s = first; s < end; ++s) {
      for (int at = 0; at < size; at += width) {
        store(z + at, advance(load<Block>(y + at), h, rows[s], block(at)));
      }
      (*memory->system)(t + rows[s].node * h, z, k + s * size);
    }
  }
}

template <const auto& method, class Block, bool compensated>
PENDCORE_INLINE Attempt attempt_in_memory(StepInMemory* memory, double t, double h, double gain) {
  constexpr int width = Lanes<Block>::width;
  constexpr int stages = std::remove_cvref_t<decltype(method)>::stages;
  const int size = memory->size;
  const double* const y = memory->y.data();
  double* const z = memory->y_new.data();
  double* const k = memory->k.data();
  constexpr int before_end = stages - (compensated && method.first_same_as_last ? 1 : 0);
  stages_in_memory<method, Block, 1, before_end>(memory, t, h, z);
  if constexpr (compensated) {
    for (int at = 0; at < size; at += width) {
      Block after;
      store(z + at,
            advance_compensated(load<Block>(y + at), load<Block>(&memory->low[at]), h, method.b,
                                StageInMemory<Block>{k + at, size}, before_end, after));
      store(&memory->low_new[at], after);
    }
    if constexpr (method.first_same_as_last) {
      (*memory->system)(t + h, z, k + static_cast<std::ptrdiff_t>(stages - 1) * size);
    }
  } else if constexpr (!method.first_same_as_last) {
    for (int at = 0; at < size; at += width) {
      store(z + at,
            advance(load<Block>(y + at), h, method.b, StageInMemory<Block>{k + at, size}, stages));
    }
  }
  SquaredErrors<method, double, Block> squares;
  const double* const rtol = memory->rtol.data();
  const double* const atol = memory->atol.data();
  for (int at = 0; at < memory->error_size; at += width) {
    const Block before = load<Block>(y + at);
    const Block after = load<Block>(z + at);
    const Block larger_one = larger(absolute(before), absolute(after));
    const Block scale = h / fma(load<Block>(rtol + at), larger_one, load<Block>(atol + at));
    squares.add(after, scale, StageInMemory<Block>{k + at, size}, at == 0);
  }
  const double squared_error = squares.mean(1.0 / memory->count);
  return {{squared_error, scaled_power(squared_error, -0.5 * exponent(method.info), gain)}};
}

/// Computes the stages of the attempted step, from time t, that only the dense output needs; `z` is
/// memory for a state.
template <const auto& method, class Block>
PENDCORE_INLINE void dense_stages_in_memory(StepInMemory* memory, double t, double h, double* z) {
  using Method = std::remove_cvref_t<decltype(method)>;
  if constexpr (Method::all_stages > Method::stages) {
    stages_in_memory<method, Block, Method::stages, Method::all_stages>(memory, t, h, z);
  }
}

template <const auto& method, class Block>
PENDCORE_INLINE void interpolant_in_memory(const StepInMemory* memory, double h,
                                           double* coefficients) {
  using Method = std::remove_cvref_t<decltype(method)>;
  constexpr int width = Lanes<Block>::width;
  const int size = memory->size;
  const double* const y = memory->y.data();
  const double* const k = memory->k.data();
  for (int at = 0; at < size; at += width) {
    store(coefficients + at, load<Block>(y + at));
    Block powers[Method::degree];
    interpolant_of_block<method>(h, StageInMemory<Block>{k + at, size}, powers);
#pragma GCC unroll 16
    for (int p = 0; p < Method::degree; ++p) {
      store(coefficients + (p + 1) * size + at, powers[p]);
    }
  }
}

/// The numbers of a state stand close together for the loop: (n, n, quadratures). In memory each
/// row is filled up to whole blocks.
template <const auto& method, class Block>
class RungeKuttaInMemory final : public Stepper {
  using Method = std::remove_cvref_t<decltype(method)>;
  static constexpr int width = Lanes<Block>::width;
  static constexpr InstructionSet best = best_for(width);
  static constexpr int stages = Method::stages;
  static constexpr int all_stages = Method::all_stages;
  static constexpr int degree = Method::degree;
  static_assert(degree <= 15, "as root.hpp has it");

 public:
  RungeKuttaInMemory(std::unique_ptr<GeneralSystem> system, int n, bool compensated = false)
      : system_(std::move(system)),
        compensated_(compensated),
        n_(n),
        row_(system_->row),
        memory_{.system = system_.get(),
                .stages = all_stages,
                .size = 2 * row_ + (system_->quadratures + width - 1) / width * width,
                .error_size = 2 * row_,
                .count = 2.0 * n},
        rows_(degree + 1, memory_.size) {}

  const MethodInfo& info() const override { return method.info; }
  int dimension() const override { return 2 * n_ + system_->quadratures; }
  int controlled() const override { return 2 * n_; }
  int interpolant_degree() const override { return degree; }

  void set_tolerances(const double* rtol, const double* atol) override {
    read_rows(rtol, memory_.rtol.data());
    read_rows(atol, memory_.atol.data());
  }
  void start(const double* y, const double* dydt) override {
    set_state(y, memory_.y, memory_.low);
    read(dydt, memory_.k.data());
  }
  void get_state(double* y) const override { write(memory_.y.data(), y); }
  void get_derivative(double* dydt) const override { write(memory_.k.data(), dydt); }
  void get_new_state(double* y) const override { write(memory_.y_new.data(), y); }
  void set_new_state(const double* y) override { set_state(y, memory_.y_new, memory_.low_new); }

  void evaluate(double t, const double* y, double* dydt) override {
    Vector state = Vector::Zero(memory_.size);
    Vector rate = state;
    read(y, state.data());
    (*system_)(t, state.data(), rate.data());
    write(rate.data(), dydt);
    ++evaluations;
  }
  Attempt attempt(const TwoDouble& t, double h, double gain) override {
    evaluations += stages - 1;
    t_ = t.high;
    has_dense_stages_ = all_stages == stages;
    return attempt_(&memory_, t.high, h, gain);
  }
  void stay() override {
    memory_.y_new = memory_.y;
    memory_.low_new = memory_.low;
    memory_.k.setZero();
    has_dense_stages_ = true;
  }
  void accept(double t_new) override {
    memory_.y = memory_.y_new;
    if (compensated_) memory_.low = memory_.low_new;
    if constexpr (method.first_same_as_last) {
      memory_.k.row(0) = memory_.k.row(stages - 1);
    } else {
      (*system_)(t_new, memory_.y.data(), memory_.k.data());
      ++evaluations;
    }
  }
  void interpolant(double h, double* coefficients) override {
    if (!has_dense_stages_) {
      evaluations += all_stages - stages;
      dense_stages_(&memory_, t_, h, rows_.data());
      has_dense_stages_ = true;
    }
    interpolant_(&memory_, h, rows_.data());
    for (int p = 0; p <= degree; ++p) write(&rows_(p, 0), coefficients + p * dimension());
  }
  StepperState saved_state() const override {
    std::vector<double> low;
    if (compensated_) {
      low.resize(dimension());
      write(memory_.low.data(), low.data());
    }
    return {.memory = std::move(low)};
  }
  void restore(const StepperState& saved) override {
    if (compensated_) {
      if (has_low_part(saved.memory, dimension())) read(saved.memory.data(), memory_.low.data());
    }
  }
  double stiffness(double h) override {
    if constexpr (method.info.stability == 0.0) {
      return 0.0;
    } else {
      return stiffness_of_step<method>(h, memory_.error_size / width, [this](int i) {
        const int at = i * width;
        return std::tuple(load<Block>(&memory_.y[at]), load<Block>(&memory_.y_new[at]),
                          StageInMemory<Block>{memory_.k.data() + at, memory_.size});
      });
    }
  }

 private:
  void set_state(const double* y, Vector& state, Vector& low) const {
    const Vector before = state;
    read(y, state.data());
    if (compensated_) drop_changed(state.data(), before.data(), memory_.size, low.data());
  }
  // Rows are short: a call of memmove for each costs a twentieth of a step with dense output.
  void read_rows(const double* from, double* to) const {
    for (int i = 0; i < n_; ++i) {
      to[i] = from[i];
      to[row_ + i] = from[n_ + i];
    }
  }
  void read(const double* from, double* to) const {
    read_rows(from, to);
    for (int i = 0; i < system_->quadratures; ++i) to[2 * row_ + i] = from[2 * n_ + i];
  }
  void write(const double* from, double* to) const {
    for (int i = 0; i < n_; ++i) {
      to[i] = from[i];
      to[n_ + i] = from[row_ + i];
    }
    for (int i = 0; i < system_->quadratures; ++i) to[2 * n_ + i] = from[2 * row_ + i];
  }

  std::unique_ptr<GeneralSystem> system_;
  bool compensated_;
  int n_;
  int row_;
  StepInMemory memory_;
  Matrix rows_;     ///< of an interpolant
  double t_ = 0.0;  ///< the time of the attempt
  bool has_dense_stages_ = false;
  Attempt (*attempt_)(StepInMemory*, double, double,
                      double) = compensated_
                                    ? fastest<&attempt_in_memory<method, Block, true>, best>()
                                    : fastest<&attempt_in_memory<method, Block, false>, best>();
  void (*dense_stages_)(StepInMemory*, double, double,
                        double*) = fastest<&dense_stages_in_memory<method, Block>, best>();
  void (*interpolant_)(const StepInMemory*, double,
                       double*) = fastest<&interpolant_in_memory<method, Block>, best>();
};

template <const auto& method>
std::unique_ptr<Stepper> stepper_of(std::unique_ptr<GeneralSystem> system, int n,
                                    bool compensated) {
  switch (system->row) {
    case 1:
      return std::make_unique<RungeKuttaInMemory<method, double>>(std::move(system), n,
                                                                  compensated);
    case 2:
      return std::make_unique<RungeKuttaInMemory<method, Pack<2>>>(std::move(system), n,
                                                                   compensated);
    default:
      return std::make_unique<RungeKuttaInMemory<method, Pack<4>>>(std::move(system), n,
                                                                   compensated);
  }
}

using Maker = std::unique_ptr<Stepper> (*)(std::unique_ptr<GeneralSystem>, int, bool);

template <const auto& method>
constexpr Maker maker_of() {
  if constexpr (method.info.kind == MethodKind::explicit_one) return &stepper_of<method>;
  return nullptr;
}

template <const auto&... methods>
Maker maker_of(MethodList<methods...>, std::string_view name) {
  Maker maker = nullptr;
  ((methods.info.name == name ? void(maker = maker_of<methods>()) : void()), ...);
  return maker;
}

}  // namespace

std::unique_ptr<Stepper> runge_kutta_in_memory(std::string_view method,
                                               std::unique_ptr<GeneralSystem> system, int n,
                                               bool compensated) {
  return maker_of(Methods{}, method)(std::move(system), n, compensated);
}

}  // namespace pendcore
