#pragma once

#include <vector>

#include "pendcore/simulate/option_info.hpp"

namespace pendcore {

struct AtolOption {
  std::vector<double> atol = {1e-12};  ///< one, or one for each of the 2n components
  static constexpr auto field = &AtolOption::atol;

  static constexpr OptionInfo info = {
      .name = "atol",
      .unit = "rad, rad/s",
      .range = {.includes_least = true},
      .type = "float or (2n,)",
      .sentence = "The absolute part of that bound.",
      .chosen_for_error = true,
  };
};

}  // namespace pendcore
