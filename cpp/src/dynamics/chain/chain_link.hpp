/// \file
/// One link in the recursion of chain.hpp: its constants, and the step that takes B from a link to
/// the link before. The accelerations (links_in_motion.hpp, chain_recursion.hpp) and their series
/// (chain_series_recurrence.hpp, few_links_series.hpp) use it.
#pragma once

#include <vector>

#include "arithmetic/fields.hpp"
#include "arithmetic/pair.hpp"
#include "dynamics/inertia.hpp"

namespace pendcore {

/// `Number` is a double, a pack with one trajectory a lane, or a number with slopes.
template <class Number>
struct ChainLinkOf {
  Number m, L, mc, I, Io, LL, turn, across;  // turn: I_o - m c L, across: I + m (L - c)^2

  template <class Any>
  static auto fields(Any& x) {
    return std::tie(x.m, x.L, x.mc, x.I, x.Io, x.LL, x.turn, x.across);
  }
};
using ChainLink = ChainLinkOf<double>;

/// A link of length L, whose centre of mass is at a distance from the joint where it begins.
template <class Number>
ChainLinkOf<Number> chain_link(const Number& m, const Number& L, const Number& center,
                               const Number& I) {
  const Number mc = m * center;
  const Number about_joint = I + m * center * center;
  const Number rest = L - center;
  return {.m = m,
          .L = L,
          .mc = mc,
          .I = I,
          .Io = about_joint,
          .LL = L * L,
          .turn = about_joint - mc * L,
          .across = I + m * rest * rest};
}

/// The links of a scene. The last link has the moment of inertia of the payload. The first link has
/// the rotor of joint 1, which turns against the ground; rotors of other joints couple two links
/// and are not included.
std::vector<ChainLink> chain_links(const Scene& scene, const Inertia& inertia);

/// The matrix B of chain.hpp: the force at a joint per acceleration of the joint, in the frame (u,
/// n) of a link. `cc`, `ss` and `sc` are the products of cosine and sine of the angle between this
/// link and the link before; `wu` and `wn` are w of chain.hpp.
template <class Number>
struct ForcePerAcceleration {
  Number uu, un, nn;

  /// Adds a link that turns freely, and rotates B into the frame of the link before. The factor r =
  /// 1/D enters last, so that the other operations do not wait for the division.
  template <class Constant>
  PENDCORE_INLINE void add_free(const ChainLinkOf<Constant>& k, const Number& r, const Number& wu,
                                const Number& cc, const Number& ss, const Number& sc) {
    const Number mass = k.m + uu;
    const Number along = wu * wu;
    const Number mixed = un * k.turn;
    const Number across = fma(nn, k.across, k.m * k.I);
    const Number both = sc + sc;
    nn = fma(r, fma(-ss, along, fma(both, mixed, cc * across)), ss * mass);
    un = fma(r, fma(-sc, along + across, (cc - ss) * mixed), sc * mass);
    uu = fma(r, fma(-cc, along, fma(-both, mixed, ss * across)), cc * mass);
  }

  /// The same for a link whose rotation is coupled with the link before, by a rotor or a held
  /// joint.
  template <class Constant>
  PENDCORE_INLINE void add_coupled(const ChainLinkOf<Constant>& k, const Number& r,
                                   const Number& wu, const Number& wn, const Number& cc,
                                   const Number& ss, const Number& sc) {
    const Number along = fma(-r * wu, wu, k.m + uu);
    const Number mixed = fma(-r * wu, wn, un);
    const Number across = fma(-r * wn, wn, k.m + nn);
    nn = fma(ss, along, fma(2.0 * sc, mixed, cc * across));
    un = fma(sc, along - across, (cc - ss) * mixed);
    uu = fma(cc, along, fma(-2.0 * sc, mixed, ss * across));
  }
};

}  // namespace pendcore
