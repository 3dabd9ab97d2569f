/// \file
/// The torques that a motion takes, by the equations of Newton and Euler from the tip to the pivot,
/// and how they change with a parameter of the scene.
///
///     F_{i-1,i} = m_i (a_{C_i} - g e_y) - F_ext,i + F_{i,i+1},   F_{n,n+1} = m_p (a_tip - g e_y)
///     tau_i     = I_i qdd_i + m_i c_i u_i x (a_{C_i} - g e_y) + L_i u_i x F_{i,i+1} - M_ext,i
///                 + tau_{i+1}
///
/// (Eqs. (2.3) and (2.4), y downward). F_ext and M_ext are the force of the effects on a link and
/// its moment about the joint where the link begins; what rotors take and couples give is added to
/// tau. On numbers that are dual along a parameter p, four parameters at a time, they give
/// d tau/d p of the same motion, and thereby d qdd/d p = -M^-1 J^T d tau/d p.
#pragma once

#include <array>
#include <vector>

#include "dynamics/joint_forces.hpp"
#include "dynamics/mechanism.hpp"
#include "dynamics/row.hpp"

namespace pendcore {

/// What laws see of one link or joint (effects/laws.hpp).
template <class Number>
struct LinkAt {
  using Value = Number;
  double t;
  Number q, qd, s, c, L;
  Number angle, rate;               ///< of the joint
  Number vx_of_joint, vy_of_joint;  ///< m/s

  const Number& phi() const { return angle; }
  const Number& phid() const { return rate; }
  const Number& length() const { return L; }
  const Number& vx() const { return vx_of_joint; }
  const Number& vy() const { return vy_of_joint; }
};

/// A vector in the plane.
template <class Number>
struct Planar {
  Number x{}, y{};
};

/// The torques of a motion, and memory for them: an object belongs to one thread.
template <class Number>
class InverseDynamics {
 public:
  /// Computes what a motion takes, from its angles (rad), rates (rad/s) and accelerations
  /// (rad/s^2), (n) each. Cost: O(n).
  void compute(const Mechanism<Number>& mechanism, double t, const Numbers& q, const Numbers& qd,
               const Numbers& qdd);

  const std::vector<Number>& torques() const { return torques_; }        ///< tau, N m, (n)
  const std::vector<Planar<Number>>& forces() const { return forces_; }  ///< F_{i-1,i}, N, (n)

 private:
  static void go_out_and_back(InverseDynamics* self, const Mechanism<Number>* mechanism, double t,
                              const double* q, const double* qd, const double* qdd);

  struct Waves {
    std::array<Number, 2> sine{}, cosine{};
  };
  std::vector<double> sine_, cosine_;
  std::vector<Waves> waves_;  ///< of each effect
  std::vector<LinkAt<Number>> at_;
  std::vector<Planar<Number>> inertial_;  ///< m (a_C - g e_y)
  std::vector<RowLoads<Number>> loads_;
  std::vector<Number> torques_;
  std::vector<Planar<Number>> forces_;
};

/// The changes of qdd with each of some parameters, and memory for them.
class ChangesOfAccelerations {
 public:
  /// Writes -M^-1 J^T d tau/d p into the first columns of `changes`, (n, parameters), where
  /// `forces`, with the factors of the mass matrix of q, say how the free joints respond.
  void compute(const std::vector<Mechanism<AlongParameters>>& mechanisms, double t,
               const Numbers& q, const Numbers& qd, const Numbers& qdd, JointForces& forces,
               Eigen::Ref<Matrix> changes);

 private:
  InverseDynamics<AlongParameters> motion_;
  std::vector<double> torques_;
  Vector change_;
};

}  // namespace pendcore
