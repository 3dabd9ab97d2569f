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
#include <optional>
#include <string>
#include <vector>

#include "arithmetic/dual.hpp"
#include "dynamics/joint_forces.hpp"
#include "dynamics/row.hpp"
#include "effects/laws.hpp"
#include "pendcore/scene.hpp"
#include "pendcore/vector.hpp"

namespace pendcore {

/// A number, and its slopes along four parameters.
using AlongParameters = Dual<double, Pack<4>>;
inline constexpr std::size_t parameters_at_once = 4;

/// All numbers on which the torques depend, with each effect in a mode. A user's function is none
/// of them. `Number` is a double, or one with slopes along parameters.
template <class Number>
struct Mechanism {
  struct Body {
    Number mass{}, length{}, center{}, inertia{};
    Number armature{};  ///< of the rotor in the joint where the link begins, kg m^2
  };
  struct Wave {
    Number angular_frequency{}, phase{};
  };
  struct Acting {
    int place = 0;  ///< the joint or the link, from 0
    std::optional<CoupleOf<Number>> couple{};
    std::optional<LawOn<Number>> law{};
    bool moves_pivot = false;
    PivotLawOf<Number> pivot{};
    std::vector<Wave> waves{};
  };

  Number gravity{}, payload_mass{}, payload_inertia{};
  std::vector<Body> bodies{};
  std::vector<Acting> effects{};
};

/// The modes that a state calls for, of each effect.
std::vector<int> modes_at(const Scene& scene, double t, const double* q, const double* qd);

Mechanism<double> mechanism(const Scene& scene, const std::vector<int>& modes);

inline constexpr const char* corner_of_a_law =
    "a law has a corner at this value: there is no derivative by it; it has one at a slightly "
    "larger "
    "or smaller value";

/// The same with slopes along some parameters (pendcore/parameters.hpp), four in each mechanism,
/// from a time on. What other parameters of the list give stays as it is: the centre of a rod that
/// is named does not follow its length. Slopes are right to some 13 digits: the constants of laws
/// are smooth functions of parameters, whose differences are extrapolated. Throws
/// std::invalid_argument for a name that the scene does not have, and for a value at which a law
/// has a corner; with `corners`, which are told for each name, its slopes are NaN there.
std::vector<Mechanism<AlongParameters>> mechanisms_along(const Scene& scene,
                                                         const std::vector<int>& modes, double t,
                                                         bool forward,
                                                         const std::vector<std::string>& names,
                                                         std::vector<bool>* corners = nullptr);

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
