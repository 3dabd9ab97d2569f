#include "pendcore/dynamics/equations_of_motion.hpp"

#include <stdexcept>
#include <string>

namespace pendcore {
namespace {

template <class Dynamics>
PENDCORE_INLINE void accelerations_of(const Dynamics* dynamics, const double* q, const double* qd,
                                      double* qdd) {
  using Links = typename Dynamics::Links;
  store(qdd, dynamics->accelerations(load<Links>(q), load<Links>(qd)));
}

}  // namespace

EquationsOfMotion equations_of_motion(const Scene& scene) {
  const Inertia inertia(scene);
  switch (scene.links.size()) {
    case 1: return SinglePendulum(inertia, scene.gravity);
    case 2: return DoublePendulum(scene, inertia);
    default:
      throw std::invalid_argument("links: " + std::to_string(scene.links.size()) +
                                  " links: this version simulates chains of one or two");
  }
}

void accelerations(const EquationsOfMotion& equations, double /*t*/, const double* q,
                   const double* qd, double* qdd) {
  std::visit(
      [=]<class Dynamics>(const Dynamics& dynamics) {
        static const auto compute = fastest<&accelerations_of<Dynamics>>();
        compute(&dynamics, q, qd, qdd);
      },
      equations);
}

}  // namespace pendcore
