/// \file
/// The laws of effects that a right-hand side computes; the sums of couples are in couples.hpp.
///
/// A law is written once, for a row of joints or links: `Row` is double for a chain of one link, a
/// Pair for two links, and a Pack<4> for every four links of a longer chain. Its fields are rows of
/// parameters, 0 where a joint does not have the effect. The number type V of its
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
/// A law other than a couple has, beside its rows of constants,
///
///     fields(x)        the rows, all 0 where a joint or a link has no such effect
///     shared(x)        constants that the links of a row must have in common
///     add(at, loads)   the law
///     dissipation(at)  W, if it knows the part of its power that is lost
#pragma once

#include <algorithm>
#include <tuple>
#include <variant>

#include "arithmetic/exponential.hpp"
#include "arithmetic/fields.hpp"
#include "arithmetic/pair.hpp"
#include "effects/couples.hpp"
#include "pendcore/effects/effect.hpp"

namespace pendcore {

/// Constants for a law, from the link on which its effect acts or which begins at its joint.
struct LinkConstants {
  double mass, length, center;
  double gravity;  ///< the scene's
};

/// Dry friction with Stribeck's effect, while the joint slides:
///
///     tau = -(t_c + (t_s - t_c) exp(-|w/w_s|^p)) sgn w,   w = phid
template <class Row>
struct StribeckLaw {
  Row coulomb{};  // has the sign of w, as the next two have
  Row peak{};
  Row inverse_velocity{};
  typename Lanes<Row>::Number exponent = 2.0;

  template <class Any>
  static auto fields(Any& x) {
    return std::tie(x.coulomb, x.peak, x.inverse_velocity);
  }
  template <class Any>
  static auto shared(Any& x) {
    return std::tie(x.exponent);
  }

  template <class At, class Loads>
  PENDCORE_INLINE void add(const At& at, Loads& loads) const {
    using V = typename At::Value;
    const V x = absolute(at.phid() * Constants<V>::of(inverse_velocity));
    const V share = exponential(-power(x, exponent));
    loads.couple(-fma(Constants<V>::of(peak), share, Constants<V>::of(coulomb)));
  }
};

/// Air drag along slender rods across the flow:
///
///     f(s) = -k |w(s)| w(s) n,   k = rho C_d d / 2,   w(s) = w_0 + (w_1 - w_0) s/L
///     w_0 = n . (v - wind),  w_1 = w_0 + L qd         at the near and at the far end
///
/// v is the velocity of the joint where the link begins. The integrals along the rod are its
/// resultant F (along n) and its moment T about that joint. With D = |w_0| + |w_1| they are, for
/// all signs,
///
///     F = -k L   (w_0 + w_1)/D (w_0^2 + |w_0 w_1| + w_1^2) / 3
///     T = -k L^2 ((w_0 |w_0|^3 + w_1 w_1^2 (4 |w_0| + 3 |w_1|))/D^2
///                 + 2 (w_0 w_1 + |w_0 w_1|) (w_0 + w_1)/D) / 12
template <class Row>
struct RodDragLaw {
  Row minus_k{};      ///< -k L/3
  Row minus_k_arm{};  ///< -k L^2/12
  Row wind_x{};
  Row wind_y{};

  template <class Any>
  static auto fields(Any& x) {
    return std::tie(x.minus_k, x.minus_k_arm, x.wind_x, x.wind_y);
  }
  template <class Any>
  static auto shared(Any& /*x*/) {
    return std::tie();
  }

  template <class At, class Loads>
  PENDCORE_INLINE void add(const At& at, Loads& loads) const {
    using V = typename At::Value;
    V w0, w1;
    speeds(at, w0, w1);
    const V size0 = absolute(w0);
    const V size1 = absolute(w1);
    const V size = size0 + size1 + Constants<V>::of(1e-100);  // D; no 0/0 at rest
    const V inverse = 1.0 / size;
    const V direction = (w0 + w1) * inverse;
    const V size_of_product = size0 * size1;
    // w_0^2 + |w_0 w_1| + w_1^2 = D^2 - |w_0 w_1|
    const V force = (Constants<V>::of(minus_k) * direction) * fma(size, size, -size_of_product);
    const V ends =
        fma(w0 * size0, w0 * w0, (w1 * (w1 * w1)) * fma(Constants<V>::of(3.0), size, size0));
    const V between = fma(w0, w1, size_of_product) * direction;
    const V moment =
        Constants<V>::of(minus_k_arm) * fma(ends * inverse, inverse, between + between);
    loads.force(moment, -(force * at.s), force * at.c);
  }

  /// The integral of k |w|^3 along each rod, W.
  template <class At>
  PENDCORE_INLINE typename At::Value dissipation(const At& at) const {
    using V = typename At::Value;
    V w0, w1;
    speeds(at, w0, w1);
    const V size0 = absolute(w0);
    const V size1 = absolute(w1);
    const V product = w0 * w1;
    const V fourth = fma(w0 * w0, w0 * w0, (w1 * w1) * (w1 * w1));
    const V size_of_product = absolute(product);
    // (a^2 + b^2)(a + b) / 4 if both ends move in one direction, (a^4 + b^4)/(a + b) / 4 if not
    const V alike = (product + size_of_product) * (fma(w0, w0, w1 * w1) + size_of_product);
    const V inverse = 1.0 / (size0 + size1 + Constants<V>::of(1e-300));
    return Constants<V>::of(-0.75) * Constants<V>::of(minus_k) * ((fourth + alike) * inverse);
  }

 private:
  /// w_0 and w_1 of a row of links.
  template <class At>
  PENDCORE_INLINE void speeds(const At& at, typename At::Value& w0, typename At::Value& w1) const {
    using V = typename At::Value;
    const V across = at.vx() - Constants<V>::of(wind_x);
    w0 = fma(at.c, at.vy() - Constants<V>::of(wind_y), -(at.s * across));
    w1 = fma(at.length(), at.qd, w0);
  }
};

/// The list of laws.
template <class Row>
using LawOn = std::variant<StribeckLaw<Row>, RodDragLaw<Row>>;

/// A law with the constants of one effect.
using AnyLaw = LawOn<double>;

/// The acceleration of the pivot along each axis, in one piece of a spline or for a sinusoid:
/// x'' = held + slope (t - start) + gain sin(wave).
template <class Number>
struct alignas(sizeof(Number)) PivotLawOf {
  struct alignas(sizeof(Number)) Axis {
    Number held{}, slope{};  // the acceleration in a piece
    Number velocity{};       // the velocity at the start of the piece
    Number gain{}, swing{};  // -A omega^2 and A omega
    int wave = 0;            // the gain and the swing are 0 if none drives the axis

    template <class Any>
    static auto fields(Any& a) {
      return std::tie(a.held, a.slope, a.velocity, a.gain, a.swing);
    }
  };
  Axis x, y;
  Number start{};  // s, where the piece begins

  template <class Any>
  static auto fields(Any& law) {
    return std::tie(law.x, law.y, law.start);
  }

  /// `sines` and `cosines` are those of all waves, by their numbers.
  template <class Sines, class Real>
  PENDCORE_INLINE void add_acceleration(const Number& t, const Sines& sines, Real& ax,
                                        Real& ay) const {
    const Real since = t - start;
    ax = ax + fma(Real(x.slope), since, fma(Real(x.gain), Real(sines[x.wave]), Real(x.held)));
    ay = ay + fma(Real(y.slope), since, fma(Real(y.gain), Real(sines[y.wave]), Real(y.held)));
  }
  template <class Cosines>
  PENDCORE_INLINE void add_velocity(const Number& t, const Cosines& cosines, Number& vx,
                                    Number& vy) const {
    const Number since = t - start;
    const auto add = [&](const Axis& a, Number& v) __attribute__((always_inline)) {
      v = v + (a.velocity + since * fma(Number(0.5 * a.slope), since, a.held) +
               a.swing * cosines[a.wave]);
    };
    add(x, vx);
    add(y, vy);
  }
};
using PivotLaw = PivotLawOf<double>;

/// A function of the user's (user.hpp), in one piece between its breaks.
struct UserLaw {
  UserFunction function;
  void* data;
  double earliest = -never;  ///< s, the times of the piece
  double latest = never;

  void operator()(double t, int n, const double* q, const double* qd, double* Q) const {
    function(std::min(std::max(t, earliest), latest), n, q, qd, Q, data);
  }
};

}  // namespace pendcore
