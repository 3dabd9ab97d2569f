#include "arithmetic/eigenvalues.hpp"

#include <Eigen/Eigenvalues>

namespace pendcore {

Eigenpairs eigenpairs(const RealMatrix& matrix) {
  const Eigen::EigenSolver<RealMatrix> solver(matrix);
  const RealMatrix& columns = solver.pseudoEigenvectors();
  Eigenpairs pairs{solver.eigenvalues(), columns.cast<std::complex<double>>()};
  for (Eigen::Index k = 0; k < matrix.cols(); ++k) {
    if (!(pairs.values[k].imag() > 0.0)) continue;
    // A conjugate pair has two columns: the real part of its vectors, and then the imaginary one.
    pairs.vectors.col(k).imag() = columns.col(k + 1);
    pairs.vectors.col(k + 1) = pairs.vectors.col(k).conjugate();
  }
  return pairs;
}

}  // namespace pendcore
