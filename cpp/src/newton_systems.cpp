#include "pendcore/integrate/newton_systems.hpp"

namespace pendcore {

void NewtonSystems::resize(int n) {
  n_ = n;
  by_q_.resize(static_cast<std::size_t>(n) * n);
  by_qd_.resize(by_q_.size());
  real_.resize(n);
  complex_.resize(n);
  real_side_.resize(n);
  complex_side_.resize(n);
}

void NewtonSystems::factor(const Collocation& method, double h) {
  g_ = method.real / h;
  complex_g_ = {method.alpha / h, method.beta / h};
  const double re = complex_g_.re;
  const double im = complex_g_.im;
  double* const real = real_.matrix();
  Complex* const complex = complex_.matrix();
  for (int k = 0; k < n_ * n_; ++k) {
    real[k] = -g_ * by_qd_[k] - by_q_[k];
    complex[k] = {-re * by_qd_[k] - by_q_[k], -im * by_qd_[k]};
  }
  for (int k = 0; k < n_ * n_; k += n_ + 1) {
    real[k] += g_ * g_;
    complex[k].re += re * re - im * im;
    complex[k].im += 2.0 * re * im;
  }
  real_.factor();
  complex_.factor();
}

void NewtonSystems::solve_real(double* x) {
  double* const s = x + n_;
  for (int i = 0; i < n_; ++i) {
    double sum = g_ * s[i];
    for (int j = 0; j < n_; ++j) sum += by_q_[i * n_ + j] * x[j];
    real_side_[i] = sum;
  }
  real_.solve(real_side_.data());
  for (int i = 0; i < n_; ++i) {
    s[i] = real_side_[i];
    x[i] = (x[i] + s[i]) / g_;
  }
}

void NewtonSystems::solve_complex(double* re, double* im) {
  const Complex g = complex_g_;
  for (int i = 0; i < n_; ++i) {
    Complex sum{g.re * re[n_ + i] - g.im * im[n_ + i], g.re * im[n_ + i] + g.im * re[n_ + i]};
    for (int j = 0; j < n_; ++j) {
      sum.re += by_q_[i * n_ + j] * re[j];
      sum.im += by_q_[i * n_ + j] * im[j];
    }
    complex_side_[i] = sum;
  }
  complex_.solve(complex_side_.data());
  const double scale = 1.0 / (g.re * g.re + g.im * g.im);
  for (int i = 0; i < n_; ++i) {
    const Complex y = complex_side_[i];
    const double a = re[i] + y.re;
    const double b = im[i] + y.im;
    re[n_ + i] = y.re;
    im[n_ + i] = y.im;
    re[i] = (a * g.re + b * g.im) * scale;
    im[i] = (b * g.re - a * g.im) * scale;
  }
}

}  // namespace pendcore
