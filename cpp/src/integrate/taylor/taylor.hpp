/// \file
/// Taylor series of the solution itself. The order follows from the tolerances, and the step from
/// the series.
///
///     y(t + theta sigma) = sum_{k <= p} theta^k y_k,    y_k from the equations' recurrences
///
/// **Order.** p = 5 + 1.5 digits, rounded to an even number from 8 on, with 10^-digits the smallest
/// tolerance: up to 26, as no rtol is taken below ten units of rounding. That is above the usual p
/// = 1 + 1.15 digits, because one more order costs less than the longer step saves.
///
/// **Step.** h = (1 / e)^(1/p), with e the size of y_p over the tolerances. By symmetry single
/// coefficients may vanish (of a chain that starts at rest with all links horizontal, three of
/// four do): with N and M the sums of squares of the last four and of the four before, the series
/// decays as r^-k, r^8 = M/N, and e is the largest of N^(1/2) r^-3, |y_p| and |y_{p-1}|/r.
///
/// **Scale.** sigma is a power of two near the step before, so that coefficients do not overflow in
/// any unit of time. The series does not depend on sigma, but the last bits of the next step size
/// do; a continued run keeps sigma.
///
/// A step ends with the series of the next step, whose size is then known. So steps are only
/// rejected if something else chose their size. The dense output is the series, of order p
/// throughout.
///
/// **Quadratures** beside the state, such as the ledger's, do not affect the steps: their rates are
/// evaluated at eight points of a step (gauss_quadrature.hpp).
///
/// **Stiffness.** The series of a part that decays fast and is of the size of the tolerances limits
/// h |lambda| to about (p!)^(1/p), some 0.4 p: the step has to be that short although the part is
/// too small to be seen. dominant_eigenvalue.hpp finds this lambda; the run counts as stiff from
/// 0.3 p on. A part that oscillates well above the tolerances has shorter steps, which follow it.
///
/// Source: Jorba and Zou, A software package for the numerical integration of ODEs by means of
/// high-order Taylor methods, Exp. Math. 14 (2005), for the method; the order and the step size are
/// this project's own, from its measurements. Cost: one series a step, which counts as one
/// right-hand side in the statistics (the recurrences: dynamics/series/double_pendulum_series.hpp).
#pragma once

#include "integrate/runge_kutta/tableau.hpp"

namespace pendcore {

/// Names the method; its order depends on the tolerances.
struct TaylorSeries {
  MethodInfo info;
};

inline constexpr TaylorSeries taylor = {
    .info = {.name = "taylor",
             .sentence = "Taylor series of an order that the tolerances choose: the quickest from "
                         "some 1e-6 down, right to the rounding limit; refuses rod drag, Stribeck "
                         "friction and functions of your own.",
             .citation = "Jorba & Zou 2005",
             .kind = MethodKind::taylor_one,
             .order = 20,
             .error_order = 7,
             .interpolant_order = 20,
             .shrink = 1e-10,
             .growth = 1e10,
             .stability = 0.3,
             .dense_output_is_series = true,
             .error_over_rtol = 0.9,
             .second_opinion = 1,
             .line = {.color = "ink", .dash = "-", .marker = "D"}}};

inline constexpr int lowest_taylor_order = 8;  ///< the step looks at eight coefficients

/// The order for tolerances of which this is the smallest.
int taylor_order(double tolerance);

}  // namespace pendcore
