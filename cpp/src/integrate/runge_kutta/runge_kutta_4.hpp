/// \file
/// The classical method of Runge and Kutta, of order 4: what many write by hand.
///
/// It has four stages and no error estimate. All its steps have one size, which the user gives. A
/// fifth stage is the first of the next step, and makes the dense output: Hermite's cubic through
/// both ends and the slopes there, of order 3.
///
/// Source: Kutta, Beitrag zur naeherungsweisen Integration totaler Differentialgleichungen,
/// Zeitschrift fuer Mathematik und Physik 46 (1901), 435-453; Hairer, Norsett, Wanner, Solving
/// Ordinary Differential Equations I (1993), II.1, table 1.2; II.6, (6.7), for the dense output.
#pragma once

#include "integrate/runge_kutta/tableau.hpp"

namespace pendcore {

inline constexpr Tableau<5, 3> runge_kutta_4 = {
    .info = {.name = "rk4",
             .sentence = "The classical Runge-Kutta method, in fixed steps of ``step``.",
             .citation = "Kutta 1901; Hairer, Norsett & Wanner 1993, II.1",
             .order = 4,
             .error_order = 0,
             .interpolant_order = 3,
             .line = {.color = "quiet", .dash = ":", .marker = "P"}},
    .first_same_as_last = true,
    .c = {{{0}, {1, 2}, {1, 2}, {1}, {1}}},
    .a = {{{}, {{{1, 2}}}, {{{0}, {1, 2}}}, {{{0}, {0}, {1}}}, {{{1, 6}, {1, 3}, {1, 3}, {1, 6}}}}},
    .b = {{{1, 6}, {1, 3}, {1, 3}, {1, 6}, {0}}},
    .e = {},
    .interpolant = {{{{{1}}},
                     {{{-3, 2}, {1}, {1}, {1, 2}, {-1}}},
                     {{{2, 3}, {-2, 3}, {-2, 3}, {-1, 3}, {1}}}}},
};

}  // namespace pendcore
