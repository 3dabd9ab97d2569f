/// \file
/// Torques or impulses in some of the joints, that hold only so far, and what they do to the chain.
///
/// With phidd = J qdd of those joints, W = J M^-1 J^T makes one problem of them all
/// (complementarity.hpp). Cost: O(n^3).
#pragma once

#include <vector>

#include "pendcore/dynamics/contact/complementarity.hpp"
#include "pendcore/dynamics/inertia.hpp"

namespace pendcore {

struct JointForces {
  Inertia inertia;
  std::vector<int> joints;           ///< that are in the problem, in ascending order, from 0
  ForcesBetweenBounds problem;       ///< a row for each of them
  std::vector<double> mass;          ///< M, (n, n), row-major
  std::vector<double> sine, cosine;  ///< of the angles that M was computed from, (n)

  explicit JointForces(const Scene& scene) : inertia(scene) {}

  void set_mass_matrix(const double* q);
  /// W of `joints`, from M; a and the bounds of the problem are left to be filled in.
  void set_up();
  /// Adds M^-1 J^T lambda, (n).
  void add_response(double* x) const;

 private:
  std::vector<double> factor_;    ///< M = L D L^T
  std::vector<double> response_;  ///< L^-1 J^T, a row for each joint
};

}  // namespace pendcore
