#include "pendcore/integrate/automatic.hpp"

#include <algorithm>

namespace pendcore {

AutomaticStepper::AutomaticStepper(std::unique_ptr<Stepper> without_stiffness,
                                   std::unique_ptr<Stepper> with)
    : explicit_(std::move(without_stiffness)),
      implicit_(std::move(with)),
      info_(explicit_->info()) {}

void AutomaticStepper::set_tolerances(const double* rtol, const double* atol) {
  explicit_->set_tolerances(rtol, atol);
  implicit_->set_tolerances(rtol, atol);
}

void AutomaticStepper::count() {
  evaluations = explicit_->evaluations + implicit_->evaluations;
  jacobians = implicit_->jacobians;
  factorisations = implicit_->factorisations;
}

void AutomaticStepper::evaluate(double t, const double* y, double* dydt) {
  now().evaluate(t, y, dydt);
  count();
}

Attempt AutomaticStepper::attempt(double t, double h, double gain) {
  if (has_changed_) implicit_->goes_on = goes_on;  // the explicit one never takes long
  const Attempt attempt = now().attempt(t, h, gain);
  count();
  return attempt;
}

void AutomaticStepper::accept(double t_new) {
  now().accept(t_new);
  if (is_found_ && !has_changed_) change();
  count();
}

/// The implicit method begins where the explicit one stands.
void AutomaticStepper::change() {
  std::vector<double> y(dimension());
  std::vector<double> dydt(dimension());
  explicit_->get_state(y.data());
  explicit_->get_derivative(dydt.data());
  has_changed_ = true;
  info_ = implicit_->info();
  implicit_->start(y.data(), dydt.data());
}

void AutomaticStepper::interpolant(double h, double* coefficients) const {
  now().interpolant(h, coefficients);
  const int size = dimension();
  std::fill(coefficients + static_cast<std::ptrdiff_t>(now().interpolant_degree() + 1) * size,
            coefficients + static_cast<std::ptrdiff_t>(interpolant_degree() + 1) * size, 0.0);
}

std::vector<double> AutomaticStepper::memory() const {
  std::vector<double> memory = now().memory();
  memory.push_back(has_changed_ ? 1.0 : 0.0);
  return memory;
}

void AutomaticStepper::restore(const std::vector<double>& memory) {
  if (memory.empty()) return;
  if (memory.back() != 0.0) change();
  now().restore({memory.begin(), memory.end() - 1});
}

}  // namespace pendcore
