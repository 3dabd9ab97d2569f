/// \file
/// All eigenvalues and eigenvectors of a real matrix, from its real Schur form.
///
/// Its source is the only one that includes Eigen's solvers, whose templates take longer to compile
/// than the rest of a file, and it includes nothing else of the core: a change elsewhere leaves it
/// compiled.
#pragma once

#include <Eigen/Core>

namespace pendcore {

struct Eigenpairs {
  Eigen::VectorXcd values;
  Eigen::MatrixXcd vectors;  ///< a column for each value, not normalised
};

/// The eigenvalues and eigenvectors of a square matrix of finite numbers.
Eigenpairs eigenpairs(const Eigen::MatrixXd& matrix);

}  // namespace pendcore
