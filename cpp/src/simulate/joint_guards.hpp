/// \file
/// The guards of a run, as the modes of the effects and the holds of the joints call for them.
#pragma once

#include <vector>

#include "dynamics/contact/held_joints.hpp"
#include "dynamics/equations_of_motion.hpp"
#include "effects/behaviour.hpp"
#include "simulate/modes.hpp"

namespace pendcore {

/// A guard on a joint. All kinds but the last two are linear in the angle and the rate.
struct JointGuard {
  enum class Kind : std::uint8_t {
    law,         ///< an angle or a torque at which a law changes to its next mode
    side,        ///< the rate of a joint, whose sign is the mode of a law
    friction,    ///< the rate of a joint with dry friction, which may come to rest
    lower_stop,  ///< the angle of a joint, above the lower end of its range
    upper_stop,
    least_torque,  ///< the torque that holds a joint, above the lower end of its range
    most_torque
  };
  Kind kind;
  int joint;               ///< counted from 0
  Guard linear = {};       ///< in terms of the joint's angle and rate
  std::size_t effect = 0;  ///< whose law changes,
  std::size_t number = 0;  ///< at the guard of its mode with this number
  int multiplicity = 0;    ///< of its zero at the start of the next step

  bool is_linear() const { return kind < Kind::least_torque; }
  bool is_on_rate() const { return kind == Kind::side || kind == Kind::friction; }
  Side stop() const {
    return kind == Kind::lower_stop   ? Side::lower
           : kind == Kind::upper_stop ? Side::upper
                                      : Side::none;
  }

  /// The value of a linear guard in a state of n links.
  double value(const double* y, int n) const;
  /// How far that can be off by the rounding of the state.
  double rounding(const double* y, int n) const;
  /// Its coefficients along the dense output, given by (degree + 1) rows of `dimension` numbers.
  void polynomial(const double* rows, int degree, int dimension, int n, double* coefficients) const;
};

/// All guards from a state y = (q, qd) on: the linear ones come first. `changes` are those at the
/// time of the state.
std::vector<JointGuard> joint_guards(const EquationsOfMotion& equations,
                                     const ChangesAtOnce& changes, const double* y);

}  // namespace pendcore
