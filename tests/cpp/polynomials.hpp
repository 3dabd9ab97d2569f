// Polynomials with known roots.
#pragma once

#include <vector>

namespace pendcore {

/// The coefficients of sign prod (theta - root).
inline std::vector<double> with_roots(const std::vector<double>& roots, double sign = 1.0) {
  std::vector<double> c{sign};
  for (const double root : roots) {
    c.insert(c.begin(), 0.0);
    for (std::size_t k = 0; k + 1 < c.size(); ++k) c[k] -= root * c[k + 1];
  }
  return c;
}

}  // namespace pendcore
