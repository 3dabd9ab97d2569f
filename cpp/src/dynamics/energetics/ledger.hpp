/// \file
/// The ledger: where the energy of a chain goes,
///
///     [T + V](t) - [T + V](0) = W_motor + W_drive + W_wind + W_user
///                               - D_viscous - D_dry - D_drag - D_impact
///
/// A run that keeps the ledger integrates these terms as quadratures beside the state. Their rates
/// are the powers of the laws: tau_j phid_j, M_i qd_i, F_i . v_i, and F_01 . v_0 of a driven pivot.
/// The losses in impacts (held_joints.hpp), and the work of the drive in them, are added at the
/// impacts. Cost: one more evaluation of the laws, and their powers. The loss of a rod to the air
/// is the integral of k |w|^3; the rest of the power of its drag is the wind's.
#pragma once

#include "dynamics/equations_of_motion.hpp"
#include "dynamics/row.hpp"

namespace pendcore {

/// The accounts that the effects of a scene have, in the order of the enumeration.
std::vector<Account> accounts_of(const Scene& scene);

/// The arrays over the links in which laws see a state. fill() takes one state after the other.
class LinkMemory {
 public:
  explicit LinkMemory(const Scene& scene);
  void fill(const EffectsOfRun& effects, double t, const double* q, const double* qd);
  /// Index 0 is link 1.
  LinkArrays arrays() const { return {&q[1], &qd[1], &s[1], &c[1], &length[1], &vx[1], &vy[1]}; }

  std::vector<double> q, qd, s, c, length, vx, vy;  ///< link i at index i, zeros before and after

 private:
  int n_;
};

/// Computes the power (W) on each of accounts_of(scene) from the time (s), the angles (rad), rates
/// (rad/s) and accelerations (rad/s^2), (n) each. An object belongs to one thread; powers()
/// allocates nothing.
class Ledger {
 public:
  Ledger(const Scene& scene, std::shared_ptr<EffectsOfRun> effects);
  void powers(double t, const double* q, const double* qd, const double* qdd, double* result);

 private:
  using Powers = std::array<double, account_names.size()>;
  void add_laws(double t, Powers& power);
  void add_couples(double t, Powers& power) const;
  void add_users(double t, const double* q, const double* qd, Powers& power);
  void add_drive(double t, const double* qdd, Powers& power) const;

  Scene scene_;
  std::shared_ptr<EffectsOfRun> effects_;
  std::vector<Account> accounts_;
  LinkMemory links_;
  double force_x_ = 0.0;  ///< the sum of the laws' forces on all links
  double force_y_ = 0.0;
  std::vector<double> user_forces_;
};

}  // namespace pendcore
