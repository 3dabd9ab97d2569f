/// \file
/// The list of methods. A new method is a file with its table, and a line here (CONTRIBUTING.md).
/// The Python layer and the tests of order conditions, convergence, dense output and bits find it.
#pragma once

#include "integrate/radau/radau_5.hpp"
#include "integrate/runge_kutta/dormand_prince_5.hpp"
#include "integrate/runge_kutta/dormand_prince_8.hpp"
#include "integrate/runge_kutta/runge_kutta_4.hpp"
#include "integrate/stiff_switching.hpp"
#include "integrate/taylor/taylor.hpp"

namespace pendcore {

template <const auto&... tables>
struct MethodList {
  static constexpr std::array infos = {&tables.info...};

  /// Calls use<table>() with the table of the method of that name.
  template <class Use>
  static void with(std::string_view name, const Use& use) {
    // The first one alone, for a caller may give what it has away.
    ((tables.info.name == name && (use.template operator()<tables>(), true)) || ...);
  }
};

using Methods = MethodList<dormand_prince_5,  // order 5(4): the textbook's ode45
                           dormand_prince_8,  // order 8(5,3): tight tolerances
                           taylor,            // order by the tolerance: to the rounding limit
                           runge_kutta_4,     // order 4, fixed steps: the yardstick
                           radau_5,           // order 5, implicit: stiff scenes
                           dopri5_radau5,     // dopri5, and radau5 from where the run is stiff
                           dop853_radau5,     // the same, for tight tolerances
                           taylor_radau5      // the same, where there is a series
                           >;

}  // namespace pendcore
