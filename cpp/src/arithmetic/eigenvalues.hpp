/// \file
/// All eigenvalues and eigenvectors of a real matrix, from its real Schur form.
///
/// Its source is the only one that includes Eigen, whose templates take longer to compile than the
/// rest of a file, and it includes nothing else of the core: a change elsewhere leaves it compiled.
#pragma once

#include <complex>
#include <vector>

namespace pendcore {

struct Eigenpairs {
  std::vector<std::complex<double>> values;
  std::vector<std::complex<double>> vectors;  ///< n numbers for each value, not normalised
};

/// The eigenvalues and eigenvectors of an n x n matrix of finite numbers, given row by row.
Eigenpairs eigenpairs(const std::vector<double>& matrix, int n);

}  // namespace pendcore
