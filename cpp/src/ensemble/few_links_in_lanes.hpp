/// \file
/// The equations of three and four links in lanes of Runge-Kutta methods: the recursion of
/// chain.hpp, bare, or with couples, waves (waves_in_lanes.hpp) and drag (DragInLanes in
/// lane_equations.hpp), but without rotors between links.
#pragma once

#include <memory>
#include <variant>

#include "dynamics/chain/chain.hpp"
#include "dynamics/chain/free_links.hpp"
#include "dynamics/row.hpp"
#include "ensemble/lane_equations.hpp"
#include "ensemble/waves_in_lanes.hpp"

namespace pendcore {

/// n links in every lane.
template <class Real, int n>
struct FewLinksInLanes {
  using Links = EachLink<Real, n>;
  /// These equations are so long that a step loops over its stages around one copy of them.
  static constexpr bool is_long = true;

  Couples<Links> couples;
  ChainLinkOf<Real> link[n] = {};
  Real payload_mass = {}, gravity = {};
  DragInLanes<Links> drag;
  WavesInLanes<Real> waves;
  bool is_loaded = false, has_couples = false;

  /// As ChainOf computes it, in the same order.
  PENDCORE_INLINE Links accelerations(const Real& t, const Links& q, const Links& qd) const {
    Links s, c;
    sine_cosine(q, s, c);
    if (!is_loaded) return recursion<false>(qd, s, c, {}, {Real{}, Real(Real{} - gravity)});
    Real wave[most_waves_in_lanes];
    waves.compute(t, wave);
    JointAcceleration<Real> of_pivot{};
    waves.add_acceleration(wave, of_pivot.x, of_pivot.y);
    of_pivot.y = of_pivot.y - gravity;
    return recursion<true>(qd, s, c, loads(t, q, qd, s, c, wave), of_pivot);
  }

 private:
  struct Loads {
    Links torque;            ///< N m
    Links force_u, force_n;  ///< N, along the link and across it
  };

  PENDCORE_INLINE Links length() const {
    return row_detail::each<Real, n>([this](int i)
                                         __attribute__((always_inline)) { return link[i].L; });
  }

  PENDCORE_INLINE Loads loads(const Real& t, const Links& q, const Links& qd, const Links& s,
                              const Links& c, const Real* wave) const {
    RowOfLinksAt<Links, Real> at{.q = q,
                                 .qd = qd,
                                 .s = s,
                                 .c = c,
                                 .L = length(),
                                 .t = t,
                                 .vx_of_joint = {},
                                 .vy_of_joint = {}};
    if (drag.is_there) {
      Real x{}, y{};
#pragma GCC unroll 4
      for (int i = 0; i < n; ++i) {
        at.vx_of_joint.of[i] = x;
        at.vy_of_joint.of[i] = y;
        const Real speed = link[i].L * qd.of[i];
        x = fma(Real(-speed), s.of[i], x);
        y = fma(speed, c.of[i], y);
      }
    }
    RowLoads<Links> sums;
    if (has_couples) sums.couple(couples.torque(at));
    for (int k = 0; k < waves.motor_count; ++k) {
      const auto& motor = waves.motor[k];
      Real& couple = sums.couples.of[motor.joint];
      couple = couple + motor.gain * wave[motor.wave];
    }
    if (drag.is_there) drag.law.add(at, sums);
    Loads found{(sums.moments + sums.couples) - after(sums.couples), {}, {}};
    if (drag.is_there) {
      found.force_u = fma(c, sums.fx, s * sums.fy);
      found.force_n = fma(c, sums.fy, -(s * sums.fx));
    }
    return found;
  }

  template <bool loaded>
  PENDCORE_INLINE Links recursion(const Links& qd, const Links& s, const Links& c,
                                  const Loads& loads, JointAcceleration<Real> of_joint) const {
    const Links square = qd * qd;
    const Links centripetal = length() * square;
    JointForce<Real> force{{payload_mass, Real{}, payload_mass}, Real{}, Real{}};
    FreeResponse<Real> response[n];
#pragma GCC unroll 4
    for (int i = n - 1; i >= 0; --i) {
      LinkInMotion<Real> at{};
      at.s = s.of[i];
      at.c = c.of[i];
      if (i > 0) {  // nothing is before the first link
        at.cos = fma(at.c, c.of[i - 1], Real(at.s * s.of[i - 1]));
        at.sin = fma(at.s, c.of[i - 1], Real(-(at.c * s.of[i - 1])));
        at.cc = at.cos * at.cos;
        at.ss = at.sin * at.sin;
        at.sc = at.sin * at.cos;
      }
      at.centripetal = centripetal.of[i];
      at.center = link[i].mc * square.of[i];
      if constexpr (loaded) {
        at.torque = loads.torque.of[i];
        at.force_u = loads.force_u.of[i];
        at.force_n = loads.force_n.of[i];
      }
      response[i] = force.template add_free<loaded>(link[i], at);
    }
    Links found;
#pragma GCC unroll 4
    for (int i = 0; i < n; ++i) {
      found.of[i] =
          go_to_next_joint(response[i], s.of[i], c.of[i], link[i].L, centripetal.of[i], of_joint);
    }
    return found;
  }
};

/// A chain of n links without rotors between them: only a name for a form of LaneEquations.
template <int n>
struct FreeChain;

template <class Real, int n>
struct LaneEquations<FreeChain<n>, Real> : StatesOfLinks<Real, n> {
  using Type = FewLinksInLanes<Real, n>;

  /// Whether the equations of a chain have lanes.
  static bool has(const EquationsOfMotion& equations) {
    const auto* const form = std::get_if<std::shared_ptr<Chain>>(&equations.form);
    if (form == nullptr || (*form)->links() != n || !equations.are_steady()) return false;
    const ActingEffects<Pack<4>>& effects = *(*form)->effects();
    return !(*form)->has_rotors() && effects.users.empty() && !effects.any_held &&
           DragInLanes<EachLink<Real, n>>::has(effects) && WavesInLanes<Real>::has(effects);
  }
  static void prepare(Type& equations, const EquationsOfMotion& one) {
    const Chain& chain = *std::get<std::shared_ptr<Chain>>(one.form);
    const ActingEffects<Pack<4>>& effects = *chain.effects();
    // Lanes without a member divide by D, too: it must not be 0.
    for (ChainLinkOf<Real>& link : equations.link) link.Io = broadcast<Real>(1.0);
    equations.is_loaded = chain.is_loaded();
    equations.has_couples = !effects.couples.empty();
    equations.drag.is_there = !effects.entries.empty();
    equations.waves.prepare(effects);
  }
  static bool put(Type& equations, int lane, const EquationsOfMotion& from) {
    if (!has(from)) return false;
    const Chain& chain = *std::get<std::shared_ptr<Chain>>(from.form);
    const ActingEffects<Pack<4>>& effects = *chain.effects();
    const bool is_alike = equations.is_loaded == chain.is_loaded() &&
                          equations.has_couples == !effects.couples.empty() &&
                          equations.drag.is_there == !effects.entries.empty();
    if (!is_alike) return false;
    for (int i = 0; i < n; ++i) put_constants(equations.link[i], lane, chain.link(i));
    equations.payload_mass[lane] = chain.payload_mass();
    equations.gravity[lane] = chain.gravity();
    if (equations.has_couples) put_constants(equations.couples, lane, effects.couples.front());
    const auto* const drag = DragInLanes<EachLink<Real, n>>::law_of(effects);
    if (drag != nullptr) put_constants(equations.drag.law, lane, *drag);
    return equations.waves.put(lane, effects);
  }
};

}  // namespace pendcore
