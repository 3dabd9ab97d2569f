/// \file
/// One link in the recursion of chain.hpp: from the tip to the base, and back. A single run
/// (chain_recursion.hpp) and lanes (ensemble/few_links_in_lanes.hpp) go over the links.
#pragma once

#include "dynamics/chain/chain_link.hpp"

namespace pendcore {

/// What the recursion needs of a link at a state.
template <class Number>
struct LinkInMotion {
  Number s, c;              ///< sin q, cos q
  Number cos, sin;          ///< of q_i - q_{i-1}
  Number cc, ss, sc;        ///< the products of these
  Number centripetal;       ///< L qd^2, m/s^2
  Number center;            ///< m c qd^2, N
  Number torque;            ///< N m; add_free<false> reads neither this nor the force
  Number force_u, force_n;  ///< N, along the link and across it
};

/// The acceleration of a joint, m/s^2, in the frame of the ground.
template <class Number>
struct JointAcceleration {
  Number x, y;
};

/// How a link that turns freely responds: qdd = free - (x, y) . a.
template <class Number>
struct FreeResponse {
  Number free, x, y;
};

/// The force at a joint, F = B a + b, with all links beyond it.
template <class Number>
struct JointForce {
  ForcePerAcceleration<Number> B;
  Number b_u, b_n;

  /// Adds link k, which turns freely. F is then the force at the joint of link k, in the frame of
  /// the link before.
  template <bool loaded, class Constant>
  PENDCORE_INLINE FreeResponse<Number> add_free(const ChainLinkOf<Constant>& k,
                                                const LinkInMotion<Number>& at) {
    const Number D = fma(k.LL, B.nn, k.Io);
    const Number r = 1.0 / D;
    const Number pu = fma(-at.centripetal, B.uu, b_u);
    const Number pn = fma(-at.centripetal, B.un, b_n);
    const Number torque = loaded ? fma(-k.L, pn, at.torque) : -k.L * pn;
    const Number free = torque * r;
    const Number wu = k.L * B.un;
    const Number wn = fma(k.L, B.nn, k.mc);
    Number fu = pu - at.center;
    Number fn = pn;
    if constexpr (loaded) {
      fu = fu - at.force_u;
      fn = fn - at.force_n;
    }
    fu = fma(wu, free, fu);
    fn = fma(wn, free, fn);
    const FreeResponse<Number> response{free, r * fma(wu, at.c, -(wn * at.s)),
                                        r * fma(wu, at.s, wn * at.c)};
    B.add_free(k, r, wu, at.cc, at.ss, at.sc);
    b_u = fma(fu, at.cos, -(fn * at.sin));
    b_n = fma(fu, at.sin, fn * at.cos);
    return response;
  }
};

/// How a link responds whose rotation is coupled with the link before:
/// qdd = free - (x, y) . a + from_before qdd_{i-1}.
template <class Number>
struct CoupledResponse {
  Number free, x, y, from_before;
};

/// The force and the torque at a joint, with all links beyond it, where rotors or held joints
/// couple rotations.
template <class Number>
struct CoupledForce {
  ForcePerAcceleration<Number> B;
  Number b_u{}, b_n{};
  Number beta_u{}, beta_n{};  ///< force per angular acceleration of the link before
  Number kappa{};             ///< torque per angular acceleration
  Number t{};                 ///< the rest of the torque

  /// Adds link k, with a rotor of inertia J in its joint, which may be held.
  template <class Constant>
  PENDCORE_INLINE CoupledResponse<Number> add(const ChainLinkOf<Constant>& k, const Constant& J,
                                              bool is_held, const LinkInMotion<Number>& at) {
    const Number pu = fma(-at.centripetal, B.uu, b_u);
    const Number pn = fma(-at.centripetal, B.un, b_n);
    const Number D = fma(k.LL, B.nn, k.Io) + fma(2.0 * k.L, beta_n, kappa);
    const Number r = is_held ? Number{} : 1.0 / (D + J);
    const Number share = is_held ? Number{} + 1.0 : J * r;
    const Number wu = fma(k.L, B.un, beta_u);
    const Number wn = fma(k.L, B.nn, k.mc) + beta_n;
    const Number torque = at.torque - fma(k.L, pn, fma(-at.centripetal, beta_u, t));
    const Number free = r * torque;
    const Number fu = fma(wu, free, pu - at.center - at.force_u);
    const Number fn = fma(wn, free, pn - at.force_n);
    B.add_coupled(k, r, wu, wn, at.cc, at.ss, at.sc);
    b_u = fma(fu, at.cos, -(fn * at.sin));
    b_n = fma(fu, at.sin, fn * at.cos);
    beta_u = share * fma(wu, at.cos, -(wn * at.sin));
    beta_n = share * fma(wu, at.sin, wn * at.cos);
    kappa = share * D;
    t = -share * torque;
    return {free, r * fma(wu, at.c, -(wn * at.s)), r * fma(wu, at.s, wn * at.c), share};
  }
};

/// Returns qdd of a link whose joint accelerates by a, and makes a the acceleration of the next
/// joint. With qdd first, GCC 12 copies no number between the fused operations that wait for each
/// other: a copy (vmovsd) takes a cycle, and chains of ten rods and more took 1.03 of the time.
template <class Number>
PENDCORE_INLINE Number go_to_next_joint(const FreeResponse<Number>& k, const Number& s,
                                        const Number& c, const Number& L, const Number& centripetal,
                                        JointAcceleration<Number>& a) {
  const Number qdd = fma(-k.y, a.y, fma(-k.x, a.x, k.free));
  const Number x = fma(-centripetal, c, a.x);
  const Number y = fma(-centripetal, s, a.y);
  a = {fma(-(L * s), qdd, x), fma(L * c, qdd, y)};
  return qdd;
}

}  // namespace pendcore
