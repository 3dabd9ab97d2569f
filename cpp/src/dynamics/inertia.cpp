#include "dynamics/inertia.hpp"

#include <algorithm>

#include "pendcore/effects/payload.hpp"
#include "pendcore/effects/rotor_inertia.hpp"

namespace pendcore {

Inertia::Inertia(const Scene& scene) {
  const std::size_t n = scene.links.size();
  links.resize(n);
  for (const Payload& payload : effects_of<Payload>(scene)) {
    payload_mass += payload.mass;
    payload_inertia += payload.inertia;
  }
  for (const RotorInertia& one : effects_of<RotorInertia>(scene)) {
    links[one.joint - 1].rotor += one.armature;
  }
  double beyond = payload_mass;  // S_i
  for (std::size_t i = n; i-- > 0;) {
    const Link& link = scene.links[i];
    LinkInertia& own = links[i];
    own.length = link.length;
    own.first_moment = link.mass * link.center + link.length * beyond;
    own.diagonal = link.inertia_about_joint() + link.length * link.length * beyond;
    beyond += link.mass;
    if (i + 1 == n) own.diagonal += payload_inertia;
    own.diagonal += own.rotor + (i + 1 < n ? links[i + 1].rotor : 0.0);
  }
}

double Inertia::coupling(std::size_t i, std::size_t j) const {
  return links[std::min(i, j)].length * links[std::max(i, j)].first_moment;
}

std::vector<double> Inertia::rotors_between_links() const {
  std::vector<double> rotors(links.size());
  for (std::size_t i = 1; i < links.size(); ++i) rotors[i] = links[i].rotor;
  return rotors;
}

}  // namespace pendcore
