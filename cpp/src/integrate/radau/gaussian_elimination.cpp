#include "pendcore/integrate/radau/gaussian_elimination.hpp"

#include <cmath>
#include <utility>

namespace pendcore {
namespace {

double size(double x) { return std::abs(x); }
double size(const Complex& x) { return std::abs(x.re) + std::abs(x.im); }

double inverse(double x) { return 1.0 / x; }
Complex inverse(const Complex& x) {
  // Dividing by the larger part first (Smith 1962) avoids squares that overflow.
  if (std::abs(x.re) >= std::abs(x.im)) {
    const double ratio = x.im / x.re;
    const double scale = 1.0 / (x.re + x.im * ratio);
    return {scale, -ratio * scale};
  }
  const double ratio = x.re / x.im;
  const double scale = 1.0 / (x.re * ratio + x.im);
  return {ratio * scale, -scale};
}

double product(double x, double y) { return x * y; }
Complex product(const Complex& x, const Complex& y) {
  return {x.re * y.re - x.im * y.im, x.re * y.im + x.im * y.re};
}

/// x -= y z
void subtract(double& x, double y, double z) { x -= y * z; }
void subtract(Complex& x, const Complex& y, const Complex& z) {
  x.re -= y.re * z.re - y.im * z.im;
  x.im -= y.re * z.im + y.im * z.re;
}

}  // namespace

template <class Number>
bool GaussianElimination<Number>::factor(const std::function<bool()>& keep_going) {
  constexpr int between = 16;  // rows
  Number* const a = matrix_.data();
  for (int k = 0; k < n_; ++k) {
    if (keep_going && k % between == between - 1 && !keep_going()) return false;
    int pivot = k;
    for (int i = k + 1; i < n_; ++i) {
      if (size(a[i * n_ + k]) > size(a[pivot * n_ + k])) pivot = i;
    }
    pivots_[k] = pivot;
    if (pivot != k) {
      for (int j = 0; j < n_; ++j) std::swap(a[k * n_ + j], a[pivot * n_ + j]);
    }
    // The diagonal is kept inverted.
    a[k * n_ + k] = inverse(a[k * n_ + k]);
    for (int i = k + 1; i < n_; ++i) {
      const Number share = product(a[i * n_ + k], a[k * n_ + k]);
      a[i * n_ + k] = share;
      if (size(share) == 0.0) continue;
      for (int j = k + 1; j < n_; ++j) subtract(a[i * n_ + j], share, a[k * n_ + j]);
    }
  }
  return true;
}

template <class Number>
void GaussianElimination<Number>::solve(Number* x) const {
  const Number* const a = matrix_.data();
  for (int k = 0; k < n_; ++k) {
    std::swap(x[k], x[pivots_[k]]);
  }
  for (int i = 1; i < n_; ++i) {
    for (int j = 0; j < i; ++j) subtract(x[i], a[i * n_ + j], x[j]);
  }
  for (int i = n_ - 1; i >= 0; --i) {
    for (int j = i + 1; j < n_; ++j) subtract(x[i], a[i * n_ + j], x[j]);
    x[i] = product(x[i], a[i * n_ + i]);
  }
}

template class GaussianElimination<double>;
template class GaussianElimination<Complex>;

}  // namespace pendcore
