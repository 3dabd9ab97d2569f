// The equations of the hard cases for Boost.odeint, by name, as y' = f(y, t).
#pragma once

#include <cmath>
#include <cstddef>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace hard_cases {

using Numbers = std::vector<double>;
using Rates = std::function<void(const Numbers& y, Numbers& f, double t)>;

// The rates of two rods of 1 kg and 1 m, with couples at the joints.
template <class State>
void textbook(const State& y, State& f, double first = 0, double second = 0) {
  constexpr double g = 9.807;
  const double d = y[0] - y[1], a12 = 0.5 * std::cos(d), h = 0.5 * std::sin(d);
  const double r1 = 1.5 * g * std::cos(y[0]) - h * y[3] * y[3] + first - second;
  const double r2 = 0.5 * g * std::cos(y[1]) + h * y[2] * y[2] + second;
  const double determinant = 4.0 / 9 - a12 * a12;
  f[0] = y[2];
  f[1] = y[3];
  f[2] = (r1 / 3 - a12 * r2) / determinant;
  f[3] = (4.0 / 3 * r2 - a12 * r1) / determinant;
}

// Two such rods with a mass at the tip, in angles from hanging.
inline void with_payload(const Numbers& y, Numbers& f, double p) {
  constexpr double g = 9.807;
  const double c = std::cos(y[0] - y[1]), s = std::sin(y[0] - y[1]), a = 0.5 + p;
  const double r1 = -(1.5 + p) * g * std::sin(y[0]) - a * s * y[3] * y[3];
  const double r2 = -a * g * std::sin(y[1]) + a * s * y[2] * y[2];
  const double determinant = 7.0 / 36 + 2 * p / 3 + a * a * s * s;
  f[0] = y[2];
  f[1] = y[3];
  f[2] = ((1.0 / 3 + p) * r1 - a * c * r2) / determinant;
  f[3] = ((4.0 / 3 + p) * r2 - a * c * r1) / determinant;
}

// n uniform links of 1 m and 1 kg in all. The mass matrix M = A cos(q_i - q_j) is dense, and is
// factorised by Cholesky.
class Chain {
 public:
  explicit Chain(std::size_t n)
      : n_(n), couplings_(n * n), moments_(n), matrix_(n * n), cosines_(n), sines_(n), forces_(n) {
    const double share = 1.0 / static_cast<double>(n);  // the mass of a link, and its length
    for (std::size_t i = 0; i < n; ++i)
      moments_[i] = share * share * (0.5 + static_cast<double>(n - 1 - i));
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < i; ++j) couplings_[i * n + j] = share * moments_[i];
      couplings_[i * n + i] = share * (moments_[i] - share * share / 6);
    }
  }

  void operator()(const Numbers& y, Numbers& f) {
    for (std::size_t i = 0; i < n_; ++i) {
      cosines_[i] = std::cos(y[i]);
      sines_[i] = std::sin(y[i]);
      forces_[i] = moments_[i] * 9.81 * cosines_[i];
    }
    for (std::size_t i = 0; i < n_; ++i)
      for (std::size_t j = 0; j <= i; ++j) {
        const double a = couplings_[i * n_ + j];
        const double h = a * (sines_[i] * cosines_[j] - cosines_[i] * sines_[j]);
        matrix_[i * n_ + j] = a * (cosines_[i] * cosines_[j] + sines_[i] * sines_[j]);
        forces_[i] -= h * y[n_ + j] * y[n_ + j];
        forces_[j] += h * y[n_ + i] * y[n_ + i];
      }
    solve();
    for (std::size_t i = 0; i < n_; ++i) {
      f[i] = y[n_ + i];
      f[n_ + i] = forces_[i];
    }
  }

 private:
  // The matrix is factored in place as L L', and the forces become the accelerations.
  void solve() {
    for (std::size_t i = 0; i < n_; ++i) {
      double* const row = &matrix_[i * n_];
      for (std::size_t j = 0; j <= i; ++j) {
        const double* const other = &matrix_[j * n_];
        double left = row[j];
        for (std::size_t k = 0; k < j; ++k) left -= row[k] * other[k];
        row[j] = i == j ? std::sqrt(left) : left / other[j];
      }
      for (std::size_t k = 0; k < i; ++k) forces_[i] -= row[k] * forces_[k];
      forces_[i] /= row[i];
    }
    for (std::size_t i = n_; i-- > 0;) {
      forces_[i] /= matrix_[i * n_ + i];
      for (std::size_t k = 0; k < i; ++k) forces_[k] -= matrix_[i * n_ + k] * forces_[i];
    }
  }

  std::size_t n_;
  Numbers couplings_, moments_, matrix_, cosines_, sines_, forces_;
};

// The rates of that name; p are its parameters.
inline Rates system(const std::string& name, const Numbers& p) {
  if (name == "textbook") return [](const Numbers& y, Numbers& f, double) { textbook(y, f); };
  if (name == "payload")
    return [=](const Numbers& y, Numbers& f, double) { with_payload(y, f, p[0]); };
  if (name == "chain")
    return [links = std::make_shared<Chain>(static_cast<std::size_t>(p[0]))](
               const Numbers& y, Numbers& f, double) { (*links)(y, f); };
  std::function<double(const Numbers&, double)> acceleration;  // of one rod
  if (name == "constant") acceleration = [=](const Numbers&, double) { return p[0]; };
  if (name == "square_root")
    acceleration = [](const Numbers& y, double) { return 0.0 * std::sqrt(0.5 - y[0]); };
  if (name == "cubic") acceleration = [](const Numbers& y, double) { return y[1] * y[1] * y[1]; };
  if (name == "pendulum")
    acceleration = [=](const Numbers& y, double) { return -1.5 * p[0] * std::sin(y[0]); };
  if (name == "shaken")  // gravity, amplitude and angular frequency of the pivot
    acceleration = [=](const Numbers& y, double t) {
      return 1.5 * (p[0] - p[1] * p[2] * p[2] * std::cos(p[2] * t)) * std::sin(y[0]);
    };
  if (!acceleration) throw std::invalid_argument("no such system: " + name);
  return [=](const Numbers& y, Numbers& f, double t) {
    f[0] = y[1];
    f[1] = acceleration(y, t);
  };
}

}  // namespace hard_cases
