#pragma once

#include <limits>

#include "pendcore/simulate/option_info.hpp"

namespace pendcore {

struct MaxStepOption {
  double max_step = std::numeric_limits<double>::infinity();
  static constexpr auto field = &MaxStepOption::max_step;

  static constexpr OptionInfo info = {
      .name = "max_step",
      .unit = "s",
      .range = {.includes_infinity = true},
      .sentence = "No step is longer.",
      .limits_every_method = true,
  };

  void limit(Limits& limits) const { limits.max_step = max_step; }
};

}  // namespace pendcore
