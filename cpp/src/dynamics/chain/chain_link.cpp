#include "dynamics/chain/chain_link.hpp"

namespace pendcore {

std::vector<ChainLink> chain_links(const Scene& scene, const Inertia& inertia) {
  std::vector<ChainLink> links;
  for (const Link& link : scene.links) {
    const double m = link.mass;
    const double L = link.length;
    const double mc = m * link.center;
    const bool is_last = links.size() + 1 == scene.links.size();
    const double I = link.inertia + (is_last ? inertia.payload_inertia : 0.0);
    const double about_joint = I + m * link.center * link.center;
    const double rest = L - link.center;
    links.push_back({.m = m,
                     .L = L,
                     .mc = mc,
                     .I = I,
                     .Io = about_joint,
                     .LL = L * L,
                     .turn = about_joint - mc * L,
                     .across = I + m * rest * rest});
  }
  links.front().Io += inertia.links.front().rotor;
  return links;
}

}  // namespace pendcore
