/// \file
/// All eigenvalues and eigenvectors of a real matrix, from its real Schur form.
///
/// Its source is the only one that includes Eigen's solvers, whose templates take longer to compile
/// than the rest of a file, and it includes nothing else of the core: a change elsewhere leaves it
/// compiled.
#pragma once

#include <complex>
#include <Eigen/Core>

namespace pendcore {

// As in vector.hpp, memory is that of malloc: a program may bring other functions of Eigen that
// allocate and free what is aligned, and the linker keeps one of each.
using RealMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::DontAlign>;
using ComplexMatrix =
    Eigen::Matrix<std::complex<double>, Eigen::Dynamic, Eigen::Dynamic, Eigen::DontAlign>;
using ComplexVector = Eigen::Matrix<std::complex<double>, Eigen::Dynamic, 1, Eigen::DontAlign>;

struct Eigenpairs {
  ComplexVector values;
  ComplexMatrix vectors;  ///< a column for each value, not normalised
};

/// The eigenvalues and eigenvectors of a square matrix of finite numbers.
Eigenpairs eigenpairs(const RealMatrix& matrix);

}  // namespace pendcore
