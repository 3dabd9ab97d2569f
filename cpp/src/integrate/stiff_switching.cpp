#include "integrate/stiff_switching.hpp"

#include <limits>
#include <new>
#include <utility>

#include "integrate/loop/interruption.hpp"

namespace pendcore {
namespace {

/// The steps of radau5 must be longer by this factor. On 1 to 30 links one of them costs as much as
/// 1 to 6 series, 2 to 13 steps of dop853, or 3 to 16 steps of dopri5.
constexpr double longer = 10.0;

}  // namespace

StiffSwitchingStepper::StiffSwitchingStepper(std::unique_ptr<Stepper> first, Make make_implicit)
    : first_(std::move(first)), make_implicit_(std::move(make_implicit)), info_(first_->info()) {}

void StiffSwitchingStepper::set_tolerances(const double* rtol, const double* atol) {
  first_->set_tolerances(rtol, atol);
  rtol_.assign(rtol, rtol + controlled());
  atol_.assign(atol, atol + controlled());
}

void StiffSwitchingStepper::count() {
  evaluations = first_->evaluations;
  if (!implicit_) return;
  evaluations += implicit_->evaluations;
  jacobians = implicit_->jacobians;
  factorisations = implicit_->factorisations;
}

void StiffSwitchingStepper::evaluate(double t, const double* y, double* dydt) {
  now().evaluate(t, y, dydt);
  count();
}

bool StiffSwitchingStepper::stiffness_found(bool size_is_given) {
  if (size_is_given) {
    takes_over_ = true;
  } else {
    h_asked_ = longer * h_;
  }
  return true;
}

Attempt StiffSwitchingStepper::attempt(const TwoDouble& t, double h, double gain) {
  if (h_asked_ != 0.0) {
    const std::optional<bool> answer = pays(t.high);
    count();
    if (!answer) return {{std::numeric_limits<double>::quiet_NaN(), 0.0}};
    h_asked_ = 0.0;
    if (*answer) change();
  }
  if (has_changed_) implicit_->keep_going = keep_going;  // the first method never takes long
  h_ = h;
  const Attempt attempt = now().attempt(t, h, gain);
  count();
  return attempt;
}

/// Whether the implicit method's step is within the tolerances; no answer if the attempt was given
/// up.
std::optional<bool> StiffSwitchingStepper::pays(double t) {
  begin_implicit();
  bool is_given_up = false;
  implicit_->keep_going = [this, &is_given_up] {
    is_given_up = is_given_up || (keep_going && !keep_going());
    return !is_given_up;
  };
  double squared_error = 0.0;
  try {
    squared_error = implicit_->attempt({t}, h_asked_, 0.0).squared_error;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const Stopped&) {
    throw;
  } catch (...) {  // a user's function, which the run's own steps may never call there
    squared_error = std::numeric_limits<double>::infinity();
  }
  implicit_->keep_going = nullptr;
  if (is_given_up) return std::nullopt;
  return squared_error <= 1.0;
}

void StiffSwitchingStepper::accept(double t_new) {
  now().accept(t_new);
  if (takes_over_ && !has_changed_) change();
  count();
}

/// Starts the implicit method from the state of the first.
void StiffSwitchingStepper::begin_implicit() {
  std::vector<double> y(dimension());
  std::vector<double> dydt(dimension());
  first_->get_state(y.data());
  first_->get_derivative(dydt.data());
  if (!implicit_) {
    implicit_ = make_implicit_();
    implicit_->set_tolerances(rtol_.data(), atol_.data());
  }
  implicit_->start(y.data(), dydt.data());
}

void StiffSwitchingStepper::change() {
  begin_implicit();
  has_changed_ = true;
  info_ = implicit_->info();
}

void StiffSwitchingStepper::interpolant(double h, double* coefficients) {
  now().interpolant(h, coefficients);
  const std::ptrdiff_t size = dimension();
  const double* const highest = coefficients + now().interpolant_degree() * size;
  // The rows above have zeros, or NaN where the highest coefficient overflows: x - x.
  for (int p = now().interpolant_degree() + 1; p <= interpolant_degree(); ++p) {
    for (int i = 0; i < size; ++i) coefficients[p * size + i] = highest[i] - highest[i];
  }
  count();
}

double StiffSwitchingStepper::stiffness(double h) {
  const double found = now().stiffness(h);
  count();
  return found;
}

StepperState StiffSwitchingStepper::saved_state() const {
  StepperState saved = now().saved_state();
  saved.has_switched = has_changed_;
  saved.h_asked = h_asked_;
  return saved;
}

void StiffSwitchingStepper::restore(const StepperState& saved) {
  if (saved.has_switched) change();
  h_asked_ = saved.h_asked;
  now().restore(saved);
}

}  // namespace pendcore
