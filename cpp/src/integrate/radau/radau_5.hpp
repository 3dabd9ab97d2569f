/// \file
/// Radau IIA of order 5, for stiff scenes: strong damping, hard springs, stiff controllers.
///
/// Three stages at the zeros of d^2/dx^2 (x^2 (x - 1)^3),
///
///     c = ((4 - sqrt 6)/10, (4 + sqrt 6)/10, 1),
///
/// the last at the end of the step. It is of order 5, stiffly accurate and L-stable: a component
/// that decays much faster than the step is gone after it. The polynomial is of order 4.
///
/// Source: Hairer and Wanner, Solving Ordinary Differential Equations II (1996), IV.5 and IV.8, as
/// in the program RADAU5. The numbers are derived in sixty digits by tests/reference/radau_iia.py
/// and rounded once; eigenvectors are scaled to end in 1.
#pragma once

#include "integrate/radau/collocation.hpp"

namespace pendcore {

inline constexpr std::array<std::string_view, 1> radau_5_aliases = {"Radau"};

inline constexpr Collocation radau_5 = {
    .info = {.name = "radau5",
             .aliases = radau_5_aliases,
             .sentence =
                 "Radau IIA, implicit, for stiff scenes: strong damping, hard springs, stiff "
                 "controllers.",
             .citation = "Hairer & Wanner 1996, IV.5 and IV.8",
             .kind = MethodKind::implicit_one,
             .order = 5,
             .error_order = 3,
             .interpolant_order = 4,
             .growth = 8.0,
             .retry = 0.5,
             .error_over_rtol = 1.0,
             .second_opinion = 4,
             .line = {.color = "green", .dash = "-.", .marker = "^"}},
    .c = {0.1550510257216822, 0.6449489742783178, 1.0},
    .a = {{{0.1968154772236604, -0.06553542585019839, 0.02377097434822015},
           {0.3944243147390873, 0.2920734116652285, -0.04154875212599793},
           {0.37640306270046725, 0.5124858261884216, 0.1111111111111111}}},
    .real = 3.637834252744496,
    .alpha = 2.6810828736277523,
    .beta = 3.0504301992474105,
    .transformation = {{{0.09443876248897524, -0.1412552950209542, -0.030029194105147424},
                        {0.2502131229653333, 0.20412935229379994, 0.3829421127572619},
                        {1.0, 1.0, 0.0}}},
    .inverse = {{{4.178718591551905, 0.32768282076106237, 0.5233764454994495},
                 {-4.178718591551905, -0.32768282076106237, 0.47662355450055044},
                 {-0.5028726349457868, 2.571926949855605, -0.5960392048282249}}},
    .interpolant = {{{10.048809399827416, -1.382142733160749, 0.3333333333333333},
                     {-25.62959144707664, 10.296258113743306, -2.6666666666666665},
                     {15.580782047249224, -8.914115380582556, 3.3333333333333335}}},
    .correction = {1.0, -4.5, 6.0, -2.5},
};

}  // namespace pendcore
