/// \file
/// The equations of motion of a scene at a state, and what follows from them.
///
///     M(q) qdd + h(q, qd, t) = Q + J^T tau    accelerations, mass_matrix, inverse_dynamics
///     d qdd / d q,  d qdd / d qd              jacobian
///     dx/dt = drift + A (x - x_0) + B u       linearize, x = (q, qd)
///     F_{i-1,i} = m_i (a_{C_i} - g e_y) - F_ext,i + F_{i,i+1},   F_{n,n+1} = m_p (a_tip - g e_y)
///
/// q (rad), qd (rad/s) and qdd (rad/s^2) are (n); t is in s. tau_j (N m) acts on link j, and -tau_j
/// on the link before: (J^T tau)_i = tau_i - tau_{i+1}. F_{i-1,i} is the force ON link i FROM
/// link i-1 at joint i, N: row 1 is the textbook's F_01 (from the ground), row 2 is F_12 = -F_21
/// (Eq. (2.3), y downward: the weight is +m g e_y).
///
/// Effects are put in the modes that the state calls for, and joints at rest are held where
/// friction and stops can hold them. Throws std::invalid_argument for a vector of another size, and
/// what a user's function throws.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "pendcore/scene.hpp"
#include "pendcore/vector.hpp"

namespace pendcore {

struct Derivatives {
  Matrix by_q;   ///< d qdd_i / d q_j, 1/s^2, (n, n)
  Matrix by_qd;  ///< d qdd_i / d qd_j, 1/s, (n, n)
};

/// What drives the motion from outside, beside what the scene's own effects do: a torque in a
/// joint, N m; an acceleration of the pivot, m/s^2; or a change of a parameter of the scene.
struct Input {
  enum class Kind : signed char { torque, pivot_x, pivot_y, parameter };
  Kind kind = Kind::torque;
  int joint = 0;            ///< of a torque, counted from 1
  std::string parameter{};  ///< "effect[1].damping" (parameters.hpp)
};

/// The motion close to a state x_0 = (q, qd), at one time: dx/dt = drift + A (x - x_0) + B u.
struct Linearization {
  Vector drift;  ///< dx/dt at the state, (2n)
  Matrix A;      ///< (2n, 2n)
  Matrix B;      ///< (2n, k), a column for each input
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
  /// differences (ten digits). Cost: 2n right-hand sides, each two to three times as expensive; of
  /// three links and more, four or eight of them together cost three times as much as one.
  Derivatives jacobian(double t, const Numbers& q, const Numbers& qd);

  /// The motion close to a state, exact to rounding where jacobian() is. A joint that a Lock holds
  /// takes no torque. Throws std::invalid_argument where the motion has no derivative: at a stop,
  /// in a joint at rest under dry friction, and where two laws of an effect meet; the message says
  /// from which side there is one. Cost: jacobian(), and half as much for n torques.
  Linearization linearize(double t, const Numbers& q, const Numbers& qd,
                          const std::vector<Input>& inputs);

  /// The torques tau (n) in the joints that give the accelerations qdd, beside what the effects do.
  /// No Lock or stop pushes, and a joint at rest has no dry friction. Cost: O(n).
  Vector inverse_dynamics(double t, const Numbers& q, const Numbers& qd, const Numbers& qdd);

  /// The torques in these joints, counted from 1, that hold the angles q at rest, in their order.
  /// Throws std::invalid_argument if another joint does not rest, by its locks, stops and friction.
  Vector trim(double t, const Numbers& q, const std::vector<int>& joints);

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
