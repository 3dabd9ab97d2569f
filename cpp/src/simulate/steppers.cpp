// Makes the stepper of a method in the list for a scene, whatever form its equations have.
#include "simulate/steppers.hpp"

#include "dynamics/energetics/ledger.hpp"
#include "dynamics/first_order.hpp"
#include "dynamics/jacobian.hpp"
#include "integrate/method_list.hpp"
#include "integrate/radau/implicit_runge_kutta.hpp"
#include "integrate/runge_kutta/runge_kutta_fixed.hpp"
#include "integrate/runge_kutta/runge_kutta_in_memory.hpp"
#include "pendcore/methods.hpp"

namespace pendcore {

namespace {

/// What a stepper is made for. The scene must outlive the stepper of a pair.
struct Wanted {
  const Scene& scene;
  EquationsOfMotion equations;
  bool keeps_ledger;
  bool compensated;

  int links() const { return static_cast<int>(scene.links.size()); }
};

/// The equations of motion of a scene, in any form, as a system in memory: dy/dt of (q, qd), and
/// the powers of the ledger beside it where the run keeps one.
class SceneSystem final : public DifferentiableSystem {
 public:
  /// Rows of `row_size` numbers, of which the first belong to links.
  SceneSystem(const Wanted& wanted, int row_size)
      : DifferentiableSystem(
            row_size, wanted.keeps_ledger ? static_cast<int>(accounts_of(wanted.scene).size()) : 0),
        equations_(wanted.equations),
        right_hand_side_(right_hand_side(equations_)),
        n_(wanted.links()) {
    if (quadratures > 0) ledger_ = std::make_unique<Ledger>(wanted.scene, equations_.effects);
  }
  SceneSystem(const SceneSystem&) = delete;  // the right-hand side points into the equations
  SceneSystem& operator=(const SceneSystem&) = delete;

  void operator()(double t, const double* y, double* dydt) const override {
    for (int i = 0; i < n_; ++i) dydt[i] = y[row + i];
    right_hand_side_(t, y, y + row, dydt + row);
    if (ledger_) {
      ledger_->powers(t, y, y + row, dydt + row, dydt + static_cast<std::ptrdiff_t>(2) * row);
    }
  }

  void derivatives_of_three(const double* t, const double* y, double* dydt) const override {
    // The kernel knows states of two links, and nothing beside them.
    const bool has_kernel =
        right_hand_side_.compute_three != nullptr && row == 2 && quadratures == 0;
    if (!has_kernel) return DifferentiableSystem::derivatives_of_three(t, y, dydt);
    right_hand_side_.compute_three(right_hand_side_.form, t, y, dydt);
  }

  /// Makes jacobian() available.
  void differentiate(const Scene& scene) {
    jacobian_ = std::make_unique<Jacobian>(scene, equations_);
  }
  void jacobian(double t, const double* y, Eigen::Ref<Matrix> by_q,
                Eigen::Ref<Matrix> by_qd) const override {
    (*jacobian_)(t, y, y + row, by_q, by_qd);
  }

 private:
  EquationsOfMotion equations_;
  RightHandSide right_hand_side_;
  int n_;
  std::unique_ptr<Ledger> ledger_;
  std::unique_ptr<Jacobian> jacobian_;
};

/// Steppers that are written for the form of the equations are the fastest. Rarer runs keep the
/// state in memory and give the same bits: long chains, compensated steps, runs that keep the
/// ledger, and processors from before 2013; in a small module, scenes with effects.
template <const auto& table>
std::unique_ptr<Stepper> explicit_stepper(const Wanted& wanted) {
  auto in_memory = [&]() -> std::unique_ptr<Stepper> {
    const int row = row_in_memory(wanted.links(), wanted.compensated);
    return runge_kutta_in_memory(table.info.name, std::make_unique<SceneSystem>(wanted, row),
                                 wanted.links(), wanted.compensated);
  };
  if (wanted.compensated || wanted.keeps_ledger || instruction_set() < special_sets.least)
    return in_memory();
  return std::visit(
      [&]<class Form>(const Form& form) -> std::unique_ptr<Stepper> {
        constexpr bool is_bare =
            std::is_same_v<Form, SinglePendulum> || std::is_same_v<Form, DoublePendulum>;
        if constexpr (std::is_same_v<Form, std::shared_ptr<Chain>> ||
                      !(is_bare || has_special_kernels_of_rare_runs)) {
          return in_memory();
        } else {
          using System = FirstOrder<Form>;
          return std::make_unique<RungeKuttaFixed<table, System, special_sets>>(
              System{form}, wanted.equations.effects);
        }
      },
      wanted.equations.form);
}

/// One stepper serves all forms: the form hardly changes what an implicit step costs.
std::unique_ptr<Stepper> implicit(const Collocation& method, const Wanted& wanted) {
  auto system = std::make_unique<SceneSystem>(wanted, wanted.links());
  system->differentiate(wanted.scene);
  return implicit_runge_kutta(method, std::move(system), wanted.compensated);
}

template <const auto& table>
std::unique_ptr<Stepper> stepper_of(const Wanted& wanted) {
  if constexpr (table.info.kind == MethodKind::taylor_one) {
    auto system = std::make_shared<SceneSystem>(wanted, wanted.links());
    auto rates = [system](double t, const double* y, double* dydt) { (*system)(t, y, dydt); };
    return make_taylor_stepper(wanted.scene, wanted.equations, rates, system->quadratures,
                               wanted.compensated);
  } else if constexpr (table.info.kind == MethodKind::implicit_one) {
    return implicit(table, wanted);
  } else if constexpr (table.info.kind == MethodKind::pair) {
    return std::make_unique<StiffSwitchingStepper>(
        stepper_of<table.first>(wanted), [wanted] { return implicit(table.second, wanted); });
  } else {
    return explicit_stepper<table>(wanted);
  }
}

}  // namespace

std::unique_ptr<Stepper> make_stepper(const Scene& scene, const EquationsOfMotion& equations,
                                      std::string_view method, bool ledger, bool compensated) {
  const bool keeps_ledger = ledger && !accounts_of(scene).empty();
  const Wanted wanted{scene, equations, keeps_ledger, compensated};
  std::unique_ptr<Stepper> stepper;
  Methods::with(find_method(method).name,
                [&]<const auto & table>() { stepper = stepper_of<table>(wanted); });
  return stepper;
}

std::unique_ptr<Stepper> make_stepper(const Scene& scene, std::string_view method) {
  return make_stepper(scene, equations_of_motion(scene), method, false, false);
}

}  // namespace pendcore
