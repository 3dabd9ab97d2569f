#include "integrate/taylor/dominant_eigenvalue.hpp"

#include <algorithm>
#include <cmath>

#include "integrate/taylor/taylor.hpp"

namespace pendcore {

double* DominantEigenvalue::direction() {
  v_.resize(static_cast<std::size_t>(2 * n_));
  for (auto* one : {&state_, &ahead_, &behind_}) one->resize(v_.size() + quadratures_);
  return v_.data();
}

double DominantEigenvalue::norm(double rate) const {
  double largest = 0.0;
  for (int i = 0; i < n_; ++i) {
    largest = std::max({largest, rate * std::abs(v_[i]), std::abs(v_[n_ + i])});
  }
  return largest;
}

double DominantEigenvalue::multiply(const Rates& rates, double t, const double* y, double rate) {
  constexpr double angle = 1e-6;  // rad
  const double share = angle * rate;
  auto look = [&](double step, std::vector<double>& found) {
    for (int i = 0; i < 2 * n_; ++i) state_[i] = y[i] + step * v_[i];
    rates(t, state_.data(), found.data());
  };
  look(share, ahead_);
  look(-share, behind_);
  std::copy_n(v_.begin() + n_, n_, v_.begin());
  for (int i = n_; i < 2 * n_; ++i) v_[i] = (ahead_[i] - behind_[i]) / (2.0 * share);
  const double size = norm(rate);
  if (size > 0.0) {
    for (double& component : v_) component /= size;
  }
  return size;
}

double DominantEigenvalue::operator()(const Rates& rates, double t, const double* y, double rate) {
  const double size = norm(rate);
  if (!(size > 0.0 && std::isfinite(size))) return 0.0;
  for (double& component : v_) component /= size;
  const double once = multiply(rates, t, y, rate);
  const double twice = multiply(rates, t, y, rate);
  return std::sqrt(once * twice);
}

double stiffness_of_series(DominantEigenvalue& eigenvalue, const Rates& rates, double t,
                           const double* y, double h, int order) {
  // Where stability limits the steps, |lambda| is about this rate.
  const double rate = taylor.info.stability * order / std::abs(h);
  return std::abs(h) * eigenvalue(rates, t, y, rate) / order;
}

}  // namespace pendcore
