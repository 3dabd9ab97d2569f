/// \file
/// The accelerations of a chain of n links in O(n), because the system of its joint forces is block
/// tridiagonal.
///
/// From the tip to the base, the force on link i at its joint is an affine function of the
/// acceleration a of this joint, F_i = B_i a + b_i, where a includes gravity and the acceleration
/// of the pivot. In the frame (u, n) of link i, B and p are those of the links beyond it, and p
/// includes the centripetal part:
///
///     p_u = b_u - L qd^2 B_uu      p_n = b_n - L qd^2 B_un      (the rest of F_{i+1})
///     D   = I_o + L^2 B_nn         I_o = I + m c^2
///     w   = (L B_un, m c + L B_nn)
///     qdd = (Q - L p_n - w . a) / D
///     B_i = m + B - w w^T / D      b_i = p - m c qd^2 u - F_ext + w (Q - L p_n) / D
///
/// The components of B_i are computed in a form without harmful cancellation:
///
///     D B_un = B_un (I_o - m c L)      D B_nn = m I + B_nn (I + m (L - c)^2)
///
/// B_i is then rotated into the frame of link i - 1. At the tip B = m_p. From the base to the tip,
/// a_0 = (xdd_0, ydd_0 - g) and a_i = a_{i-1} + L (qdd n - qd^2 u).
///
/// A rotor or a held joint couples the rotations of two links. Then the affine function also
/// relates torque and angular acceleration (the terms beta, kappa and t). With J the inertia of the
/// rotor:
///
///     r = 1/(D + J), s = J r          held: r = 0, s = 1
///     qdd_i = r (Q - L p_n - t - w . a) + s qdd_{i-1}
///
/// Source: Featherstone, Rigid Body Dynamics Algorithms (2008), chapter 7, here for the plane.
/// Cost: some 60 operations and a quarter of a pack of sines and cosines for each link; no
/// allocation.
#pragma once

#include <memory>

#include "dynamics/chain/chain_link.hpp"
#include "dynamics/chain/links_in_motion.hpp"
#include "dynamics/effects_in_rows.hpp"

namespace pendcore {

/// The constants of a chain for the recursion, and memory for one right-hand side: only one thread
/// may use it at a time. `Number` is the type of the computation, a double or a dual number.
template <class Number>
class ChainOf {
 public:
  ChainOf(const Scene& scene, std::shared_ptr<EffectsInRows<Pack<4>>> effects);

  /// qdd (rad/s^2) from the time (s), angles (rad) and rates (rad/s), (n) each. Defined in
  /// chain_recursion.hpp.
  PENDCORE_INLINE void accelerations(double t, const Number* q, const Number* qd,
                                     Number* qdd) const;

  const EffectsInRows<Pack<4>>* effects() const { return effects_.get(); }
  const ChainLink& link(int i) const { return links_[i]; }
  double rotor(int i) const { return rotor_[i]; }        ///< kg m^2, between links i - 1 and i
  double payload_mass() const { return payload_mass_; }  ///< kg
  double gravity() const { return gravity_; }            ///< m/s^2
  bool is_loaded() const { return loaded_; }
  /// Whether a rotor couples the rotations of two links.
  bool has_rotors() const { return has_rotors_; }

 private:
  /// The links that are taken at a time: four, or one with slopes along several directions.
  using Row = std::conditional_t<
      std::is_same_v<Number, double>, Pack<4>,
      std::conditional_t<std::is_same_v<Number, Dual<double>>, Dual<Pack<4>>, Number>>;
  static constexpr int width = Lanes<Row>::width;
  PENDCORE_INLINE void prepare(const Number* q, const Number* qd) const;
  PENDCORE_INLINE void collect_loads(double t) const;
  template <template <class> class Law, class Use>
  PENDCORE_INLINE void in_rows(const Law<Pack<4>>& all, int row, const Use& use) const;
  /// `size` is the number of links where the compiler knows it, and 0 otherwise.
  template <int size>
  PENDCORE_INLINE void recursion(const Number& ax, const Number& ay, Number* qdd) const;
  template <bool loaded, int size>
  PENDCORE_INLINE void tip_to_base() const;
  PENDCORE_INLINE void tip_to_base_coupled() const;
  template <bool coupled, int size>
  PENDCORE_INLINE void base_to_tip(const Number& ax, const Number& ay, Number* qdd) const;
  PENDCORE_INLINE LinkInMotion<Number> in_motion(int i) const;

  /// Arrays over the links have a pack of zeros before and after them, except that the cosine
  /// before the first link is 1.
  template <class Any>
  static Any* in(std::vector<Any>& a) {
    return a.data() + 4;
  }
  template <class Any>
  static const Any* in(const std::vector<Any>& a) {
    return a.data() + 4;
  }

  int n_;
  int padded_;  ///< the number of links, rounded up to whole rows
  double gravity_;
  double payload_mass_;
  bool has_rotors_ = false;  ///< in joints after the first
  bool loaded_;              ///< has effects that add loads
  std::shared_ptr<EffectsInRows<Pack<4>>> effects_;

  std::vector<ChainLink> links_;
  std::vector<double> length_, mass_moment_;  // L, m c
  std::vector<double> rotor_;                 // J
  // Values of one right-hand side:
  mutable std::vector<Number> q_, qd_, s_, c_;
  mutable std::vector<Number> centripetal_;               // L qd^2
  mutable std::vector<Number> center_;                    // m c qd^2
  mutable std::vector<Number> cc_, ss_, sc_, cos_, sin_;  // products and cos, sin of q_i - q_{i-1}
  // Forces (fx, fy) are collected in the frame of the ground, and then turned into each link's.
  mutable std::vector<Number> couple_, torque_, fx_, fy_, vx_, vy_, user_;
  mutable std::vector<CoupledResponse<Number>> response_;
};

using Chain = ChainOf<double>;

}  // namespace pendcore
