/// \file
/// One link in the recursion of chain.hpp where no rotor or held joint couples links: from the tip
/// to the base, and back. A single run (chain_recursion.hpp) and lanes
/// (ensemble/few_links_in_lanes.hpp) go over the links.
#pragma once

#include "pendcore/dynamics/chain/chain_link.hpp"

namespace pendcore {

/// What a link has at a state, for the recursion: the sine and cosine of its angle, those of the
/// angle to the link before and their products, L qd^2 and m c qd^2, and the loads on it.
template <class Number>
struct LinkInMotion {
  Number s, c, cos, sin, cc, ss, sc;
  Number centripetal, center;
  Number torque, fx, fy;  ///< not read if nothing loads the chain
};

/// How a link that turns freely responds: qdd = free - (x, y) . a.
template <class Number>
struct FreeResponse {
  Number free, x, y;
};

/// The force on the joint of a link as the links beyond it have it, F = B a + b.
template <class Number>
struct JointForce {
  ForcePerAcceleration<Number> B;
  Number b_u, b_n;

  /// Goes on to the joint of a link that turns freely, in the frame of the link before.
  template <bool loaded, class Constant>
  PENDCORE_INLINE FreeResponse<Number> add_free(const ChainLinkOf<Constant>& k,
                                                const LinkInMotion<Number>& at) {
    const Number D = fma(k.LL, B.nn, k.Io);
    const Number r = 1.0 / D;
    const Number speed = at.centripetal;
    const Number pu = fma(-speed, B.uu, b_u);
    const Number pn = fma(-speed, B.un, b_n);
    const Number torque = loaded ? fma(-k.L, pn, at.torque) : -k.L * pn;
    const Number free = torque * r;
    const Number wu = k.L * B.un;
    const Number wn = fma(k.L, B.nn, k.mc);
    Number fu = pu - at.center;
    Number fn = pn;
    if constexpr (loaded) {
      fu = fu - at.fx;
      fn = fn - at.fy;
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

/// qdd of a link whose joint has the acceleration (ax, ay), which becomes that of the next joint.
template <class Number>
PENDCORE_INLINE Number accelerate(const FreeResponse<Number>& k, const Number& s, const Number& c,
                                  const Number& L, const Number& centripetal, Number& ax,
                                  Number& ay) {
  const Number x = fma(-centripetal, c, ax);
  const Number y = fma(-centripetal, s, ay);
  const Number found = fma(-k.y, ay, fma(-k.x, ax, k.free));
  ax = fma(-(L * s), found, x);
  ay = fma(L * c, found, y);
  return found;
}

}  // namespace pendcore
