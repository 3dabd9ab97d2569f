#include "dynamics/contact/momenta.hpp"

namespace pendcore {

std::vector<TwoDouble> momenta(std::span<const Link> links, const Inertia& inertia,
                               std::span<const double> sine, std::span<const double> cosine,
                               const double* qd) {
  const std::size_t n = links.size();
  std::vector<TwoDouble> own_x(n), own_y(n), p(n);  // m v_C
  TwoDouble x, y;
  for (std::size_t i = 0; i < n; ++i) {
    const TwoDouble across_x = TwoDouble{qd[i]} * -sine[i];
    const TwoDouble across_y = TwoDouble{qd[i]} * cosine[i];
    own_x[i] = (x + across_x * links[i].center) * links[i].mass;
    own_y[i] = (y + across_y * links[i].center) * links[i].mass;
    x = x + across_x * links[i].length;
    y = y + across_y * links[i].length;
  }
  x = x * inertia.payload_mass;
  y = y * inertia.payload_mass;
  for (std::size_t i = n; i-- > 0;) {
    const TwoDouble arm_x = own_x[i] * links[i].center + x * links[i].length;
    const TwoDouble arm_y = own_y[i] * links[i].center + y * links[i].length;
    p[i] = p[i] + arm_x * -sine[i] + arm_y * cosine[i] + TwoDouble{qd[i]} * links[i].inertia;
    x = x + own_x[i];
    y = y + own_y[i];
    const TwoDouble of_rotor = two_sum(qd[i], i > 0 ? -qd[i - 1] : 0.0) * inertia.links[i].rotor;
    p[i] = p[i] + of_rotor;
    if (i > 0) p[i - 1] = of_rotor * -1.0;
  }
  p[n - 1] = p[n - 1] + TwoDouble{qd[n - 1]} * inertia.payload_inertia;
  return p;
}

TwoDouble twice_the_energy(const std::vector<TwoDouble>& p, const double* qd) {
  TwoDouble sum;
  for (std::size_t i = 0; i < p.size(); ++i) sum = sum + p[i] * qd[i];
  return sum;
}

}  // namespace pendcore
