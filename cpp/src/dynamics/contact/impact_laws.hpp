/// \file
/// The laws of impacts of joints on their stops. HeldJoints (held_joints.hpp) computes them, in
/// impact_laws.cpp, and Impacts (simulate/impacts.hpp) applies them in turn.
///
/// Let w be the rates of joints, positive away from the stop that they touch, and Lambda the
/// impulses, both as in the problem of joint_forces.hpp. Two laws follow each other:
///
/// 1. Newton's law at the closed stops that no joint leaves (w- <= 0), each with its own e:
///
///        0 <= Lambda,  w+ + e w- >= 0,  Lambda (w+ + e w-) = 0
///
///    e = 0 below the capture speed. A joint that was leaving its stop and is thrown back strikes
///    it in a later impact at the same time. So do joints whose impacts alternate faster and faster
///    between their stops, once double precision cannot tell the times apart. To treat both alike,
///    a joint at rest at its stop counts as leaving it unless something pushes it against the stop;
///    at the start of a run, no joint counts as leaving.
/// 2. A joint that is pushed back to its stop is captured if it did not bounce and leaves more
///    slowly than the capture speed, or if it is back before double precision can tell the times
///    apart. A last impact, plastic at all closed stops, stops it. The rates v+ are the nearest to
///    v- in |v|^2 = v.M v with w+ = 0 for the captured joints and w+ >= 0 for the others.
///
/// Neither law adds energy; the change is T+ - T- = Lambda.(w+ + w-)/2. In law 1, Lambda_i > 0 only
/// where w_i+ = -e_i w_i-. So the terms of the sum are (1 - e_i) Lambda_i w_i-/2 <= 0 for all e_i,
/// and w_i+ >= -e_i w_i- >= 0 moves no joint into its stop. In law 2, the admissible rates are a
/// convex cone and v+ is the projection on it: T- - T+ = |v+ - v-|^2/2. A single law for both could
/// add energy: a captured joint may have to be pulled, and bilateral constraints beside contacts
/// with other restitutions are what Glocker finds inconsistent. If all e are equal, law 1 is
/// Moreau's v+ = (1 + e) v_c - e v-, where v_c are the rates after a plastic impact. Friction gives
/// no impulse.
/// Sources: Moreau, in Nonsmooth Mechanics and Applications (1988), for 2 and equal e; Glocker,
/// Multibody System Dynamics 29 (2013) 77, for which restitutions keep Newton's law consistent.
#pragma once

namespace pendcore {

/// Joints that throw each other back strike in turn at one time. The number of impacts follows from
/// the angle between their stops in the metric M, or they go on without end and ever more slowly.
/// After this many, their rates are below all rounding.
inline constexpr int most_impacts_at_once = 10'000;

/// In units of the chain's natural speed; slower rates change little.
inline constexpr double noticeable_rate = 1e-6;

}  // namespace pendcore
