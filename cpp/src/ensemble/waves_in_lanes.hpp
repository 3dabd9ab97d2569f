/// \file
/// The waves of motors and of the pivot in lanes of Runge-Kutta methods, for one link and for three
/// and four; two links have waves of their own (lane_equations.hpp).
#pragma once

#include "arithmetic/sine_cosine.hpp"
#include "dynamics/acting_effects.hpp"

namespace pendcore {

/// The most waves that a trajectory in a lane may have.
inline constexpr int most_waves_in_lanes = 4;

/// The waves of motors and of the pivot, a trajectory in each lane. Which waves there are, and what
/// each of them moves, is the same in all lanes.
template <class Real>
struct WavesInLanes {
  /// What a wave gives, by its number: N m of a motor, m/s^2 of the pivot along x or y.
  struct WaveWithGain {
    int wave = 0;
    Real gain = {};
  };
  struct Motor : WaveWithGain {
    int joint = 0;
  };
  struct Pivot {
    WaveWithGain x, y;
  };

  Real angular_frequency[most_waves_in_lanes] = {}, phase[most_waves_in_lanes] = {};
  Motor motor[most_waves_in_lanes];
  Pivot pivot[most_waves_in_lanes];
  int wave_count = 0, motor_count = 0, pivot_count = 0;

  /// Whether there is room for what a trajectory has.
  static bool has(const EffectsInForce& effects) {
    constexpr int most = most_waves_in_lanes;
    return effects.waves <= most && effects.joint_waves.size() <= most &&
           effects.pivots.size() <= most;
  }
  /// Takes over which waves there are and what they move.
  void prepare(const EffectsInForce& effects) {
    wave_count = effects.waves;
    motor_count = static_cast<int>(effects.joint_waves.size());
    pivot_count = static_cast<int>(effects.pivots.size());
    for (int k = 0; k < motor_count; ++k) {
      motor[k].wave = effects.joint_waves[k].wave;
      motor[k].joint = effects.joint_waves[k].joint;
    }
    for (int k = 0; k < pivot_count; ++k) {
      pivot[k].x.wave = effects.pivots[k].x.wave;
      pivot[k].y.wave = effects.pivots[k].y.wave;
    }
  }
  /// Puts the numbers of a trajectory into a lane; false if its waves move other things.
  bool put(int lane, const EffectsInForce& effects) {
    // A motor of amplitude 0 has no joint wave: its member has other equations.
    const bool is_alike = wave_count == effects.waves &&
                          motor_count == static_cast<int>(effects.joint_waves.size()) &&
                          pivot_count == static_cast<int>(effects.pivots.size());
    if (!is_alike) return false;
    for (int k = 0; k < wave_count; ++k) {
      angular_frequency[k][lane] = effects.angular_frequency[k];
      phase[k][lane] = effects.phase[k];
    }
    const auto put_wave = [lane](WaveWithGain& to, int wave, double gain) {
      to.gain[lane] = gain;
      return to.wave == wave;
    };
    bool is_same = true;
    for (int k = 0; k < motor_count; ++k) {
      const JointWave& one = effects.joint_waves[k];
      is_same &= put_wave(motor[k], one.wave, one.gain) && motor[k].joint == one.joint;
    }
    for (int k = 0; k < pivot_count; ++k) {
      const PivotLaw& law = effects.pivots[k];
      is_same &= put_wave(pivot[k].x, law.x.wave, law.x.gain);
      is_same &= put_wave(pivot[k].y, law.y.wave, law.y.gain);
    }
    return is_same;
  }

  PENDCORE_INLINE void compute(const Real& t, Real* wave) const {
    for (int k = 0; k < wave_count; ++k) {
      Real cosine;
      sine_cosine(fma(angular_frequency[k], t, phase[k]), wave[k], cosine);
    }
  }
  /// Adds the acceleration of the pivot.
  PENDCORE_INLINE void add_acceleration(const Real* wave, Real& x, Real& y) const {
    for (int k = 0; k < pivot_count; ++k) {
      // A run adds the zero of a spline here, which settles the sign of a zero.
      x = x + fma(pivot[k].x.gain, wave[pivot[k].x.wave], Real{});
      y = y + fma(pivot[k].y.gain, wave[pivot[k].y.wave], Real{});
    }
  }
};

}  // namespace pendcore
