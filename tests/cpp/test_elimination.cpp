// Gaussian elimination: the solution solves the system, whatever rows have to be exchanged.
#include <doctest/doctest.h>

#include <cmath>
#include <complex>
#include <random>
#include <vector>

#include "integrate/radau/gaussian_elimination.hpp"

using namespace pendcore;

TEST_CASE("real systems of any size are solved, also with zeros on the diagonal") {
  std::mt19937_64 random(11);
  std::uniform_real_distribution any(-1.0, 1.0);
  for (int n = 1; n < 12; ++n) {
    std::vector<double> matrix(n * n);
    for (int k = 0; k < n * n; ++k) matrix[k] = any(random);
    if (n > 1) {
      for (int k = 0; k < n; ++k) matrix[k * n + k] = 0.0;
    }
    std::vector<double> factors = matrix;
    std::vector<int> pivots(n);
    CHECK(factor(n, factors.data(), pivots.data(), {}));
    std::vector<double> exact(n);
    std::vector<double> x(n, 0.0);
    for (double& one : exact) one = any(random);
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) x[i] += matrix[i * n + j] * exact[j];
    }
    solve_factored(n, factors.data(), pivots.data(), x.data());
    for (int i = 0; i < n; ++i) CHECK(std::abs(x[i] - exact[i]) < 1e-12);
  }
}

TEST_CASE("complex systems agree with the library's complex numbers") {
  std::mt19937_64 random(12);
  std::uniform_real_distribution any(-1.0, 1.0);
  for (int n = 1; n < 12; ++n) {
    std::vector<Complex> factors(n * n);
    std::vector<int> pivots(n);
    std::vector<std::complex<double>> matrix(n * n);
    std::vector<std::complex<double>> exact(n);
    std::vector<Complex> x(n);
    for (auto& one : matrix) one = {any(random), any(random)};
    for (auto& one : exact) one = {any(random), any(random)};
    for (int i = 0; i < n; ++i) {
      std::complex<double> sum = 0.0;
      for (int j = 0; j < n; ++j) {
        factors[i * n + j] = {matrix[i * n + j].real(), matrix[i * n + j].imag()};
        sum += matrix[i * n + j] * exact[j];
      }
      x[i] = {sum.real(), sum.imag()};
    }
    CHECK(factor(n, factors.data(), pivots.data(), {}));
    solve_factored(n, factors.data(), pivots.data(), x.data());
    for (int i = 0; i < n; ++i) {
      CHECK(std::abs(std::complex(x[i].re, x[i].im) - exact[i]) < 1e-12);
    }
  }
}

TEST_CASE("an elimination that is told not to go on ends early") {
  constexpr int n = 200;
  std::vector<double> matrix(n * n);
  std::vector<int> pivots(n);
  for (int k = 0; k < n; ++k) matrix[k * n + k] = 1.0;
  int asked = 0;
  CHECK(!factor(n, matrix.data(), pivots.data(), [&] { return ++asked < 3; }));
  CHECK(asked == 3);
  CHECK(factor(n, matrix.data(), pivots.data(), [] { return true; }));
}
