/// \file
/// A run that begins with an explicit method, and goes on with an implicit one from where the
/// explicit one's steps are found to be limited by stability (Hairer's test, in the loop).
///
/// It changes once: what was stiff may stay so, and an implicit step is right anywhere. Of the
/// dense output all steps have the explicit method's degree; the implicit one's end in zeros.
#pragma once

#include <memory>

#include "pendcore/integrate/dormand_prince_5.hpp"
#include "pendcore/integrate/radau_5.hpp"
#include "pendcore/integrate/stepper.hpp"

namespace pendcore {

/// Names the pair; order and interpolant are those that a run begins with.
struct Automatic {
  MethodInfo info;
};

inline constexpr Automatic automatic = {
    .info = {.name = "auto",
             .citation = "Hairer & Wanner 1996, IV.2, for the test",
             .kind = MethodKind::automatic,
             .order = dormand_prince_5.info.order,
             .error_order = dormand_prince_5.info.error_order,
             .interpolant_order = dormand_prince_5.info.interpolant_order,
             .beta = dormand_prince_5.info.beta,
             .stability = dormand_prince_5.info.stability}};

class AutomaticStepper final : public Stepper {
 public:
  AutomaticStepper(std::unique_ptr<Stepper> without_stiffness, std::unique_ptr<Stepper> with);

  const MethodInfo& info() const override { return info_; }
  int dimension() const override { return now().dimension(); }
  int controlled() const override { return now().controlled(); }
  int interpolant_degree() const override { return explicit_->interpolant_degree(); }

  void set_tolerances(const double* rtol, const double* atol) override;
  void start(const double* y, const double* dydt) override { now().start(y, dydt); }
  void get_state(double* y) const override { now().get_state(y); }
  void get_derivative(double* dydt) const override { now().get_derivative(dydt); }
  void get_new_state(double* y) const override { now().get_new_state(y); }
  void set_new_state(const double* y) override { now().set_new_state(y); }
  void evaluate(double t, const double* y, double* dydt) override;
  Attempt attempt(double t, double h, double gain) override;
  void stay() override { now().stay(); }
  void accept(double t_new) override;
  void interpolant(double h, double* coefficients) const override;
  void sample(const double* coefficients, const TwoDouble& start, double h, const double* times,
              int count, double* states) const override {
    explicit_->sample(coefficients, start, h, times, count, states);
  }
  double stiffness(double h) const override { return now().stiffness(h); }
  void stiffness_found() override { is_found_ = true; }

  /// Whether it has changed, and the memory of the method in force.
  std::vector<double> memory() const override;
  void restore(const std::vector<double>& memory) override;

 private:
  Stepper& now() { return has_changed_ ? *implicit_ : *explicit_; }
  const Stepper& now() const { return has_changed_ ? *implicit_ : *explicit_; }
  void change();
  void count();

  std::unique_ptr<Stepper> explicit_;
  std::unique_ptr<Stepper> implicit_;
  MethodInfo info_;  ///< of the method in force, by its own name
  bool is_found_ = false;
  bool has_changed_ = false;
};

}  // namespace pendcore
