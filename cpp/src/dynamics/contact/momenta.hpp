/// \file
/// The momenta p = M qd of the links, summed link by link in two doubles.
///
///     v_C = v + c qd n,  v_next = v + L qd n         from the pivot to the tip
///     p = n . (c m v_C + L P_next) + I qd,  P = m v_C + P_next       and back
///
/// A heavy link on light ones makes entries of M that cancel in p: a product with M loses as many
/// digits as the condition of M has. The velocities of mass centres do not cancel, so that p has
/// its error from the sines and cosines alone. A payload is a mass and an inertia at the tip; a
/// rotor adds J phid to its link and takes it from the link before. (n) each, kg m^2/s. Cost: some
/// 300 operations for each link.
#pragma once

#include <span>
#include <vector>

#include "arithmetic/two_double.hpp"
#include "dynamics/inertia.hpp"

namespace pendcore {

std::vector<TwoDouble> momenta(std::span<const Link> links, const Inertia& inertia,
                               std::span<const double> sine, std::span<const double> cosine,
                               const double* qd);

/// qd.p, twice the kinetic energy, J.
TwoDouble twice_the_energy(const std::vector<TwoDouble>& p, const double* qd);

}  // namespace pendcore
