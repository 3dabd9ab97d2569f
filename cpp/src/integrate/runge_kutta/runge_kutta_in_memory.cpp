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

/// The data of one step: rows of blocks, `stages` of them for k.
struct StepInMemory {
  const GeneralSystem* system;
  int blocks;        ///< blocks of the state
  int error_blocks;  ///< blocks of its part in the error norm
  double count;      ///< numbers in that part
  double *y, *y_new, *k, *rtol, *atol;
  double *low, *low_new;  ///< rounding errors of y and y_new, if compensated
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
PENDCORE_INLINE void stages_in_memory(const StepInMemory* memory, double t, double h, double* z) {
  constexpr int width = Lanes<Block>::width;
  const int size = memory->blocks * width;
  const auto block = [=](int at) { return StageInMemory<Block>{memory->k + at, size}; };
  if constexpr (method.written_out) {
#pragma GCC unroll 16
    for (int s = first; s < end; ++s) {
      for (int at = 0; at < size; at += width) {
        store(z + at, advance(load<Block>(memory->y + at), h, method.a[s], block(at), s));
      }
      (*memory->system)(t + method.c[s].value * h, z, memory->k + s * size);
    }
  } else {
    static constexpr auto rows = rows_of(method);
#pragma GCC unroll 1
    for (int s = first; s < end; ++s) {
      for (int at = 0; at < size; at += width) {
        store(z + at, advance(load<Block>(memory->y + at), h, rows[s], block(at)));
      }
      (*memory->system)(t + rows[s].node * h, z, memory->k + s * size);
    }
  }
}

template <const auto& method, class Block, bool compensated>
PENDCORE_INLINE Attempt attempt_in_memory(const StepInMemory* memory, double t, double h,
                                          double gain) {
  constexpr int width = Lanes<Block>::width;
  constexpr int stages = std::remove_cvref_t<decltype(method)>::stages;
  const int blocks = memory->blocks;
  const int size = blocks * width;
  double* const z = memory->y_new;
  double* const k = memory->k;
  constexpr int before_end = stages - (compensated && method.first_same_as_last ? 1 : 0);
  stages_in_memory<method, Block, 1, before_end>(memory, t, h, z);
  if constexpr (compensated) {
    for (int at = 0; at < size; at += width) {
      Block after;
      store(z + at,
            advance_compensated(load<Block>(memory->y + at), load<Block>(memory->low + at), h,
                                method.b, StageInMemory<Block>{k + at, size}, before_end, after));
      store(memory->low_new + at, after);
    }
    if constexpr (method.first_same_as_last) {
      (*memory->system)(t + h, z, k + static_cast<std::ptrdiff_t>(stages - 1) * size);
    }
  } else if constexpr (!method.first_same_as_last) {
    for (int at = 0; at < size; at += width) {
      store(z + at, advance(load<Block>(memory->y + at), h, method.b,
                            StageInMemory<Block>{k + at, size}, stages));
    }
  }
  SquaredErrors<method, double, Block> squares;
  for (int i = 0; i < memory->error_blocks; ++i) {
    const int at = i * width;
    const Block before = load<Block>(memory->y + at);
    const Block after = load<Block>(z + at);
    const Block larger_one = larger(absolute(before), absolute(after));
    const Block scale =
        h / fma(load<Block>(memory->rtol + at), larger_one, load<Block>(memory->atol + at));
    squares.add(after, scale, StageInMemory<Block>{k + at, size}, i == 0);
  }
  const double squared_error = squares.mean(1.0 / memory->count);
  return {{squared_error, scaled_power(squared_error, -0.5 * exponent(method.info), gain)}};
}

/// Computes the stages of the attempted step, from time t, that only the dense output needs; `z` is
/// memory for a state.
template <const auto& method, class Block>
PENDCORE_INLINE void dense_stages_in_memory(const StepInMemory* memory, double t, double h,
                                            double* z) {
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
  const int size = memory->blocks * width;
  for (int at = 0; at < size; at += width) {
    store(coefficients + at, load<Block>(memory->y + at));
    Block powers[Method::degree];
    interpolant_of_block<method>(h, StageInMemory<Block>{memory->k + at, size}, powers);
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
  static constexpr Sets sets = width >= 4 ? wide_sets : usual_sets;
  static constexpr int stages = Method::stages;
  static constexpr int all_stages = Method::all_stages;
  static constexpr int degree = Method::degree;
  static constexpr int rows = 4 + all_stages + 2;
  static_assert(degree <= 15, "as root.hpp has it");

 public:
  RungeKuttaInMemory(std::unique_ptr<GeneralSystem> system, int n, bool compensated = false)
      : system_(std::move(system)),
        compensated_(compensated),
        n_(n),
        row_(system_->row),
        size_(2 * row_ + (system_->quadratures + width - 1) / width * width),
        numbers_(static_cast<std::size_t>(size_) * (rows + degree + 1)) {
    memory_.system = system_.get();
    memory_.blocks = size_ / width;
    memory_.error_blocks = 2 * row_ / width;
    memory_.count = 2.0 * n;
    double* at = numbers_.data();
    for (double** one : {&memory_.y, &memory_.y_new, &memory_.rtol, &memory_.atol, &memory_.low,
                         &memory_.low_new, &memory_.k}) {
      *one = at;
      at += size_;
    }
    rows_ = memory_.k + static_cast<std::ptrdiff_t>(all_stages) * size_;
    for (int i = 0; i < size_; ++i) memory_.atol[i] = 1.0;  // places without a component
  }

  const MethodInfo& info() const override { return method.info; }
  int dimension() const override { return 2 * n_ + system_->quadratures; }
  int controlled() const override { return 2 * n_; }
  int interpolant_degree() const override { return degree; }

  void set_tolerances(const double* rtol, const double* atol) override {
    read_rows(rtol, memory_.rtol);
    read_rows(atol, memory_.atol);
  }
  void start(const double* y, const double* dydt) override {
    if (compensated_) drop_low_parts(y, memory_.y, memory_.low);
    read(y, memory_.y);
    read(dydt, memory_.k);
  }
  void get_state(double* y) const override { write(memory_.y, y); }
  void get_derivative(double* dydt) const override { write(memory_.k, dydt); }
  void get_new_state(double* y) const override { write(memory_.y_new, y); }
  void get_new_derivative(double* dydt) const override {
    if constexpr (!method.first_same_as_last) return Stepper::get_new_derivative(dydt);
    write(memory_.k + static_cast<std::ptrdiff_t>(stages - 1) * size_, dydt);
  }
  void set_new_state(const double* y) override {
    if (compensated_) drop_low_parts(y, memory_.y_new, memory_.low_new);
    read(y, memory_.y_new);
  }

  void evaluate(double t, const double* y, double* dydt) override {
    std::vector<double> state(size_);
    std::vector<double> rate(size_);
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
    const std::size_t bytes = size_ * sizeof(double);
    __builtin_memcpy(memory_.y_new, memory_.y, bytes);
    if (compensated_) __builtin_memcpy(memory_.low_new, memory_.low, bytes);
    std::fill_n(memory_.k, static_cast<std::ptrdiff_t>(all_stages) * size_, 0.0);
    has_dense_stages_ = true;
  }
  void accept(double t_new) override {
    const std::size_t bytes = size_ * sizeof(double);
    __builtin_memcpy(memory_.y, memory_.y_new, bytes);
    if (compensated_) __builtin_memcpy(memory_.low, memory_.low_new, bytes);
    if constexpr (method.first_same_as_last) {
      __builtin_memcpy(memory_.k, memory_.k + static_cast<std::ptrdiff_t>(stages - 1) * size_,
                       bytes);
    } else {
      (*system_)(t_new, memory_.y, memory_.k);
      ++evaluations;
    }
  }
  void interpolant(double h, double* coefficients) override {
    if (!has_dense_stages_) {
      evaluations += all_stages - stages;
      dense_stages_(&memory_, t_, h, rows_);
      has_dense_stages_ = true;
    }
    interpolant_(&memory_, h, rows_);
    for (int p = 0; p <= degree; ++p) write(rows_ + p * size_, coefficients + p * dimension());
  }
  StepperState saved_state() const override {
    std::vector<double> low;
    if (compensated_) {
      low.resize(dimension());
      write(memory_.low, low.data());
    }
    return {.memory = std::move(low)};
  }
  void restore(const StepperState& saved) override {
    if (compensated_) {
      if (has_low_part(saved.memory, dimension())) read(saved.memory.data(), memory_.low);
    }
  }
  double stiffness(double h) override {
    if constexpr (method.info.stability == 0.0) {
      return 0.0;
    } else {
      return stiffness_of_step<method>(h, memory_.error_blocks, [this](int i) {
        const int at = i * width;
        return std::tuple(load<Block>(memory_.y + at), load<Block>(memory_.y_new + at),
                          StageInMemory<Block>{memory_.k + at, size_});
      });
    }
  }

 private:
  void drop_low_parts(const double* y, const double* before, double* low) const {
    drop_changed(y, before, n_, low);
    drop_changed(y + n_, before + row_, n_, low + row_);
    drop_changed(y + 2 * n_, before + 2 * row_, system_->quadratures, low + 2 * row_);
  }
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
  int size_;
  std::vector<double> numbers_;
  double* rows_;  ///< the rows of an interpolant
  StepInMemory memory_;
  double t_ = 0.0;  ///< the time of the attempt
  bool has_dense_stages_ = false;
  Attempt (*attempt_)(const StepInMemory*, double, double,
                      double) = compensated_
                                    ? fastest<&attempt_in_memory<method, Block, true>, sets>()
                                    : fastest<&attempt_in_memory<method, Block, false>, sets>();
  void (*dense_stages_)(const StepInMemory*, double, double,
                        double*) = fastest<&dense_stages_in_memory<method, Block>, sets>();
  void (*interpolant_)(const StepInMemory*, double,
                       double*) = fastest<&interpolant_in_memory<method, Block>, sets>();
};

}  // namespace

std::unique_ptr<Stepper> runge_kutta_in_memory(std::string_view method,
                                               std::unique_ptr<GeneralSystem> system, int n,
                                               bool compensated) {
  std::unique_ptr<Stepper> made;
  Methods::with(method, [&]<const auto & table>() {
    if constexpr (table.info.kind == MethodKind::explicit_one) {
      with_row_for(system->row, [&]<class Block>() {
        made =
            std::make_unique<RungeKuttaInMemory<table, Block>>(std::move(system), n, compensated);
      });
    }
  });
  return made;
}

}  // namespace pendcore
