#include "dynamics/chain/chain_link.hpp"

namespace pendcore {

std::vector<ChainLink> chain_links(const Scene& scene, const Inertia& inertia) {
  std::vector<ChainLink> links;
  for (const Link& link : scene.links) {
    const bool is_last = links.size() + 1 == scene.links.size();
    const double I = link.inertia + (is_last ? inertia.payload_inertia : 0.0);
    links.push_back(chain_link(link.mass, link.length, link.center, I));
  }
  links.front().Io += inertia.links.front().rotor;
  return links;
}

}  // namespace pendcore
