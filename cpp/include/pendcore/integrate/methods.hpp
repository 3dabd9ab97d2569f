/// \file
/// THE LIST of methods. A new one is a file with its table and a line here (CONTRIBUTING.md); the
/// Python layer and the tests of order conditions, convergence, dense output and bits find it.
#pragma once

#include "pendcore/integrate/automatic.hpp"
#include "pendcore/integrate/dormand_prince_5.hpp"
#include "pendcore/integrate/radau_5.hpp"

namespace pendcore {

template <const auto&... tables>
struct MethodList {
  static constexpr std::array infos = {&tables.info...};
};

using Methods = MethodList<dormand_prince_5,  // order 5(4): the textbook's ode45
                           radau_5,           // order 5, implicit: stiff scenes
                           automatic          // the first, and the second once it is stiff
                           >;

/// The method of that name or alias; throws std::invalid_argument that lists those there are.
const MethodInfo& find_method(std::string_view name);

}  // namespace pendcore
