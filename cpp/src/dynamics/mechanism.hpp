/// \file
/// All numbers of a scene on which its motion depends, as plain numbers or with slopes along
/// parameters of the scene.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "arithmetic/dual.hpp"
#include "effects/laws.hpp"
#include "pendcore/parameters.hpp"
#include "pendcore/scene.hpp"

namespace pendcore {

/// A number, and its slopes along eight names of a run: starts and parameters.
using AlongNames = Dual<double, Pack<8>>;
inline constexpr int names_at_once = 8;
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
    PivotLawOf<Number> pivot{};  ///< if it moves the pivot
    std::optional<LawOn<Number>> law{};
    std::optional<CoupleOf<Number>> couple{};
    std::vector<Wave> waves{};
    int place = 0;  ///< the joint or the link, from 0
    bool moves_pivot = false;
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
    "larger or smaller value";

/// A mechanism, and how its numbers change with some parameters (pendcore/parameters.hpp), from a
/// time on. What other parameters of the list give stays as it is: the centre of a rod that is
/// named does not follow its length. Slopes are right to some 13 digits: the constants of laws are
/// smooth functions of parameters, whose differences are extrapolated.
class MechanismAlong {
 public:
  MechanismAlong(const Scene& scene, const std::vector<int>& modes, double t, bool forward,
                 const ParameterChoice& choice);

  /// The mechanism with slopes along one of the parameters, counted from 0, in each direction of
  /// `Number`; along none where there is -1.
  template <class Number>
  Mechanism<Number> with_slopes(const std::vector<int>& parameters) const;
  /// Those along all of them, four in each mechanism.
  std::vector<Mechanism<AlongParameters>> with_all_slopes() const;

  /// For each parameter, whether a law has a corner at its value: the slopes along it are NaN then.
  const std::vector<bool>& corners() const { return corners_; }
  /// Throws std::invalid_argument if some law has a corner.
  void refuse_corners() const;

 private:
  std::vector<std::string> names_;
  Mechanism<double> here_;
  std::vector<std::vector<double>> slopes_;  ///< along each parameter, of all numbers
  std::vector<bool> corners_;
};

}  // namespace pendcore
