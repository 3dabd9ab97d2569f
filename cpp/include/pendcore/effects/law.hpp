/// \file
/// What a law sees, what it adds to, and when it changes.
///
/// A law is written once, for a row of joints or links: `Row` is double for a chain of one link, a
/// Pair for two links, and a Pack<4> for every four links of a longer chain. Its fields are rows of
/// parameters, neutral (mostly 0) where a joint does not have the effect. The number type V of its
/// computation is the same row, or a row with more than one number for each joint (pair.hpp).
///
/// `at` has, for each link or joint of the row:
///
///     at.t                    time, s
///     at.q, at.qd             absolute angle and rate of the link, rad, rad/s
///     at.s, at.c              sin q and cos q: u = (c, s) along the link, n = (-s, c) across it
///     at.phi(), at.phid()     angle and rate of the joint, phi_j = q_j - q_{j-1}
///     at.length()             length of the link, m
///     at.vx(), at.vy()        velocity of the joint where the link begins, m/s
///
/// and `loads` takes
///
///     loads.couple(tau)            tau_j on link j, and -tau_j on link j - 1
///     loads.force(moment, fx, fy)  a force on each link (N; x right, y down), and its moment about
///                                  the joint where the link begins (N m): x fy - y fx of its point
///     loads.generalised(Q)         N m, on the absolute angle of each link
///
/// **Modes.** A law that is only piecewise smooth is frozen to one of its pieces, the mode, during
/// a step, so that the integrator never sees a corner. A guard is positive as long as the mode
/// holds; the step that would cross its zero is cut to end there, and `next_mode` follows.
#pragma once

#include <bit>
#include <limits>
#include <vector>

#include "pendcore/arithmetic/fields.hpp"
#include "pendcore/arithmetic/pair.hpp"

namespace pendcore {

/// g = offset + on_phi phi + on_phid phid: positive while the mode holds.
struct Guard {
  double offset = 0.0;
  double on_phi = 0.0;
  double on_phid = 0.0;

  /// Whether the zero of the guard is a zero of the rate.
  bool is_on_rate() const { return on_phi == 0.0 && offset == 0.0; }
};

/// The torque of an effect whose law, in each of its modes, is a polynomial in time, angle and rate
/// of its joint, and a wave:
///
///     tau = held + slope (t - start) + on_phi phi + on_phid w + on_phid2 w^2 + on_phid3 w^3
///           + gain sin(wave)
///
/// Such effects need no Law. All of them on one joint are summed once, when the scene is compiled
/// or a mode changes, and together they cost as much as one.
struct Couple {
  double held = 0.0;
  double slope = 0.0;
  double start = 0.0;
  double on_phi = 0.0;
  double on_phid = 0.0;
  double on_phid2 = 0.0;
  double on_phid3 = 0.0;
  double gain = 0.0;

  /// Those that Couples add up.
  template <class Any>
  static auto fields(Any& x) {
    return std::tie(x.held, x.slope, x.start, x.on_phi, x.on_phid, x.on_phid2, x.on_phid3);
  }

  double torque(double t, double phi, double phid, double sine) const {
    const double of_rate = ((on_phid3 * phid + on_phid2) * phid + on_phid) * phid;
    return held + slope * (t - start) + on_phi * phi + of_rate + gain * sine;
  }
};

/// The sums of the couples on a row of joints. The alignment is set here: GCC reports the alignment
/// of a wide pack as on the baseline, and its clones rely on the true alignment.
template <class Row>
struct alignas(std::bit_floor(sizeof(Row))) Couples {
  int row = 0;
  Row held{}, slope{}, start{}, on_phi{}, on_phid{}, on_phid2{}, on_phid3{};

  template <class Any>
  static auto fields(Any& x) {
    return std::tie(x.held, x.slope, x.start, x.on_phi, x.on_phid, x.on_phid2, x.on_phid3);
  }

  template <class At>
  PENDCORE_INLINE typename At::Value torque(const At& at) const {
    using V = typename At::Value;
    const V w = at.phid();
    const V of_rate = fma(fma(Constants<V>::of(on_phid3), w, Constants<V>::of(on_phid2)), w,
                          Constants<V>::of(on_phid));
    return fma(of_rate, w, fma(Constants<V>::of(on_phi), at.phi(), in_time<V>(at.t)));
  }

  /// held + slope (t - start)
  template <class V, class Time>
  PENDCORE_INLINE V in_time(const Time& t) const {
    V since_start;
    if constexpr (requires { Constants<Row>::of(t); }) {
      since_start = Constants<V>::of(Constants<Row>::of(t) - start);
    } else {  // each lane has a time of its own, and the constants are those of all
      since_start = Constants<V>::of(t) - Constants<V>::of(start);
    }
    return fma(Constants<V>::of(slope), since_start, Constants<V>::of(held));
  }
  /// Whether some torque depends on the square or the cube of its rate.
  PENDCORE_INLINE bool has_powers() const {
    return sum_of_lanes(Row(absolute(on_phid2) + absolute(on_phid3))) != 0.0;
  }
};

/// A wave that drives a joint: tau += gain sin(wave).
struct JointWave {
  int joint;  ///< counted from 0
  int wave;
  double gain;
};

/// Constants for a law, from the link on which its effect acts or which begins at its joint.
struct LinkConstants {
  double mass, length, center;
  double gravity;  ///< the scene's
};

/// A time that never comes, or a bound that does not exist.
inline constexpr double never = std::numeric_limits<double>::infinity();

}  // namespace pendcore
