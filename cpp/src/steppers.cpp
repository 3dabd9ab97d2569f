// The explicit instantiations: every method in the list with every form of the equations of motion.
// Compile time lives here only.
#include <stdexcept>

#include "pendcore/dynamics/double_pendulum.hpp"
#include "pendcore/dynamics/first_order.hpp"
#include "pendcore/dynamics/single_pendulum.hpp"
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
  const Inertia inertia(scene);
  switch (scene.links.size()) {
    case 1: return apply(Methods{}, name, SinglePendulum(inertia, scene.gravity));
    case 2: return apply(Methods{}, name, DoublePendulum(scene, inertia));
    default:
      throw std::invalid_argument("links: " + std::to_string(scene.links.size()) +
                                  " links: this version simulates chains of one or two");
  }
}

}  // namespace pendcore
