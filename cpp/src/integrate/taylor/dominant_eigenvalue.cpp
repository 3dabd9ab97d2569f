#include "integrate/taylor/dominant_eigenvalue.hpp"

#include <algorithm>
#include <cmath>

#include "integrate/taylor/taylor.hpp"

namespace pendcore {
namespace {

/// Divides v by its size, and returns that size; `rate` (1/s) says how many rad/s weigh as much as
/// a radian.
double normalise(std::vector<double>& v, double rate) {
  const std::size_t n = v.size() / 2;
  double size = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    size = std::max({size, rate * std::abs(v[i]), std::abs(v[n + i])});
  }
  if (size > 0.0) {
    for (double& component : v) component /= size;
  }
  return size;
}

/// Replaces v by J v.
void multiply_by_jacobian(const Rates& rates, double t, const std::vector<double>& y, double rate,
                          std::vector<double>& v) {
  constexpr double angle = 1e-6;  // rad
  const double share = angle * rate;
  std::vector<double> state(y.size());
  std::vector<double> ahead(y.size());
  std::vector<double> behind(y.size());
  auto look = [&](double step, std::vector<double>& found) {
    for (std::size_t i = 0; i < v.size(); ++i) state[i] = y[i] + step * v[i];
    rates(t, state.data(), found.data());
  };
  look(share, ahead);
  look(-share, behind);
  const std::size_t n = v.size() / 2;
  std::copy_n(v.begin() + n, n, v.begin());
  for (std::size_t i = n; i < 2 * n; ++i) v[i] = (ahead[i] - behind[i]) / (2.0 * share);
}

}  // namespace

double stiffness_of_series(const Rates& rates, double t, const std::vector<double>& y,
                           std::vector<double> v, double h, int order) {
  // Where stability limits the steps, |lambda| is about this rate.
  const double rate = taylor.info.stability * order / std::abs(h);
  const double size = normalise(v, rate);
  if (!(size > 0.0 && std::isfinite(size))) return 0.0;
  multiply_by_jacobian(rates, t, y, rate, v);
  const double once = normalise(v, rate);
  multiply_by_jacobian(rates, t, y, rate, v);
  const double twice = normalise(v, rate);
  return std::abs(h) * std::sqrt(once * twice) / order;
}

}  // namespace pendcore
