#include "integrate/radau/implicit_runge_kutta.hpp"

#include <limits>
#include <stdexcept>
#include <vector>

#include "integrate/horner.hpp"
#include "integrate/radau/collocation_step.hpp"
#include "integrate/runge_kutta/compensation.hpp"

namespace pendcore {
namespace {

/// Tries a step, as Stepper::attempt says.
template <class Sizes>
PENDCORE_INLINE Attempt attempt_collocation(CollocationStep<Sizes>* step, double t, double h,
                                            const std::function<bool()>* keep_going) {
  CollocationStep<Sizes>& s = *step;
  if (!s.has_jacobian) {
    s.system.jacobian(t, s.y.data(), s.systems.by_q.data(), s.systems.by_qd.data());
    s.has_jacobian = true;
  }
  s.h_tried = h;
  constexpr double undefined = std::numeric_limits<double>::quiet_NaN();
  if (!s.systems.factor(s.sizes.n, s.method, h, *keep_going)) return {{undefined, 0.0}};
  s.predict(h);
  const bool converges = s.iterate(t, h);  // if a user's function throws here, nothing was tried
  const bool is_careful = s.is_retry || s.h_before == 0.0;
  if (!s.is_retry) ++s.counts.jacobians;
  s.counts.factorisations += 2;
  s.is_retry = true;
  if (!converges) return {{undefined, 0.0}, !std::isfinite(s.squared_norm(s.y_new.data()))};
  s.polish(h);
  if (s.sizes.size > s.sizes.state) s.integrate_quadratures(t, h);
  s.advance();
  s.set_scale();
  s.squared_error = s.filtered(s.dydt.data(), h);
  s.set_slope(h);
  if (is_careful && s.squared_error >= 1.0) {
    // The error is filtered once more: a fast transient that is damped away is not an error.
    for (int i = 0; i < s.sizes.state; ++i) s.trial[i] = s.y[i] + s.error[i];
    s.evaluate(t, s.trial.data(), s.rates.data());
    s.squared_error = s.filtered(s.rates.data(), h);
  }

  const double log2_error = 0.5 * approximate_log2(s.squared_error);
  constexpr int usual = CollocationStep<Sizes>::usual_iterations;
  const double safety = 0.9 * (1 + 2 * usual) / (s.iterations + 2 * usual);
  double factor = approximate_exp2(approximate_log2(safety) - 0.25 * log2_error);
  if (s.h_before != 0.0) {
    const double log2_ratio = 0.25 * (s.log2_error_before - 2.0 * log2_error);
    factor = std::min(factor, 0.9 * (h / s.h_before) * approximate_exp2(log2_ratio));
  }
  return {{s.squared_error, factor}};
}

/// Accepts the attempted step.
template <class Sizes>
PENDCORE_INLINE void accept_collocation(CollocationStep<Sizes>* step, double t_new) {
  constexpr double log2_smallest_error = -6.643856189774724;  // log2(1e-2)
  CollocationStep<Sizes>& s = *step;
  s.write_polynomial(s.polynomial.data());
  s.h_before = s.h_tried;
  s.log2_error_before = std::max(0.5 * approximate_log2(s.squared_error), log2_smallest_error);
  s.contraction = s.contraction_of_attempt;
  s.is_retry = false;
  s.has_jacobian = false;
  s.y = s.y_new;
  s.low = s.low_new;
  s.evaluate(t_new, s.y.data(), s.dydt.data());
}

/// The dense output of the attempted step, as Stepper::interpolant says.
template <class Sizes>
PENDCORE_INLINE void interpolant_of_collocation(const CollocationStep<Sizes>* step,
                                                double* coefficients) {
  using Block = typename Sizes::Block;
  const CollocationStep<Sizes>& s = *step;
  const int size = s.sizes.size;
  double* const rows = coefficients + size;
  for (int i = 0; i < size; i += CollocationStep<Sizes>::width) {
    store(coefficients + i, s.at(s.y.data(), i));
    const Block own = s.at(s.slope.data(), i);
    const Block change = own - s.template power_of_stages<Block>(0, i);
    store(rows + i, own);
    for (int p = 1; p < Collocation::degree; ++p) {
      const Block before = p < 3 ? s.template power_of_stages<Block>(p, i) : Block{};
      store(rows + p * size + i, before + s.method.correction[p] * change);
    }
  }
}

template <class Sizes>
class ImplicitRungeKutta final : public Stepper {
 public:
  ImplicitRungeKutta(const Collocation& method, std::unique_ptr<DifferentiableSystem> system,
                     const Sizes& sizes, bool compensated)
      : system_(std::move(system)), step_(method, *system_, sizes, compensated, *this) {}

  const MethodInfo& info() const override { return step_.method.info; }
  int dimension() const override { return step_.sizes.size; }
  int controlled() const override { return step_.sizes.state; }
  int interpolant_degree() const override { return Collocation::degree; }

  void set_tolerances(const double* rtol, const double* atol) override {
    double smallest = std::numeric_limits<double>::infinity();
    for (int i = 0; i < controlled(); ++i) {
      const double given = std::max(rtol[i], epsilon);
      step_.rtol[i] = 0.1 * small_power(given, 2.0 / 3.0);
      step_.atol[i] = step_.rtol[i] * (atol[i] / given);
      smallest = std::min(smallest, step_.rtol[i]);
    }
    step_.newton_tolerance =
        std::max(10.0 * epsilon / smallest, std::min(0.03, std::sqrt(smallest)));
  }

  void start(const double* y, const double* dydt) override {
    // The systems are allocated only here, because a pair of methods may never need them.
    step_.systems.allocate(step_.sizes.n);
    drop_changed(y, step_.y.data(), low_size(), step_.low.data());
    std::copy_n(y, dimension(), step_.y.begin());
    std::copy_n(dydt, dimension(), step_.dydt.begin());
    step_.has_jacobian = false;
    step_.h_before = 0.0;
    step_.contraction = 1.0;
    step_.is_retry = false;
  }
  void get_state(double* y) const override { std::ranges::copy(step_.y, y); }
  void get_derivative(double* dydt) const override { std::ranges::copy(step_.dydt, dydt); }
  void get_new_state(double* y) const override { std::ranges::copy(step_.y_new, y); }
  void set_new_state(const double* y) override {
    drop_changed(y, step_.y_new.data(), low_size(), step_.low_new.data());
    std::copy_n(y, dimension(), step_.y_new.begin());
  }
  void evaluate(double t, const double* y, double* dydt) override { step_.evaluate(t, y, dydt); }

  Attempt attempt(const TwoDouble& time, double h, double /*gain*/) override {
    return attempt_(&step_, time.high, h, &keep_going);
  }

  /// Nothing moves, so the length of the step does not matter. No system is solved: its matrix
  /// would be infinite for a step of some 1e-300 s.
  void stay() override {
    step_.y_new = step_.y;
    step_.low_new = step_.low;
    std::ranges::fill(step_.stages, 0.0);
    std::ranges::fill(step_.slope, 0.0);
    step_.squared_error = 0.0;
  }

  void accept(double t_new) override { accept_(&step_, t_new); }

  void interpolant(double /*h*/, double* coefficients) override {
    interpolant_(&step_, coefficients);
  }
  void sample(const double* coefficients, const TwoDouble& start, double h, const double* times,
              int count, double* states) const override {
    static const auto sample_on_this_processor = fastest<&sample_rows>();
    sample_on_this_processor(coefficients, start, h, times, count, states, dimension(),
                             Collocation::degree);
  }
  double stiffness(double /*h*/) override { return 0.0; }  // stability limits no step

  /// The low part of the state, if compensated. The polynomial, size and error of the accepted
  /// step, and the contraction of its iteration. Whether a step from here was tried already.
  StepperState saved_state() const override {
    const CollocationStep<Sizes>& s = step_;
    std::vector<double> memory(s.low.begin(), s.low.begin() + low_size());
    memory.insert(memory.end(), s.polynomial.begin(), s.polynomial.end());
    memory.insert(memory.end(),
                  {s.h_before, s.log2_error_before, s.contraction, s.is_retry ? 1.0 : 0.0});
    return {.memory = std::move(memory)};
  }
  void restore(const StepperState& saved) override {
    const std::vector<double>& memory = saved.memory;
    CollocationStep<Sizes>& s = step_;
    if (memory.size() != s.polynomial.size() + 4 + low_size()) {
      throw std::invalid_argument(
          "what the method kept of its last step does not belong to this scene");
    }
    std::copy_n(memory.begin(), low_size(), s.low.begin());
    const double* const past = memory.data() + low_size();
    std::copy_n(past, s.polynomial.size(), s.polynomial.begin());
    const double* const rest = past + s.polynomial.size();
    s.h_before = rest[0];
    s.log2_error_before = rest[1];
    s.contraction = rest[2];
    s.is_retry = rest[3] != 0.0;
  }

 private:
  int low_size() const { return step_.compensated ? dimension() : 0; }

  std::unique_ptr<DifferentiableSystem> system_;
  CollocationStep<Sizes> step_;

  static constexpr InstructionSet best = best_for(2);
  Attempt (*attempt_)(CollocationStep<Sizes>*, double, double,
                      const std::function<bool()>*) = fastest<&attempt_collocation<Sizes>, best>();
  void (*accept_)(CollocationStep<Sizes>*, double) = fastest<&accept_collocation<Sizes>, best>();
  void (*interpolant_)(const CollocationStep<Sizes>*,
                       double*) = fastest<&interpolant_of_collocation<Sizes>, best>();
};

template <class Sizes>
std::unique_ptr<Stepper> made(const Collocation& method,
                              std::unique_ptr<DifferentiableSystem> system, const Sizes& sizes,
                              bool compensated) {
  return std::make_unique<ImplicitRungeKutta<Sizes>>(method, std::move(system), sizes, compensated);
}

}  // namespace

std::unique_ptr<Stepper> implicit_runge_kutta(const Collocation& method,
                                              std::unique_ptr<DifferentiableSystem> system,
                                              bool compensated) {
  const int n = system->row;
  const int quadratures = system->quadratures;
  if constexpr (has_special_kernels_of_rare_runs) {
    if (n == 1 && quadratures == 0)
      return made(method, std::move(system), SizesOf<1>{}, compensated);
    if (n == 2 && quadratures == 0)
      return made(method, std::move(system), SizesOf<2>{}, compensated);
  }
  return made(method, std::move(system), SizesInMemory{n, 2 * n, 2 * n + quadratures}, compensated);
}

}  // namespace pendcore
