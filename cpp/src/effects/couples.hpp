/// \file
/// Couples: the torques of effects that are polynomials in time, angle and rate of a joint, and
/// waves.
#pragma once

#include <bit>
#include <tuple>

#include "arithmetic/pair.hpp"

namespace pendcore {

/// The torque of an effect whose law, in each of its modes, is a polynomial in time, angle and rate
/// of its joint, and a wave:
///
///     tau = held + slope (t - start) + on_phi phi + on_phid w + on_phid2 w^2 + on_phid3 w^3
///           + gain sin(wave)
///
/// All such effects on one joint are summed once, when the scene is compiled or a mode changes, and
/// together they cost as much as one.
///
/// `Number` is a double, or a dual number with the slope along a parameter of the effect.
template <class Number>
struct CoupleOf {
  Number held{};
  Number slope{};
  Number start{};
  Number on_phi{};
  Number on_phid{};
  Number on_phid2{};
  Number on_phid3{};
  Number gain{};

  /// Those that Couples add up.
  template <class Any>
  static auto fields(Any& x) {
    return std::tie(x.held, x.slope, x.start, x.on_phi, x.on_phid, x.on_phid2, x.on_phid3);
  }
  Number torque(double t, double phi, double phid, const Number& sine) const {
    const Number of_rate = phid * (phid * (phid * on_phid3 + on_phid2) + on_phid);
    return held + slope * (Number(t) - start) + phi * on_phi + of_rate + gain * sine;
  }
};
using Couple = CoupleOf<double>;

/// Adds a couple without its wave to the sum of others on the same joint. `has_start` says whether
/// one of them depends on time.
template <class Number>
void add_couple(CoupleOf<Number>& sum, const CoupleOf<Number>& one, bool& has_start) {
  if (is_zero(one.slope) && is_zero(one.start)) {
    sum.held += one.held;
  } else {
    // The common start is the latest, even if starts are negative: it keeps t - start small.
    const bool is_later = !has_start || value_of(sum.start) < value_of(one.start);
    const Number start = is_later ? one.start : sum.start;
    sum.held += sum.slope * (start - sum.start) + one.held + one.slope * (start - one.start);
    sum.start = start;
    sum.slope += one.slope;
    has_start = true;
  }
  sum.on_phi += one.on_phi;
  sum.on_phid += one.on_phid;
  sum.on_phid2 += one.on_phid2;
  sum.on_phid3 += one.on_phid3;
}

/// The sums of the couples on a row of joints. The alignment is set here: GCC reports the alignment
/// of a wide pack as on the baseline, and its clones rely on the true alignment.
template <class Row>
struct alignas(std::bit_floor(sizeof(Row))) Couples {
  int row = 0;
  bool has_powers = false;  ///< whether some torque depends on the square or cube of its rate
  Row held{}, slope{}, start{}, on_phi{}, on_phid{}, on_phid2{}, on_phid3{};

  template <class Any>
  static auto fields(Any& x) {
    return CoupleOf<Row>::fields(x);
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
};

/// A wave that drives a joint: tau += gain sin(wave). `Number` is a double, or a pack with a
/// trajectory in each lane.
template <class Number>
struct alignas(sizeof(Number)) JointWaveOf {
  int joint;  ///< counted from 0
  int wave;
  Number gain;
};
using JointWave = JointWaveOf<double>;

}  // namespace pendcore
