#include "pendcore/integrate/radau/newton_systems.hpp"

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

bool NewtonSystems::factor(const Collocation& method, double h,
                           const std::function<bool()>& keep_going) {
  g_ = method.real / h;
  h_ = h / method.real;
  complex_g_ = {method.alpha / h, method.beta / h};
  const double scale = h / (method.alpha * method.alpha + method.beta * method.beta);
  complex_h_ = {method.alpha * scale, -method.beta * scale};
  const double re = complex_h_.re;
  const double im = complex_h_.im;
  const Complex square{re * re - im * im, 2.0 * re * im};
  double* const real = real_.matrix();
  Complex* const complex = complex_.matrix();
  for (int k = 0; k < n_ * n_; ++k) {
    real[k] = -h_ * (by_qd_[k] + h_ * by_q_[k]);
    complex[k] = {-re * by_qd_[k] - square.re * by_q_[k], -im * by_qd_[k] - square.im * by_q_[k]};
  }
  for (int k = 0; k < n_ * n_; k += n_ + 1) {
    real[k] += 1.0;
    complex[k].re += 1.0;
  }
  return real_.factor(keep_going) && complex_.factor(keep_going);
}

void NewtonSystems::solve_real(double* x) {
  double* const s = x + n_;
  for (int i = 0; i < n_; ++i) {
    double sum = 0.0;
    for (int j = 0; j < n_; ++j) sum += by_q_[i * n_ + j] * x[j];
    real_side_[i] = h_ * (s[i] + h_ * sum);
  }
  real_.solve(real_side_.data());
  for (int i = 0; i < n_; ++i) {
    s[i] = real_side_[i];
    x[i] = h_ * (x[i] + s[i]);
  }
}

void NewtonSystems::solve_complex(double* re, double* im) {
  const Complex h = complex_h_;
  auto times_h = [h](double x, double y) {
    return Complex{h.re * x - h.im * y, h.re * y + h.im * x};
  };
  for (int i = 0; i < n_; ++i) {
    double of_re = 0.0;
    double of_im = 0.0;
    for (int j = 0; j < n_; ++j) {
      of_re += by_q_[i * n_ + j] * re[j];
      of_im += by_q_[i * n_ + j] * im[j];
    }
    const Complex moved = times_h(of_re, of_im);
    complex_side_[i] = times_h(re[n_ + i] + moved.re, im[n_ + i] + moved.im);
  }
  complex_.solve(complex_side_.data());
  for (int i = 0; i < n_; ++i) {
    const Complex y = complex_side_[i];
    const Complex x = times_h(re[i] + y.re, im[i] + y.im);
    re[n_ + i] = y.re;
    im[n_ + i] = y.im;
    re[i] = x.re;
    im[i] = x.im;
  }
}

}  // namespace pendcore
