#include "integrate/radau/implicit_runge_kutta.hpp"

#include <limits>
#include <stdexcept>
#include <vector>

#include "integrate/radau/collocation_step.hpp"
#include "integrate/runge_kutta/compensation.hpp"

namespace pendcore {
namespace {

/// Tries a step, as Stepper::attempt says.
template <int links>
PENDCORE_INLINE Attempt attempt_collocation(CollocationStep<links>* step, double t, double h,
                                            const std::function<bool()>* keep_going) {
  CollocationStep<links>& s = *step;
  if (!s.has_jacobian) {
    s.system.jacobian(t, s.y.data(), s.systems.by_q, s.systems.by_qd);
    s.has_jacobian = true;
  }
  s.h_tried = h;
  constexpr double undefined = std::numeric_limits<double>::quiet_NaN();
  if (!s.systems.factor(s.method, h, *keep_going)) return {{undefined, 0.0}};
  s.predict(h);
  const bool converges = s.iterate(t, h);  // if a user's function throws here, nothing was tried
  const bool is_careful = s.is_retry || s.h_before == 0.0;
  if (!s.is_retry) ++s.counts.jacobians;
  s.counts.factorisations += 2;
  s.is_retry = true;
  if (!converges) return {{undefined, 0.0}, !std::isfinite(s.squared_norm(s.y_new.data()))};
  s.polish(h);
  if (s.size() > s.state()) s.integrate_quadratures(t, h);
  s.advance();
  s.set_scale();
  s.squared_error = s.filtered(s.dydt.data(), h);
  s.set_slope(h);
  if (is_careful && s.squared_error >= 1.0) {
    // The error is filtered once more: a fast transient that is damped away is not an error.
    for (int i = 0; i < s.state(); ++i) s.trial(0, i) = s.y[i] + s.error[i];
    s.evaluate(t, s.trial.data(), s.rates.data());
    s.squared_error = s.filtered(s.rates.data(), h);
  }

  const double log2_error = 0.5 * approximate_log2(s.squared_error);
  constexpr int usual = CollocationStep<links>::usual_iterations;
  const double safety = 0.9 * (1 + 2 * usual) / (s.iterations + 2 * usual);
  double factor = approximate_exp2(approximate_log2(safety) - 0.25 * log2_error);
  if (s.h_before != 0.0) {
    const double log2_ratio = 0.25 * (s.log2_error_before - 2.0 * log2_error);
    factor = std::min(factor, 0.9 * (h / s.h_before) * approximate_exp2(log2_ratio));
  }
  return {{s.squared_error, factor}};
}

template <int links>
PENDCORE_INLINE void accept_collocation(CollocationStep<links>* step, double t_new) {
  constexpr double log2_smallest_error = -6.643856189774724;  // log2(1e-2)
  CollocationStep<links>& s = *step;
#pragma GCC unroll 3
  for (int p = 0; p < 3; ++p) {
    for (int i = 0; i < s.size(); i += s.width) store(&s.polynomial(p, i), s.power_of_stages(p, i));
  }
  s.h_before = s.h_tried;
  s.log2_error_before = std::max(0.5 * approximate_log2(s.squared_error), log2_smallest_error);
  s.contraction = s.contraction_of_attempt;
  s.is_retry = false;
  s.has_jacobian = false;
  for (int i = 0; i < s.size(); i += s.width) store(&s.y[i], s.at(s.y_new, i));
  if (s.compensated) s.low = s.low_new;
  s.evaluate(t_new, s.y.data(), s.dydt.data());
}

/// The dense output of the attempted step, as Stepper::interpolant says.
template <int links>
PENDCORE_INLINE void interpolant_of_collocation(const CollocationStep<links>* step,
                                                double* coefficients) {
  using Block = typename CollocationStep<links>::Block;
  const CollocationStep<links>& s = *step;
  const int size = s.size();
  for (int i = 0; i < size; i += s.width) {
    const Block own = s.at(s.slope, i);
    const Block change = own - s.power_of_stages(0, i);
    store(coefficients + i, s.at(s.y, i));
    store(coefficients + size + i, own);
    for (int p = 1; p < Collocation::degree; ++p) {
      const Block before = p < 3 ? s.power_of_stages(p, i) : Block{};
      store(coefficients + (p + 1) * size + i, before + s.method.correction[p] * change);
    }
  }
}

template <int links>
class ImplicitRungeKutta final : public Stepper {
 public:
  ImplicitRungeKutta(const Collocation& method, std::unique_ptr<DifferentiableSystem> system,
                     bool compensated)
      : system_(std::move(system)), step_(method, *system_, compensated, *this) {}

  const MethodInfo& info() const override { return step_.method.info; }
  int dimension() const override { return step_.size(); }
  int controlled() const override { return step_.state(); }
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
    drop_changed(y, step_.y.data(), low_size(), step_.low.data());
    step_.y = View(y, dimension());
    step_.dydt = View(dydt, dimension());
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
    step_.y_new = View(y, dimension());
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
    step_.stages.setZero();
    step_.slope.setZero();
    step_.squared_error = 0.0;
  }

  void accept(double t_new) override { accept_(&step_, t_new); }

  void interpolant(double /*h*/, double* coefficients) override {
    interpolant_(&step_, coefficients);
  }
  double stiffness(double /*h*/) override { return 0.0; }  // stability limits no step

  /// The low part of the state, if compensated. The polynomial, size and error of the accepted
  /// step, and the contraction of its iteration. Whether a step from here was tried already.
  StepperState saved_state() const override {
    const CollocationStep<links>& s = step_;
    std::vector<double> memory(s.low.data(), s.low.data() + low_size());
    memory.insert(memory.end(), s.polynomial.data(), s.polynomial.data() + s.polynomial.size());
    memory.insert(memory.end(),
                  {s.h_before, s.log2_error_before, s.contraction, s.is_retry ? 1.0 : 0.0});
    return {.memory = std::move(memory)};
  }
  void restore(const StepperState& saved) override {
    const std::vector<double>& memory = saved.memory;
    CollocationStep<links>& s = step_;
    const Eigen::Index past = s.polynomial.size();
    if (static_cast<Eigen::Index>(memory.size()) != low_size() + past + 4) {
      throw std::invalid_argument(
          "what the method kept of its last step does not belong to this scene");
    }
    s.low.head(low_size()) = View(memory.data(), low_size());
    std::copy_n(memory.data() + low_size(), past, s.polynomial.data());
    const double* const rest = memory.data() + low_size() + past;
    s.h_before = rest[0];
    s.log2_error_before = rest[1];
    s.contraction = rest[2];
    s.is_retry = rest[3] != 0.0;
  }

 private:
  int low_size() const { return step_.compensated ? dimension() : 0; }

  std::unique_ptr<DifferentiableSystem> system_;
  CollocationStep<links> step_;

  Attempt (*attempt_)(CollocationStep<links>*, double, double,
                      const std::function<bool()>*) = fastest<&attempt_collocation<links>>();
  void (*accept_)(CollocationStep<links>*, double) = fastest<&accept_collocation<links>>();
  void (*interpolant_)(const CollocationStep<links>*,
                       double*) = fastest<&interpolant_of_collocation<links>>();
};

}  // namespace

std::unique_ptr<Stepper> implicit_runge_kutta(const Collocation& method,
                                              std::unique_ptr<DifferentiableSystem> system,
                                              bool compensated) {
  const int links = has_special_kernels_of_rare_runs && system->quadratures == 0 ? system->row : 0;
  const auto made = [&]<int known>() -> std::unique_ptr<Stepper> {
    return std::make_unique<ImplicitRungeKutta<known>>(method, std::move(system), compensated);
  };
  if constexpr (has_special_kernels_of_rare_runs) {
    if (links == 1) return made.template operator()<1>();
    if (links == 2) return made.template operator()<2>();
  }
  return made.template operator()<Eigen::Dynamic>();
}

}  // namespace pendcore
