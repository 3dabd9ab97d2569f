/// \file
/// The equations of motion of a scene at a state, and what follows from them.
///
///     M(q) qdd + h(q, qd, t) = Q          accelerations, mass_matrix
///     d qdd / d q,  d qdd / d qd          jacobian
///     F_{i-1,i} = m_i (a_{C_i} - g e_y) - F_ext,i + F_{i,i+1},   F_{n,n+1} = m_p (a_tip - g e_y)
///
/// q (rad), qd (rad/s) and qdd (rad/s^2) are (n); t is in s. F_{i-1,i} is the force ON link i FROM
/// link i-1 at joint i, N: row 1 is the textbook's F_01 (from the ground), row 2 is F_12 = -F_21
/// (Eq. (2.3), y downward: the weight is +m g e_y).
///
/// Effects are put in the modes that the state calls for, and joints at rest are held where
/// friction and stops can hold them. Throws std::invalid_argument for a vector of another size, and
/// what a user's function throws.
#pragma once

#include <memory>

#include "pendcore/scene.hpp"
#include "pendcore/vector.hpp"

namespace pendcore {

struct Derivatives {
  Matrix by_q;   ///< d qdd_i / d q_j, 1/s^2, (n, n)
  Matrix by_qd;  ///< d qdd_i / d qd_j, 1/s, (n, n)
};

/// The equations of a scene, compiled once for any number of states. An object serves one thread at
/// a time.
class Equations {
 public:
  /// Throws std::invalid_argument for a scene that check() refuses.
  explicit Equations(const Scene& scene);
  ~Equations();
  Equations(Equations&& other) noexcept;
  Equations& operator=(Equations&& other) noexcept;

  /// qdd, (n), with the same bits as in a run. Cost: a right-hand side, and a decision of what is
  /// held where the scene has friction or stops.
  Vector accelerations(double t, const Numbers& q, const Numbers& qd);
  /// The same, written to `qdd`: nothing is allocated but where something may be held.
  void accelerations(double t, const Numbers& q, const Numbers& qd, Eigen::Ref<Vector> qdd);

  /// Exact to rounding, but for the part of a user's function, which is differentiated by central
  /// differences (ten digits). Cost: 2n right-hand sides, each two to three times as expensive.
  Derivatives jacobian(double t, const Numbers& q, const Numbers& qd);

  /// F_{i-1,i}, (n, 2). Cost: a right-hand side and O(n).
  Points reactions(double t, const Numbers& q, const Numbers& qd);

  /// M, (n, n), kg m^2, with the rotors and the payload. Cost: O(n^2).
  Matrix mass_matrix(const Numbers& q);

 private:
  struct Compiled;
  std::unique_ptr<Compiled> compiled_;
};

/// The same for a single state.
Vector accelerations(const Scene& scene, double t, const Numbers& q, const Numbers& qd);
Derivatives jacobian(const Scene& scene, double t, const Numbers& q, const Numbers& qd);
Points reactions(const Scene& scene, double t, const Numbers& q, const Numbers& qd);
Matrix mass_matrix(const Scene& scene, const Numbers& q);

}  // namespace pendcore
