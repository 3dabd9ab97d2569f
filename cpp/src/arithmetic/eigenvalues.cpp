#include "arithmetic/eigenvalues.hpp"

#include <Eigen/Eigenvalues>

namespace pendcore {

Eigenpairs eigenpairs(const std::vector<double>& matrix, int n) {
  Eigen::MatrixXd whole(n, n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) whole(i, j) = matrix[i * n + j];
  }
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(whole);
  const double* const columns = solver.pseudoEigenvectors().data();
  Eigenpairs pairs;
  for (int k = 0; k < n; ++k) {
    const std::complex<double> value = solver.eigenvalues().data()[k];
    // A conjugate pair has two columns: the real part of its vectors, and then the imaginary one.
    const bool is_first = value.imag() > 0.0;
    const bool is_second = value.imag() < 0.0;
    const double* const real = columns + (is_second ? k - 1 : k) * n;
    for (int i = 0; i < n; ++i) {
      const double imaginary = is_first || is_second ? real[n + i] : 0.0;
      pairs.vectors.emplace_back(real[i], is_second ? -imaginary : imaginary);
    }
    pairs.values.push_back(value);
  }
  return pairs;
}

}  // namespace pendcore
