// The explicit instantiations: every method in the list with every form of the equations of motion.
// Compile time lives here only.
#include "pendcore/dynamics/energetics/ledger.hpp"
#include "pendcore/dynamics/first_order.hpp"
#include "pendcore/dynamics/jacobian.hpp"
#include "pendcore/integrate/methods.hpp"
#include "pendcore/integrate/radau/implicit_runge_kutta.hpp"
#include "pendcore/integrate/runge_kutta/runge_kutta_dynamic.hpp"
#include "pendcore/integrate/runge_kutta/runge_kutta_fixed.hpp"
#include "pendcore/simulate/simulate.hpp"

namespace pendcore {
namespace {

/// Any form of the equations, with the ledger beside it if it is kept.
class SceneSystem final : public DifferentiableSystem {
 public:
  SceneSystem(const Scene& scene, const EquationsOfMotion& equations, int row_size, bool ledger)
      : DifferentiableSystem(row_size, ledger ? static_cast<int>(accounts_of(scene).size()) : 0),
        equations_(equations),
        n_(static_cast<int>(scene.links.size())) {
    if (quadratures > 0) {
      ledger_ = std::make_unique<Ledger>(scene, equations.effects);
    }
  }

  void operator()(double t, const double* y, double* dydt) const override {
    __builtin_memcpy(dydt, y + row, n_ * sizeof(double));
    accelerations_in_force(equations_, t, y, y + row, dydt + row);
    if (ledger_) {
      ledger_->powers(t, y, y + row, dydt + row, dydt + static_cast<std::ptrdiff_t>(2) * row);
    }
  }
  void differentiate(const Scene& scene) {
    jacobian_ = std::make_unique<Jacobian>(scene, equations_);
  }
  void jacobian(double t, const double* y, double* by_q, double* by_qd) const override {
    (*jacobian_)(t, y, y + row, by_q, by_qd);
  }

 private:
  EquationsOfMotion equations_;
  int n_;
  std::unique_ptr<Ledger> ledger_;
  std::unique_ptr<Jacobian> jacobian_;
};

/// Any form alike: what an implicit step costs is not in the form.
std::unique_ptr<Stepper> implicit(const Collocation& method, const Scene& scene,
                                  const EquationsOfMotion& equations, bool ledger,
                                  bool compensated) {
  auto system =
      std::make_unique<SceneSystem>(scene, equations, static_cast<int>(scene.links.size()), ledger);
  system->differentiate(scene);
  return std::make_unique<ImplicitRungeKutta>(method, std::move(system), compensated);
}

/// What a method of the list makes of a scene. `of_table` makes the stepper of an explicit one.
template <const auto& table, bool compensated, class OfTable>
std::unique_ptr<Stepper> stepper_of(const Scene& scene, const EquationsOfMotion& equations,
                                    bool ledger, const OfTable& of_table) {
  if constexpr (table.info.kind == MethodKind::taylor_one) {
    auto system = std::make_shared<SceneSystem>(scene, equations,
                                                static_cast<int>(scene.links.size()), ledger);
    auto rates = [system](double t, const double* y, double* dydt) { (*system)(t, y, dydt); };
    return make_taylor_stepper(scene, equations, rates, system->quadratures, compensated);
  } else if constexpr (table.info.kind == MethodKind::implicit_one) {
    return implicit(table, scene, equations, ledger, compensated);
  } else if constexpr (table.info.kind == MethodKind::pair) {
    return std::make_unique<StiffSwitchingStepper>(
        stepper_of<table.first, compensated>(scene, equations, ledger, of_table),
        [&scene, equations, ledger] {
          return implicit(table.second, scene, equations, ledger, compensated);
        });
  } else {
    return of_table.template operator()<table>();
  }
}

template <class Make, const auto&... tables>
std::unique_ptr<Stepper> with_method(MethodList<tables...>, std::string_view name, Make make) {
  std::unique_ptr<Stepper> stepper;
  ((tables.info.name == name ? void(stepper = make.template operator()<tables>()) : void()), ...);
  return stepper;
}

template <class Block, bool compensated>
std::unique_ptr<Stepper> general(const Scene& scene, const EquationsOfMotion& equations,
                                 std::string_view method, bool ledger) {
  constexpr int width = Lanes<Block>::width;
  const int n = static_cast<int>(scene.links.size());
  const int row = (n + width - 1) / width * width;
  auto of_table = [&]<const auto & table>() -> std::unique_ptr<Stepper> {
    return std::make_unique<RungeKuttaDynamic<table, Block, compensated>>(
        std::make_unique<SceneSystem>(scene, equations, row, ledger), n);
  };
  return with_method(Methods{}, method, [&]<const auto & table>() {
    return stepper_of<table, compensated>(scene, equations, ledger, of_table);
  });
}

template <bool compensated>
std::unique_ptr<Stepper> stepper_for(const Scene& scene, const EquationsOfMotion& equations,
                                     std::string_view name, bool ledger) {
  if (ledger && !accounts_of(scene).empty()) {
    switch (scene.links.size()) {
      case 1: return general<double, compensated>(scene, equations, name, true);
      case 2: return general<Pair, compensated>(scene, equations, name, true);
      default: return general<Pack<4>, compensated>(scene, equations, name, true);
    }
  }
  return std::visit(
      [&]<class Form>(const Form& form) -> std::unique_ptr<Stepper> {
        if constexpr (std::is_same_v<Form, std::shared_ptr<Chain>>) {
          return general<Pack<4>, compensated>(scene, equations, name, false);
        } else {
          using System = FirstOrder<Form>;
          auto of_table = [&]<const auto & table>() -> std::unique_ptr<Stepper> {
            return std::make_unique<RungeKuttaFixed<table, System, compensated>>(System{form},
                                                                                 equations.effects);
          };
          return with_method(Methods{}, name, [&]<const auto & table>() {
            return stepper_of<table, compensated>(scene, equations, false, of_table);
          });
        }
      },
      equations.form);
}

}  // namespace

std::unique_ptr<Stepper> make_stepper(const Scene& scene, const EquationsOfMotion& equations,
                                      std::string_view method, bool ledger, bool compensated) {
  const std::string_view name = find_method(method).name;
  return compensated ? stepper_for<true>(scene, equations, name, ledger)
                     : stepper_for<false>(scene, equations, name, ledger);
}

std::unique_ptr<Stepper> make_stepper(const Scene& scene, std::string_view method) {
  return make_stepper(scene, equations_of_motion(scene), method, false, false);
}

}  // namespace pendcore
