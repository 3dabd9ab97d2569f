#include "analysis/gauss_collocation.hpp"

#include <numbers>

#include "arithmetic/sine_cosine.hpp"

namespace pendcore {
namespace {

/// Legendre's polynomials P_0 .. P_{count - 1} at 2 theta - 1.
Vector legendre(int count, double theta) {
  const double x = 2.0 * theta - 1.0;
  Vector p(count);
  for (int k = 0; k < count; ++k) {
    p[k] = k == 0 ? 1.0 : k == 1 ? x : ((2 * k - 1) * x * p[k - 1] - (k - 1) * p[k - 2]) / k;
  }
  return p;
}

}  // namespace

GaussCollocation::GaussCollocation(int points) : s(points), theta(points), weight(points) {
  for (int i = 0; i < s; ++i) {  // Newton's method, from Tricomi's estimate
    double sine, cosine;
    sine_cosine(std::numbers::pi * (i + 0.75) / (s + 0.5), sine, cosine);
    double x = 0.5 - 0.5 * cosine;
    double slope = 0.0;
    for (int round = 0; round < 8; ++round) {
      const Vector p = legendre(s + 1, x);
      const double at = 2.0 * x - 1.0;
      slope = 2.0 * s * (p[s - 1] - at * p[s]) / (1.0 - at * at);
      x -= p[s] / slope;
    }
    theta[i] = x;
    weight[i] = 4.0 / ((1.0 - (2.0 * x - 1.0) * (2.0 * x - 1.0)) * slope * slope);
  }
  to_legendre.resize(s, s);
  for (int j = 0; j < s; ++j) {
    const Vector p = legendre(s, theta[j]);
    for (int k = 0; k < s; ++k) to_legendre(k, j) = (2 * k + 1) * weight[j] * p[k];
  }
  for (int i = 0; i < s; ++i) to_point.push_back(integrals(theta[i]));
  to_end = integrals(1.0);
}

GaussCollocation::Integrals GaussCollocation::integrals(double at) const {
  const Vector p = legendre(s + 3, at);
  Vector once(s + 1), twice(s);  // of P_k
  for (int k = 0; k <= s; ++k) {
    once[k] = k == 0 ? at : (p[k + 1] - p[k - 1]) / (2.0 * (2 * k + 1));
  }
  for (int k = 0; k < s; ++k) {
    twice[k] = k == 0 ? 0.5 * at * at : (once[k + 1] - once[k - 1]) / (2.0 * (2 * k + 1));
  }
  return {to_legendre.transpose() * once.head(s), to_legendre.transpose() * twice};
}

const GaussCollocation& gauss_collocation(int points) {
  static const std::vector<GaussCollocation> all = [] {
    std::vector<GaussCollocation> made;
    for (int s = least_points; s <= most_points; ++s) made.emplace_back(s);
    return made;
  }();
  return all[points - least_points];
}

}  // namespace pendcore
