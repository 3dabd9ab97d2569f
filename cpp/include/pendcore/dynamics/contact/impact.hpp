/// \file
/// Impacts of joints on their stops, by HeldJoints (held_joints.hpp), in turn by Switching.
///
/// With w the rates of joints, positive away from the stop that they touch, and impulses Lambda,
/// both as in the problem of joint_forces.hpp, two laws follow each other:
///
/// 1. Newton's, over the closed stops that no joint leaves (w- <= 0), each with its own e:
///
///        0 <= Lambda,  w+ + e w- >= 0,  Lambda (w+ + e w-) = 0
///
///    e = 0 below the capture speed. A joint that was leaving its stop and is thrown back strikes
///    in turn, at the same time: so do joints whose impacts alternate ever faster between their
///    stops, once time cannot tell them apart. Hence a joint at rest at its stop that nothing
///    pushes there counts as leaving; where a run begins, none does.
/// 2. A joint that is pushed back to its stop is captured if it did not bounce and leaves more
///    slowly than the capture speed, or if it is there again before time can tell: a last blow
///    stops it, plastic at all closed stops. The rates v+ are the nearest to v- in |v|^2 = v.M v
///    with w+ = 0 for the captured joints and w+ >= 0 for the others.
///
/// Neither adds energy, T+ - T- = Lambda.(w+ + w-)/2. In 1, Lambda_i > 0 only where
/// w_i+ = -e_i w_i-: the terms of the sum are (1 - e_i) Lambda_i w_i-/2 <= 0, whatever the e, and
/// w_i+ >= -e_i w_i- >= 0 leads into no stop. In 2, the rates allowed are a convex cone and v+ is
/// the projection on it: T- - T+ = |v+ - v-|^2/2. Both at one stroke would: a captured joint may
/// have to be pulled, and bilateral constraints beside contacts of other restitution are what
/// Glocker finds inconsistent. With one e for all, 1 is Moreau's v+ = (1 + e) v_c - e v-, with v_c
/// after a plastic impact.
/// Friction gives no impulse.
/// Sources: Moreau, in Nonsmooth Mechanics and Applications (1988), for 2 and equal e; Glocker,
/// Multibody System Dynamics 29 (2013) 77, for which restitutions keep Newton's law consistent.
#pragma once

namespace pendcore {

/// Joints that throw each other back strike in turn at one time, as often as the angle between
/// their stops in the metric M says, or for ever, ever more slowly: by then below all rounding.
inline constexpr int most_impacts_at_once = 10'000;

/// In natural speeds of the chain: rates that are slower change little.
inline constexpr double noticeable_rate = 1e-6;

}  // namespace pendcore
