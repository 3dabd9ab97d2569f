#include "arithmetic/eigenvalues.hpp"

#define Eigen pendcore_eigen  // NOLINT: the header says why
#include <Eigen/Eigenvalues>

namespace pendcore {

Eigenpairs eigenpairs(const double* matrix, int n) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(Eigen::Map<const RowMajor>(matrix, n, n));
  const Eigen::MatrixXd& columns = solver.pseudoEigenvectors();
  Eigen::MatrixXcd vectors = columns.cast<std::complex<double>>();
  for (Eigen::Index k = 0; k < n; ++k) {
    if (!(solver.eigenvalues()[k].imag() > 0.0)) continue;
    // A conjugate pair has two columns: the real part of its vectors, and then the imaginary one.
    vectors.col(k).imag() = columns.col(k + 1);
    vectors.col(k + 1) = vectors.col(k).conjugate();
  }
  return {.values = {solver.eigenvalues().begin(), solver.eigenvalues().end()},
          .vectors = {vectors.data(), vectors.data() + vectors.size()}};
}

}  // namespace pendcore
