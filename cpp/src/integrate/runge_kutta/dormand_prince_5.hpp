/// \file
/// Dormand-Prince 5(4): the method of MATLAB's ode45 and of the textbook.
///
/// Seven stages, the last of which is the first of the next step; order 5, with an embedded method
/// of order 4 for the error; a continuous extension of order 4 that costs no further evaluation.
///
/// Sources: Dormand and Prince, A family of embedded Runge-Kutta formulae, J. Comp. Appl. Math. 6
/// (1980), 19-26, table 2. Interpolant: Hairer, Norsett, Wanner, Solving Ordinary Differential
/// Equations I (1993), II.6, as in the program DOPRI5 (Shampine 1986), here in powers of theta.
/// Step control: ibid. II.4 and, with beta, Hairer and Wanner, volume II (1996), IV.2.
#pragma once

#include "integrate/runge_kutta/tableau.hpp"

namespace pendcore {

inline constexpr std::array<std::string_view, 2> dormand_prince_5_aliases = {"RK45", "ode45"};

inline constexpr Tableau<7, 4> dormand_prince_5 = {
    .info = {.name = "dopri5",
             .aliases = dormand_prince_5_aliases,
             .sentence =
                 "Dormand-Prince 5(4) with dense output: loose tolerances, and ode45's method.",
             .citation = "Dormand & Prince 1980; Hairer, Norsett & Wanner 1993, II.5-6",
             .order = 5,
             .error_order = 4,
             .interpolant_order = 4,
             .beta = 0.04,
             .stability = 3.25,
             .error_over_rtol = 3.0,
             .second_opinion = 3,
             .line = {.color = "blue", .dash = "-", .marker = "o"}},
    .first_same_as_last = true,
    .written_out = true,
    .c = {{{0}, {1, 5}, {3, 10}, {4, 5}, {8, 9}, {1}, {1}}},
    .a = {{{},
           {{{1, 5}}},
           {{{3, 40}, {9, 40}}},
           {{{44, 45}, {-56, 15}, {32, 9}}},
           {{{19372, 6561}, {-25360, 2187}, {64448, 6561}, {-212, 729}}},
           {{{9017, 3168}, {-355, 33}, {46732, 5247}, {49, 176}, {-5103, 18656}}},
           {{{35, 384}, {0}, {500, 1113}, {125, 192}, {-2187, 6784}, {11, 84}}}}},
    .b = {{{35, 384}, {0}, {500, 1113}, {125, 192}, {-2187, 6784}, {11, 84}, {0}}},
    .e = {{{71, 57600}, {0}, {-71, 16695}, {71, 1920}, {-17253, 339200}, {22, 525}, {-1, 40}}},
    .interpolant = {{
        {{{1}}},
        {{{-8048581381, 2820520608},
          {0},
          {131558114200, 32700410799},
          {-1754552775, 470086768},
          {127303824393, 49829197408},
          {-282668133, 205662961},
          {40617522, 29380423}}},
        {{{8663915743, 2820520608},
          {0},
          {-68118460800, 10900136933},
          {14199869525, 1410260304},
          {-318862633887, 49829197408},
          {2019193451, 616988883},
          {-110615467, 29380423}}},
        {{{-12715105075, 11282082432},
          {0},
          {87487479700, 32700410799},
          {-10690763975, 1880347072},
          {701980252875, 199316789632},
          {-1453857185, 822651844},
          {69997945, 29380423}}},
    }},
};

}  // namespace pendcore
