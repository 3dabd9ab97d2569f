/// \file
/// The ledger: where the energy of a chain goes,
///
///     [T + V](t) - [T + V](0) = W_motor + W_drive + W_wind + W_user
///                               - D_viscous - D_dry - D_drag - D_impact
///
/// A run that keeps it carries the shares as quadratures beside the state: their rates are the
/// powers of the laws, tau_j phid_j, M_i qd_i, F_i . v_i, and F_01 . v_0 of a driven pivot. What
/// impacts take is added where they are (held_joints.hpp), as is what the drive does in them.
/// Cost: the laws once more, and their powers. What a rod loses to the air is the integral of
/// k |w|^3; the rest of its power is the wind's.
#pragma once

#include <span>

#include "pendcore/dynamics/equations_of_motion.hpp"
#include "pendcore/dynamics/row.hpp"

namespace pendcore {

/// The accounts of a scene, in the order of the enumeration: those of the effects that it has.
std::vector<Account> accounts_of(const Scene& scene);

/// The links of a chain as laws see them, of one state after the other.
class LinkMemory {
 public:
  explicit LinkMemory(const Scene& scene);
  void fill(const EffectsInForce& effects, double t, const double* q, const double* qd);
  /// Place 0 is link 1.
  LinkArrays arrays() const { return {&q[1], &qd[1], &s[1], &c[1], &length[1], &vx[1], &vy[1]}; }

  std::vector<double> q, qd, s, c, length, vx, vy;  ///< link i at place i, zeros around them

 private:
  int n_;
};

/// Power (W) booked on each of accounts_of(scene), from the time (s), the angles (rad), rates
/// (rad/s) and accelerations (rad/s^2), (n) each. Belongs to one thread; allocates nothing.
class Ledger {
 public:
  Ledger(const Scene& scene, std::shared_ptr<EffectsInForce> effects);
  std::size_t size() const { return accounts_.size(); }
  void powers(double t, const double* q, const double* qd, const double* qdd, double* result);

 private:
  using Powers = std::array<double, account_names.size()>;
  void add_laws(double t, Powers& power);
  void add_couples(double t, Powers& power) const;
  void add_users(double t, const double* q, const double* qd, Powers& power);
  void add_drive(double t, const double* qdd, Powers& power) const;

  Scene scene_;
  std::shared_ptr<EffectsInForce> effects_;
  std::vector<Account> accounts_;
  LinkMemory links_;
  double force_x_ = 0.0;  ///< of the laws on all links
  double force_y_ = 0.0;
  std::vector<double> user_forces_;
};

/// Forces of the effects on the links, N, (n, 2); zero where none acts along a link.
void effect_forces(const Scene& scene, const EffectsInForce& effects, double t, const double* q,
                   const double* qd, std::span<double> forces);

}  // namespace pendcore
