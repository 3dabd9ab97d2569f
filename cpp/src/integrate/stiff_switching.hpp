/// \file
/// A run that begins with one method and goes on with an implicit one from where that is faster.
/// Until then it has every bit of a run with the first method.
///
/// Where stability is found to limit the steps of the first method (stiffness.hpp), the implicit
/// method tries a step that is ten times as long, which is about the ratio of the costs of their
/// steps. If the error of that step is within the tolerances, the run goes on with the implicit
/// method, with steps that grow from the size of the first's. If not, accuracy hardly allows longer
/// steps than stability does: the first method stays, and the question is asked again after another
/// fifteen hits. Steps of a given size cannot grow. There the implicit method, which stays bounded,
/// takes over at once.
///
/// The run changes its method only once: a stiff run may stay stiff, and an implicit step is right
/// anywhere. The dense output of all steps has the degree of the first method, and the highest
/// coefficients of implicit steps are zero.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "integrate/radau/radau_5.hpp"
#include "integrate/runge_kutta/dormand_prince_5.hpp"
#include "integrate/runge_kutta/dormand_prince_8.hpp"
#include "integrate/stepper.hpp"
#include "integrate/taylor/taylor.hpp"

namespace pendcore {

/// Names two methods. The order and the interpolant are those of the first.
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
    "dopri5-radau5", {.color = "purple", .dash = "1 1", .marker = "v"}};
inline constexpr StiffSwitching<dormand_prince_8, radau_5> dop853_radau5{
    "dop853-radau5", {.color = "ochre", .dash = "3 1 1 1", .marker = "<"}};
inline constexpr StiffSwitching<taylor, radau_5> taylor_radau5{
    "taylor-radau5", {.color = "teal", .dash = "6 2", .marker = ">"}};

class StiffSwitchingStepper final : public Stepper {
 public:
  using Make = std::function<std::unique_ptr<Stepper>()>;

  /// The second method is made when it is needed; most runs never need it.
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
  void get_new_derivative(double* dydt) const override { now().get_new_derivative(dydt); }
  void set_new_state(const double* y) override { now().set_new_state(y); }
  void evaluate(double t, const double* y, double* dydt) override;
  double own_first_step(double t) override { return now().own_first_step(t); }
  Attempt attempt(const TwoDouble& t, double h, double gain) override;
  void stay() override { now().stay(); }
  void accept(double t_new) override;
  void interpolant(double h, double* coefficients) override;
  void sample(const double* coefficients, const TwoDouble& start, double h, const double* times,
              int count, double* states) const override {
    first_->sample(coefficients, start, h, times, count, states);
  }
  double stiffness(double h) override;
  bool stiffness_found(bool size_is_given) override;

  StepperState saved_state() const override;
  void restore(const StepperState& saved) override;

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
  MethodInfo info_;       ///< the current method's, under its own name
  double h_ = 0.0;        ///< the size of the last attempt
  double h_asked_ = 0.0;  ///< the size that the implicit method is to try; 0: none
  bool takes_over_ = false;
  bool has_changed_ = false;
};

}  // namespace pendcore
