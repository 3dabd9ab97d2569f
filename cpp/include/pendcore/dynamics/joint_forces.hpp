/// \file
/// Torques or impulses in some of the joints, each between bounds, and how the chain responds to
/// them.
///
/// With phidd = J qdd in these joints, W = J M^-1 J^T gives one problem for all of them
/// (complementarity.hpp). Cost: O(n^3).
#pragma once

#include <vector>

#include "pendcore/dynamics/contact/complementarity.hpp"
#include "pendcore/dynamics/inertia.hpp"

namespace pendcore {

struct JointForces {
  Inertia inertia;
  std::vector<int> joints;           ///< the joints in the problem, ascending, from 0
  ForcesBetweenBounds problem;       ///< it has a row for each of these joints
  std::vector<double> mass;          ///< M, (n, n), row-major
  std::vector<double> sine, cosine;  ///< functions of the angles of M, (n)

  explicit JointForces(const Scene& scene) : inertia(scene) {}

  void set_mass_matrix(const double* q);
  /// Computes W for `joints` from M. The caller fills in a and the bounds of the problem.
  void set_up();
  /// Adds M^-1 J^T lambda to x, (n).
  void add_response(double* x) const;

 private:
  std::vector<double> factor_;    ///< M = L D L^T
  std::vector<double> response_;  ///< L^-1 J^T, a row for each joint
};

}  // namespace pendcore
