/// \file
/// All eigenvalues and eigenvectors of a real matrix, from its real Schur form.
///
/// Its source is the only one that includes Eigen's solvers, whose templates take longer to compile
/// than the rest of a file, and it includes nothing else of the core: a change elsewhere leaves it
/// compiled. There, Eigen has another name, and nothing of Eigen crosses this header: a program may
/// bring the same templates, compiled for another -march, and the linker keeps one of each name.
#pragma once

#include <complex>
#include <vector>

namespace pendcore {

struct Eigenpairs {
  std::vector<std::complex<double>> values;   ///< (n)
  std::vector<std::complex<double>> vectors;  ///< (n, n), one after the other, not normalised
};

/// The eigenvalues and eigenvectors of an (n, n) row-major matrix of finite numbers.
Eigenpairs eigenpairs(const double* matrix, int n);

}  // namespace pendcore
