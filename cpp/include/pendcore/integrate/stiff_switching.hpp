/// \file
/// A run that begins with one method, and goes on with an implicit one from where that pays. Until
/// then it is the first, to the last bit.
///
/// Where the steps of the first are found to be limited by stability (stiffness.hpp), the implicit
/// one tries a step ten times as long, about what its steps cost more. If that is within the
/// tolerances, the run goes on with it, by steps that grow from the size of the first's. If not,
/// accuracy allows hardly longer steps than stability does: the first stays, and the question is
/// asked again after another fifteen hits. Steps whose size is given cannot grow: there the
/// implicit one, which stays bounded, takes over at once.
///
/// It changes once: what was stiff may stay so, and an implicit step is right anywhere. Of the
/// dense output all steps have the first method's degree; the implicit one's end in zeros.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "pendcore/integrate/radau/radau_5.hpp"
#include "pendcore/integrate/runge_kutta/dormand_prince_5.hpp"
#include "pendcore/integrate/runge_kutta/dormand_prince_8.hpp"
#include "pendcore/integrate/stepper.hpp"
#include "pendcore/integrate/taylor/taylor.hpp"

namespace pendcore {

/// Names two methods; order and interpolant are those that a run begins with.
template <const auto& first_method, const auto& second_method>
struct StiffSwitching {
  static constexpr const auto& first = first_method;
  static constexpr const auto& second = second_method;
  MethodInfo info;

  constexpr StiffSwitching(std::string_view name, LineStyle line) : info(first_method.info) {
    info.name = name;
    info.aliases = {};
    info.sentence = "The first method, and the second from where stability limits the steps.";
    info.second_opinion = 0;
    info.line = line;
    info.citation = "Hairer & Wanner 1996, IV.2, for the test";
    info.kind = MethodKind::pair;
    info.first_of_pair = first.info.name;
    info.second_of_pair = second.info.name;
  }
};

inline constexpr StiffSwitching<dormand_prince_5, radau_5> dopri5_radau5{
    "dopri5-radau5", {.color = "#8b6bb1", .dash = "1 1", .marker = "v"}};
inline constexpr StiffSwitching<dormand_prince_8, radau_5> dop853_radau5{
    "dop853-radau5", {.color = "#a8741a", .dash = "3 1 1 1", .marker = "<"}};
inline constexpr StiffSwitching<taylor, radau_5> taylor_radau5{
    "taylor-radau5", {.color = "#3f3f5f", .dash = "6 2", .marker = ">"}};

class StiffSwitchingStepper final : public Stepper {
 public:
  using Make = std::function<std::unique_ptr<Stepper>()>;

  /// The second is made where it is called for: most runs never do.
  StiffSwitchingStepper(std::unique_ptr<Stepper> first, Make make_implicit);

  const MethodInfo& info() const override { return info_; }
  int dimension() const override { return now().dimension(); }
  int controlled() const override { return now().controlled(); }
  int interpolant_degree() const override { return first_->interpolant_degree(); }

  void set_tolerances(const double* rtol, const double* atol) override;
  void start(const double* y, const double* dydt) override { now().start(y, dydt); }
  void get_state(double* y) const override { now().get_state(y); }
  void get_derivative(double* dydt) const override { now().get_derivative(dydt); }
  void get_new_state(double* y) const override { now().get_new_state(y); }
  void set_new_state(const double* y) override { now().set_new_state(y); }
  void evaluate(double t, const double* y, double* dydt) override;
  double own_first_step(double t) override { return now().own_first_step(t); }
  Attempt attempt(double t, double h, double gain) override;
  void stay() override { now().stay(); }
  void accept(double t_new) override;
  void interpolant(double h, double* coefficients) override;
  void sample(const double* coefficients, const TwoDouble& start, double h, const double* times,
              int count, double* states) const override {
    first_->sample(coefficients, start, h, times, count, states);
  }
  double stiffness(double h) override { return now().stiffness(h); }
  bool stiffness_found(bool size_is_given) override;

  /// The memory of the method in force, and whether it has changed, or is to ask at its next
  /// attempt whether to, with the size of the step that it asks about.
  std::vector<double> saved_state() const override;
  void restore(const std::vector<double>& memory) override;

 private:
  Stepper& now() { return has_changed_ ? *implicit_ : *first_; }
  const Stepper& now() const { return has_changed_ ? *implicit_ : *first_; }
  void begin_implicit();
  void change();
  std::optional<bool> pays(double t);
  void count();

  std::unique_ptr<Stepper> first_;
  std::unique_ptr<Stepper> implicit_;
  Make make_implicit_;
  std::vector<double> rtol_, atol_;
  MethodInfo info_;       ///< of the method in force, by its own name
  double h_ = 0.0;        ///< of the last attempt
  double h_asked_ = 0.0;  ///< of the step that the implicit one is to try; 0: of none
  bool takes_over_ = false;
  bool has_changed_ = false;
};

}  // namespace pendcore
