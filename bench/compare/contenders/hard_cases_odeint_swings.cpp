// Boost.odeint on oscillations: a heavy payload, a chain, a long run, a shaken pivot.
#include <array>
#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <cstddef>
#include <functional>
#include <vector>

#include "hard_cases_odeint.hpp"

namespace hard_cases {
namespace {

namespace ode = boost::numeric::odeint;

using Two = std::array<double, 2>;
using Four = std::array<double, 4>;

template <class State>
auto controlled_fehlberg78(double atol, double rtol) {
  return ode::make_controlled(atol, rtol, ode::runge_kutta_fehlberg78<State>());
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

  void operator()(const Numbers& y, Numbers& f, double /*t*/) {
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

}  // namespace

// Numbers: the payload, the start's angles from hanging, the end.
void payload(const Numbers& numbers) {
  const double p = numbers[0], g = 9.807;
  const auto rates = [=](const Four& y, Four& f, double) {
    const double c = std::cos(y[0] - y[1]), s = std::sin(y[0] - y[1]), a = 0.5 + p;
    const double r1 = -(1.5 + p) * g * std::sin(y[0]) - a * s * y[3] * y[3];
    const double r2 = -a * g * std::sin(y[1]) + a * s * y[2] * y[2];
    const double determinant = 7.0 / 36 + 2 * p / 3 + a * a * s * s;
    f = {y[2], y[3], ((1.0 / 3 + p) * r1 - a * c * r2) / determinant,
         ((4.0 / 3 + p) * r2 - a * c * r1) / determinant};
  };
  Four y{numbers[1], numbers[2], 0, 0};
  const auto steps = ode::integrate_adaptive(controlled_fehlberg78<Four>(1e-15, 1e-12), rates, y,
                                             0.0, numbers[3], 1e-5);
  tell("q", {y[0], y[1]});
  tell("steps", {static_cast<double>(steps)});
}

// Numbers: the links, the end.
void chain(const Numbers& numbers) {
  const auto n = static_cast<std::size_t>(numbers[0]);
  Chain links(n);
  Numbers y(2 * n, 0.0);
  const auto steps = ode::integrate_adaptive(controlled_fehlberg78<Numbers>(1e-12, 1e-9),
                                             std::ref(links), y, 0.0, numbers[1], 1e-4);
  tell("q", {y.begin(), y.begin() + static_cast<std::ptrdiff_t>(n)});
  tell("steps", {static_cast<double>(steps)});
}

// Numbers: 5 or 8 for the order, the tolerances, the start's angles, the times at which to print
// the states.
void drift(const Numbers& numbers) {
  const auto rates = [](const Four& x, Four& f, double) { textbook(x, f); };
  const std::vector<double> times(numbers.begin() + 5, numbers.end());
  Four y{numbers[3], numbers[4], 0, 0};
  Numbers states;
  const auto kept = [&](const Four& x, double) { states.insert(states.end(), x.begin(), x.end()); };
  if (numbers[0] == 5)
    ode::integrate_times(controlled_dopri5<Four>(numbers[2], numbers[1]), rates, y, times.begin(),
                         times.end(), 1e-3, kept);
  else
    ode::integrate_times(controlled_fehlberg78<Four>(numbers[2], numbers[1]), rates, y,
                         times.begin(), times.end(), 1e-3, kept);
  tell("states", states);
}

// Numbers: the amplitude and the angular frequency of the pivot, the angle from upright.
void shaken(const Numbers& numbers) {
  const double eps = numbers[0], w = numbers[1], g = 9.807;
  Two y{numbers[2], 0};
  ode::integrate_adaptive(
      controlled_dopri5<Two>(1e-17, 1e-12),
      [=](const Two& x, Two& f, double t) {
        f = {x[1], 1.5 * (g - eps * w * w * std::cos(w * t)) * std::sin(x[0])};
      },
      y, 0.0, 2 * 3.14159265358979323846 / w, 1e-3);
  tell("q", {y[0]});
}

}  // namespace hard_cases
