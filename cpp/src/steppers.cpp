// The explicit instantiations: every method in the list with every form of the equations of motion.
// Compile time lives here only.
#include "pendcore/dynamics/equations_of_motion.hpp"
#include "pendcore/dynamics/first_order.hpp"
#include "pendcore/integrate/explicit_runge_kutta.hpp"
#include "pendcore/integrate/methods.hpp"
#include "pendcore/simulate.hpp"

namespace pendcore {
namespace {

template <class Dynamics, const auto&... tables>
std::unique_ptr<Stepper> apply(MethodList<tables...>, std::string_view name,
                               const Dynamics& dynamics) {
  using System = FirstOrder<Dynamics>;
  std::unique_ptr<Stepper> stepper;
  ((tables.info.name == name
        ? void(stepper = std::make_unique<ExplicitRungeKutta<tables, System>>(System{dynamics}))
        : void()),
   ...);
  return stepper;
}

}  // namespace

std::unique_ptr<Stepper> make_stepper(const Scene& scene, std::string_view method) {
  const std::string_view name = find_method(method).name;
  return std::visit([name](const auto& dynamics) { return apply(Methods{}, name, dynamics); },
                    equations_of_motion(scene));
}

}  // namespace pendcore
