/// \file
/// The waves of a scene, and what they drive: joints by torques, and the pivot, which a spline may
/// move as well (effects/laws.hpp).
#pragma once

#include <tuple>
#include <type_traits>
#include <vector>

#include "arithmetic/rows_in_memory.hpp"
#include "arithmetic/sine_cosine.hpp"
#include "effects/laws.hpp"

namespace pendcore {

/// The first two waves that act on a double pendulum, and what they add to its equations:
/// Q += sum_k sin(wave k) (torque_k + on_sine_k sin q + on_cosine_k cos q).
template <class Links>
struct WavesOf {
  Links torque[2]{};     ///< amplitudes of motors
  Links on_sine[2]{};    ///< amplitudes of a xdd_0 of the pivot
  Links on_cosine[2]{};  ///< amplitudes of -a ydd_0 of the pivot

  template <class Any>
  static auto fields(Any& x) {
    return std::tie(x.torque, x.on_sine, x.on_cosine);
  }
};

/// `Number` is a double, a pack with a trajectory in each lane, or a number with slopes.
template <class Number>
struct Drives {
  /// A run computes four waves at a time; in lanes, each has a pack to itself.
  using Together = std::conditional_t<std::is_same_v<Number, double>, Pack<4>, Number>;
  using Numbers = RowsInMemory<Together, Number>;

  int waves = 0;
  std::vector<JointWaveOf<Number>> joint_waves;
  std::vector<PivotLawOf<Number>> pivots;
  Numbers angular_frequency, phase;  ///< one for each wave, with zeros after them
  mutable Numbers wave_sine, wave_cosine;

  void make_room_for_waves(int count) {
    waves = count;
    for (Numbers* numbers : {&angular_frequency, &phase, &wave_sine, &wave_cosine}) {
      numbers->assign(static_cast<std::size_t>(waves) + 8);
    }
  }

  /// Computes sine and cosine of the waves from number `known` on, at time t.
  PENDCORE_INLINE_UNLESS_SMALL void compute_waves(const ConstantOf<Number>& t, int known) const {
    for (int k = known; k < waves; k += Numbers::places) {
      Together s, c;
      sine_cosine(fma(angular_frequency.row(k), Constants<Together>::of(t), phase.row(k)), s, c);
      wave_sine.set_row(k, s);
      wave_cosine.set_row(k, c);
    }
  }

  /// The acceleration (m/s^2) and the velocity (m/s) of the pivot. compute_waves() comes first.
  PENDCORE_INLINE void pivot_acceleration(const Number& t, Number& x, Number& y) const {
    x = y = Number{};
    for (const PivotLawOf<Number>& law : pivots) law.add_acceleration(t, wave_sine, x, y);
  }
  PENDCORE_INLINE void pivot_velocity(const Number& t, Number& x, Number& y) const {
    x = y = Number{};
    for (const PivotLawOf<Number>& law : pivots) law.add_velocity(t, wave_cosine, x, y);
  }
};

}  // namespace pendcore
