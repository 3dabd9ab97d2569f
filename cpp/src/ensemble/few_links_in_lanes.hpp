/// \file
/// The equations of three and four links in lanes of Runge-Kutta methods: the recursion of
/// chain.hpp in registers.
#pragma once

#include <memory>

#include "dynamics/chain/chain.hpp"
#include "dynamics/row.hpp"
#include "ensemble/lane_equations.hpp"

namespace pendcore {

/// `coupled` are links with rotors between them.
template <class Real, int n, bool coupled>
struct FewLinksInLanes {
  using Links = EachLink<Real, n>;
  using Effects = EffectsInLanes<Links, Real>;
  static constexpr bool is_called = coupled || n > 3;
  static constexpr bool may_have_drag = true;
  /// Where they are not called: a step loops over its stages around one copy of them.
  static constexpr bool is_long = true;

  static bool has(const Scene& scene, const EquationsOfMotion& equations) {
    if (scene.links.size() != n || !equations.are_steady()) return false;
    const Chain& chain = *std::get<std::shared_ptr<Chain>>(equations.form);
    return chain.has_rotors() == coupled && !chain.effects()->any_held &&
           Effects::has(*chain.effects());
  }
  void prepare(const Scene& /*scene*/, const EquationsOfMotion& one) {
    const Chain& chain = *std::get<std::shared_ptr<Chain>>(one.form);
    is_loaded = chain.is_loaded();
    effects.prepare(*chain.effects(), n);
  }
  void put(int lane, const Scene& /*scene*/, const EquationsOfMotion& one) {
    const Chain& chain = *std::get<std::shared_ptr<Chain>>(one.form);
    for (int i = 0; i < n; ++i) {
      put_constants(link[i], lane, chain.link(i));
      if constexpr (coupled) rotor[i][lane] = chain.rotor(i);
    }
    payload_mass[lane] = chain.payload_mass();
    gravity[lane] = chain.gravity();
    effects.put(lane, *chain.effects());
  }
  const Drives<Real>* drives() const { return &effects; }

  /// As ChainOf computes it, in the same order.
  PENDCORE_INLINE Links accelerations(const Real& t, const Links& q, const Links& qd) const {
    Links s, c;
    sine_cosine(q, s, c);
    if (!is_loaded) return recursion<false>(qd, s, c, {}, {Real{}, Real(Real{} - gravity)});
    JointAcceleration<Real> of_pivot{};
    if (!effects.are_couples_alone) {
      effects.compute_waves(t, 0);
      effects.pivot_acceleration(t, of_pivot.x, of_pivot.y);
    }
    of_pivot.y = of_pivot.y - gravity;
    return recursion<true>(qd, s, c, loads(t, q, qd, s, c), of_pivot);
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
                              const Links& c) const {
    RowOfLinksAt<Links, Real> at{.q = q,
                                 .qd = qd,
                                 .s = s,
                                 .c = c,
                                 .L = length(),
                                 .t = t,
                                 .vx_of_joint = {},
                                 .vy_of_joint = {}};
    if (effects.has_forces) {
      Real x{}, y{};
      if (!effects.pivots.empty()) effects.pivot_velocity(t, x, y);
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
    for (const auto& one : effects.couples) sums.couple(one.torque(at));
    if (!effects.are_couples_alone) {
      for (const auto& one : effects.joint_waves) {
        Real& couple = sums.couples.of[one.joint];
        couple = couple + one.gain * effects.wave_sine[one.wave];
      }
      for (const auto& entry : effects.entries) Effects::add(entry, at, sums);
    }
    Loads found{(sums.moments + sums.couples) - after(sums.couples), {}, {}};
    if (effects.has_forces) {
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
    using Force = std::conditional_t<coupled, CoupledForce<Real>, JointForce<Real>>;
    Force force{.B = {payload_mass, Real{}, payload_mass}, .b_u = {}, .b_n = {}};
    std::conditional_t<coupled, CoupledResponse<Real>, FreeResponse<Real>> response[n];
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
      if constexpr (coupled) {
        response[i] = force.add(link[i], rotor[i], false, at);
      } else {
        response[i] = force.template add_free<loaded>(link[i], at);
      }
    }
    Links found;
    Real before{};
#pragma GCC unroll 4
    for (int i = 0; i < n; ++i) {
      Real free = response[i].free;
      if constexpr (coupled) free = fma(response[i].from_before, before, free);
      before = go_to_next_joint(FreeResponse<Real>{free, response[i].x, response[i].y}, s.of[i],
                                c.of[i], link[i].L, centripetal.of[i], of_joint);
      found.of[i] = before;
    }
    return found;
  }

  ChainLinkOf<Real> link[n] = {};
  Real rotor[coupled ? n : 1] = {};
  Real payload_mass = {}, gravity = {};
  bool is_loaded = false;
  Effects effects;
};

/// Calls use<Form>() with the form of a trajectory that Runge-Kutta methods take in lanes. Returns
/// whether there is one.
template <class Real, class Use>
bool with_runge_kutta_form(const Scene& scene, const EquationsOfMotion& equations, const Use& use) {
  return with_first_form<OneLinkInLanes<Real, true>, OneLinkInLanes<Real, false>,
                         TwoBareLinksInLanes<Real>, TwoLinksInLanes<Real, Parts::couples>,
                         TwoLinksInLanes<Real, Parts::waves>, TwoLinksInLanes<Real, Parts::laws>,
                         TwoLinksInLanes<Real, Parts::everything>, FewLinksInLanes<Real, 3, false>,
                         FewLinksInLanes<Real, 3, true>, FewLinksInLanes<Real, 4, false>,
                         FewLinksInLanes<Real, 4, true>>(scene, equations, use);
}

}  // namespace pendcore
