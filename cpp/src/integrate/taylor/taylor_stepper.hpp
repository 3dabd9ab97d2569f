/// \file
/// The method of Taylor series (taylor.hpp) applied to a system, as the loop sees it.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include "integrate/runge_kutta/compensation.hpp"
#include "integrate/stepper.hpp"
#include "integrate/taylor/dominant_eigenvalue.hpp"
#include "integrate/taylor/gauss_quadrature.hpp"
#include "integrate/taylor/taylor_step.hpp"
#include "text/message.hpp"

namespace pendcore {

template <class Series>
class Taylor final : public Stepper {
  using Memory = TaylorMemory<Series>;
  using Block = typename Series::Block;
  static constexpr int width = Lanes<Block>::width;
  static constexpr Sets sets = Series::sets;

 public:
  Taylor(Series series, Rates rates, int quadratures, bool compensated = false)
      : memory_{.series = std::move(series)},
        compensated_(compensated),
        rates_(std::move(rates)),
        n_(memory_.series.links()),
        row_(memory_.series.row()),
        size_(2 * row_),
        dydt_(static_cast<std::size_t>(2 * n_ + quadratures)),
        quadratures_(quadratures),
        quadratures_new_(quadratures),
        quadrature_rates_(static_cast<std::size_t>(GaussQuadrature::points) * quadratures) {
    memory_.blocks = size_ / width;
    memory_.log2_count = approximate_log2(static_cast<double>(controlled()));
  }
  Taylor(const Taylor&) = delete;  // the memory points to its own numbers
  Taylor& operator=(const Taylor&) = delete;

  const MethodInfo& info() const override { return taylor.info; }
  int dimension() const override { return controlled() + static_cast<int>(quadratures_.size()); }
  int controlled() const override { return 2 * n_; }
  int interpolant_degree() const override { return memory_.order; }

  void set_tolerances(const double* rtol, const double* atol) override {
    double tightest = 1.0;
    for (int i = 0; i < controlled(); ++i)
      tightest = std::min(tightest, std::max(rtol[i], atol[i]));
    make_room(taylor_order(tightest));
    read_rows(rtol, memory_.rtol);
    read_rows(atol, memory_.atol);
  }

  void start(const double* y, const double* dydt) override {
    if (compensated_) drop_low_parts(y, memory_.y, memory_.low);
    read(y, memory_.y, quadratures_);
    std::copy_n(dydt, dimension(), dydt_.begin());
    const double rate = taylor_detail::squared_rate(dydt, n_);
    starts_at_rest_ = rate == 0.0;
    memory_.sigma = taylor_detail::first_sigma(rate);
    has_series_ = false;
  }
  void get_state(double* y) const override { write(memory_.y, quadratures_, y); }
  void get_derivative(double* dydt) const override {
    if (!has_series_) {
      std::copy_n(dydt_.begin(), dimension(), dydt);
      return;
    }
    write_rows(memory_.rows + size_, dydt);
    for (int i = 0; i < controlled(); ++i) dydt[i] /= memory_.sigma;
    std::copy(dydt_.begin() + controlled(), dydt_.end(), dydt + controlled());
  }
  void get_new_state(double* y) const override { write(memory_.y_new, quadratures_new_, y); }
  void set_new_state(const double* y) override {
    if (compensated_) drop_low_parts(y, memory_.y_new, memory_.low_new);
    read(y, memory_.y_new, quadratures_new_);
    has_new_series_ = false;
  }
  void evaluate(double t, const double* y, double* dydt) override {
    rates_(t, y, dydt);
    ++evaluations;
  }

  double own_first_step(double t) override { return begin(t) ? memory_.largest : 0.0; }

  Attempt attempt(const TwoDouble& t, double h, double /*gain*/) override {
    stays_ = false;
    // Where nothing moves yet, the given step is the only time scale.
    if (std::exchange(starts_at_rest_, false) && !has_series_) {
      memory_.sigma = taylor_detail::power_of_two_below(std::abs(h));
    }
    if (!begin(t.high)) return {{std::numeric_limits<double>::quiet_NaN(), 0.0}};
    ++evaluations;
    t_ = t.high;
    t_new_ = (t + h).high;
    has_new_series_ = true;
    const Attempt attempt = attempt_(&memory_, t_new_, h);
    if (!quadratures_.empty()) integrate_quadratures(t.high, h);
    return attempt;
  }
  void stay() override {
    const std::size_t bytes = size_ * sizeof(double);
    __builtin_memcpy(memory_.y_new, memory_.y, bytes);
    if (compensated_) __builtin_memcpy(memory_.low_new, memory_.low, bytes);
    quadratures_new_ = quadratures_;
    std::ranges::fill(quadrature_rates_, 0.0);
    has_new_series_ = false;
    stays_ = true;
  }
  void accept(double t_new) override {
    const bool is_of_that_time = !memory_.series.depends_on_time() || t_new == t_new_;
    const bool is_whole = has_new_series_ && is_of_that_time;
    if (!is_whole) memory_.sigma_new = memory_.sigma;
    std::swap(memory_.y, memory_.y_new);
    std::swap(memory_.low, memory_.low_new);
    std::swap(memory_.rows, memory_.rows_new);
    std::swap(memory_.sigma, memory_.sigma_new);
    std::swap(memory_.largest, memory_.largest_new);
    std::swap(quadratures_, quadratures_new_);
    has_series_ = is_whole;
    if (!has_series_) begin(t_new);
    if (quadratures_.empty()) return;
    std::vector<double> y(dimension());
    get_state(y.data());
    evaluate(t_new, y.data(), dydt_.data());
  }

  void interpolant(double h, double* coefficients) override {
    write(memory_.y, quadratures_, coefficients);
    write_powers(h, dimension(), coefficients);
    const int first = controlled();
    for (std::size_t i = 0; i < quadratures_.size(); ++i) {
      const auto powers = GaussQuadrature::powers(&quadrature_rates_[i * GaussQuadrature::points]);
      for (int k = 1; k <= memory_.order; ++k) {
        coefficients[static_cast<std::size_t>(k) * dimension() + first + i] =
            k <= GaussQuadrature::points ? h * powers[k - 1] : 0.0;
      }
    }
  }
  void sample(const double* coefficients, const TwoDouble& start, double h, const double* times,
              int count, double* states) const override {
    sample_(coefficients, start, h, times, count, states, dimension(), memory_.order);
  }
  /// The stiffness of the part that dominates the last coefficient of the series at the start of
  /// the attempt.
  double stiffness(double h) override {
    std::vector<double> last(controlled());
    write_rows(memory_.rows + static_cast<std::ptrdiff_t>(memory_.order) * size_, last.data());
    std::vector<double> state(dimension());
    get_state(state.data());
    evaluations += evaluations_of_stiffness;
    return stiffness_of_series(rates_, t_, state, std::move(last), h, memory_.order);
  }

  /// The low part of the state, if compensated, and sigma: with another sigma, the size of a step
  /// would have other last bits.
  StepperState saved_state() const override {
    std::vector<double> memory;
    if (compensated_) {
      memory.resize(dimension());
      write_rows(memory_.low, memory.data());
    }
    memory.push_back(memory_.sigma);
    return {.memory = std::move(memory)};
  }
  void restore(const StepperState& saved) override {
    const std::vector<double>& memory = saved.memory;
    if (memory.empty()) return;
    std::vector<double> low(memory.begin(), memory.end() - 1);
    if (compensated_) {
      if (has_low_part(low, dimension())) read_rows(low.data(), memory_.low);
    }
    const double sigma = memory.back();
    if (!(sigma > 0.0) || taylor_detail::power_of_two_below(sigma) != sigma) {
      throw std::invalid_argument("unit of time of the Taylor series = " + text(sigma) +
                                  " s: must be a power of two, as in every run: this solution was "
                                  "changed or damaged: run its scene again");
    }
    memory_.sigma = sigma;
    starts_at_rest_ = false;
  }

 private:
  /// Without the kernel for short series, where that is not compiled.
  template <bool compensated>
  static Attempt attempt_in_parts(Memory* memory, double t_new, double h) {
    static const auto advance = fastest<&advance_series<Series, compensated>, sets>();
    static const auto expand = fastest<&taylor_detail::expand<Series>, sets>();
    return attempt_series(memory, t_new, h, advance, expand);
  }
  template <bool compensated>
  static auto attempt_kernel() {
    if constexpr (Series::is_short && (!compensated || has_special_kernels_of_rare_runs)) {
      if (instruction_set() < least_of_special_kernels) {
        return &Taylor::attempt_in_parts<compensated>;
      }
      return fastest<&attempt_short_series<Series, compensated>, wide_special_sets>();
    } else {
      return &Taylor::attempt_in_parts<compensated>;
    }
  }

  /// Computes the series from y at time t, if there is none yet.
  bool begin(double t) {
    if (has_series_) return true;
    has_series_ = expand_(&memory_, t, memory_.y, memory_.rows, memory_.sigma, memory_.largest);
    return has_series_;
  }

  void make_room(int order) {
    memory_.order = order;
    memory_.series.set_order(order);
    const std::size_t rows = 6 + 2 * (static_cast<std::size_t>(order) + 1);
    // Rows of four that begin at a cache line do not cross into the next line.
    constexpr std::size_t line = 64;
    numbers_.assign(rows * size_ + line / sizeof(double), 0.0);
    void* start = numbers_.data();
    std::size_t space = numbers_.size() * sizeof(double);
    auto* at = static_cast<double*>(std::align(line, rows * size_ * sizeof(double), start, space));
    for (double** one : {&memory_.y, &memory_.y_new, &memory_.rtol, &memory_.atol, &memory_.low,
                         &memory_.low_new}) {
      *one = at;
      at += size_;
    }
    for (int i = 0; i < size_; ++i) memory_.atol[i] = 1.0;  // places without a component
    memory_.rows = at;
    memory_.rows_new = at + (static_cast<std::size_t>(order) + 1) * size_;
    has_series_ = has_new_series_ = false;
  }

  void drop_low_parts(const double* y, const double* before, double* low) const {
    drop_changed(y, before, n_, low);
    drop_changed(y + n_, before + row_, n_, low + row_);
  }
  void read_rows(const double* from, double* to) const {
    std::copy_n(from, n_, to);
    std::copy_n(from + n_, n_, to + row_);
  }
  void write_rows(const double* from, double* to) const {
    std::copy_n(from, n_, to);
    std::copy_n(from + row_, n_, to + n_);
  }
  void read(const double* from, double* to, std::vector<double>& sums) const {
    read_rows(from, to);
    std::copy_n(from + controlled(), sums.size(), sums.begin());
  }
  void write(const double* from, const std::vector<double>& sums, double* to) const {
    write_rows(from, to);
    std::ranges::copy(sums, to + controlled());
  }

  /// Writes the series of a step of size h in powers of theta, from the first on, in rows of
  /// `dimension` numbers.
  void write_powers(double h, int dimension, double* coefficients) const {
    const double x = stays_ ? 0.0 : h / memory_.sigma;
    powers_of_step_(&memory_, x, n_, row_, dimension, coefficients);
    if (!(std::abs(x) <= taylor_detail::no_large_powers) &&
        !std::isfinite(power_of(x, memory_.order))) {
      write_large_powers(x, dimension, coefficients);
    }
  }
  static double power_of(double x, int order) {
    double power = 1.0;
    for (int k = 1; k <= order; ++k) power *= x;
    return power;
  }
  /// Does what write_powers() does, where x^k overflows: the coefficient, perhaps zero, is
  /// multiplied by x k times.
  void write_large_powers(double x, int dimension, double* coefficients) const {
    for (int k = 1; k <= memory_.order; ++k) {
      const double* const from = memory_.rows + static_cast<std::ptrdiff_t>(k) * size_;
      double* const to = coefficients + static_cast<std::ptrdiff_t>(k) * dimension;
      for (int i = 0; i < 2 * n_; ++i) {
        double term = from[i < n_ ? i : row_ + i - n_];
        for (int factor = 0; factor < k; ++factor) term *= x;
        to[i] = term;
      }
    }
  }

  void integrate_quadratures(double t, double h) {
    using Gauss = GaussQuadrature;
    const int rows = memory_.order + 1;
    std::vector<double> room(static_cast<std::size_t>(rows + Gauss::points) * controlled() +
                             2 * static_cast<std::size_t>(dimension()));
    double* const states = room.data() + static_cast<std::ptrdiff_t>(rows) * controlled();
    double* const state = states + static_cast<std::ptrdiff_t>(Gauss::points) * controlled();
    double* const rate = state + dimension();
    write_rows(memory_.y, room.data());
    write_powers(h, controlled(), room.data());
    sample_(room.data(), {}, 1.0, Gauss::theta.data(), Gauss::points, states, controlled(),
            memory_.order);
    for (int j = 0; j < Gauss::points; ++j) {
      std::copy_n(states + static_cast<std::ptrdiff_t>(j) * controlled(), controlled(), state);
      evaluate(t + Gauss::theta[j] * h, state, rate);
      for (std::size_t i = 0; i < quadratures_.size(); ++i) {
        quadrature_rates_[i * Gauss::points + j] = rate[controlled() + i];
      }
    }
    for (std::size_t i = 0; i < quadratures_.size(); ++i) {
      quadratures_new_[i] =
          quadratures_[i] + h * Gauss::whole(&quadrature_rates_[i * Gauss::points]);
    }
  }

  Memory memory_;
  bool compensated_;
  Rates rates_;
  int n_;
  int row_;
  int size_;
  /// The right-hand side at y. Where there is a series, only the rates of quadratures are kept.
  std::vector<double> dydt_;
  std::vector<double> quadratures_, quadratures_new_;
  std::vector<double> quadrature_rates_;  ///< along the attempt, (quadrature, point)
  std::vector<double> numbers_;           ///< all that memory_ points to
  bool starts_at_rest_ = false;           ///< nothing has a rate yet
  bool has_series_ = false;
  bool has_new_series_ = false;
  bool stays_ = false;
  double t_ = 0.0, t_new_ = 0.0;  ///< the start and the end of the attempt
  Attempt (*attempt_)(Memory*, double, double) = compensated_ ? attempt_kernel<true>()
                                                              : attempt_kernel<false>();
  bool (*expand_)(Memory*, double, const double*, double*, double&,
                  double&) = fastest<&taylor_detail::expand<Series>, sets>();
  void (*powers_of_step_)(const Memory*, double, int, int, int,
                          double*) = fastest<&powers_of_step<Series>, sets>();
  void (*sample_)(const double*, TwoDouble, double, const double*, int, double*, int,
                  int) = fastest<&sample_series>();
};

}  // namespace pendcore
