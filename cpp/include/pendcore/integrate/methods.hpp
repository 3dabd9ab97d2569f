/// \file
/// THE LIST of methods. A new one is a file with its table and a line here (CONTRIBUTING.md); the
/// Python layer and the tests of order conditions, convergence, dense output and bits find it.
#pragma once

#include "pendcore/integrate/radau/radau_5.hpp"
#include "pendcore/integrate/runge_kutta/dormand_prince_5.hpp"
#include "pendcore/integrate/runge_kutta/dormand_prince_8.hpp"
#include "pendcore/integrate/runge_kutta/runge_kutta_4.hpp"
#include "pendcore/integrate/stiff_switching.hpp"
#include "pendcore/integrate/taylor/taylor.hpp"

namespace pendcore {

template <const auto&... tables>
struct MethodList {
  static constexpr std::array infos = {&tables.info...};
};

using Methods = MethodList<dormand_prince_5,  // order 5(4): the textbook's ode45
                           dormand_prince_8,  // order 8(5,3): tight tolerances
                           taylor,            // order by the tolerance: to the rounding limit
                           runge_kutta_4,     // order 4, fixed steps: the yardstick
                           radau_5,           // order 5, implicit: stiff scenes
                           dopri5_radau5,     // the first, and the second once it is stiff
                           dop853_radau5,     // the same, for tight tolerances
                           taylor_radau5      // the same, where there is a series
                           >;

/// The method of that name or alias; throws std::invalid_argument that lists those there are, after
/// what else the caller takes. "auto" is a rule and no method: method_choice.hpp.
const MethodInfo& find_method(std::string_view name, std::string_view or_else = {});

}  // namespace pendcore
