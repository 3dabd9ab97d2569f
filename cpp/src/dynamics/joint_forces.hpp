/// \file
/// Torques or impulses in some of the joints, each between bounds, and how the chain responds to
/// them.
///
/// With phidd = J qdd in these joints, W = J M^-1 J^T gives one problem for all of them
/// (complementarity.hpp). Links whose joint is rigid are one body: M is then the mass matrix of the
/// bodies, the sum of the entries of their links. Cost: O(n^3).
#pragma once

#include <vector>

#include "dynamics/contact/complementarity.hpp"
#include "dynamics/inertia.hpp"

namespace pendcore {

struct JointForces {
  std::vector<Link> links;
  Inertia inertia;
  std::vector<int> joints;           ///< the joints in the problem, ascending, from 0
  ForcesBetweenBounds problem;       ///< it has a row for each of these joints
  Matrix mass;                       ///< M of all links, (n, n)
  std::vector<double> sine, cosine;  ///< functions of the angles of M, (n)

  explicit JointForces(const Scene& scene) : JointForces(scene, std::vector<bool>()) {}
  /// `rigid` says of each joint whether it never turns; if it is empty, all joints do.
  JointForces(const Scene& scene, const std::vector<bool>& rigid);

  /// On every joint that turns, where `held` ones are rigid.
  static JointForces on_free_joints(const Scene& scene, const std::vector<bool>& held);

  /// M_ij = A_ij cos(q_i - q_j), and the rotors (inertia.hpp). Cost: O(n^2).
  void set_mass_matrix(const double* q);
  /// Factors M, for respond() alone.
  void factor_mass();
  /// M^-1 J^T lambda, (n), of torques in `joints`; no memory is taken.
  void respond(const double* lambda, double* change);
  /// Computes W for `joints`, of which none is rigid, from M. The caller fills in a and the bounds
  /// of the problem.
  void set_up();
  /// M^-1 J^T lambda, (n).
  Vector response() const { return response(problem.lambda); }
  Vector response(const Vector& lambda) const;
  /// x = M^-1 J^T lambda, (n). Refines lambda and x until J x + a = 0 in the joints between their
  /// bounds and M x = J^T lambda, both to the rounding of x. What W and the factors of M alone give
  /// loses as many digits as the condition of M has.
  Vector refined_response();

 private:
  int body_before(int joint) const { return joint > 0 ? body_[joint - 1] : -1; }
  Vector of_links(const Vector& bodies) const;  ///< what the body of each link has, 0 on the ground

  int bodies_ = 0;
  std::vector<int> body_;  ///< of each link, from 0; -1 for the ground
  Matrix factor_;          ///< M = L D L^T of the bodies
  Matrix response_;        ///< L^-1 J^T, a row for each joint
  Vector bodies_change_;
};

}  // namespace pendcore
