#pragma once

#include "pendcore/simulate/option_info.hpp"

namespace pendcore {

struct MaxStepsOption {
  long long max_steps = 10'000'000;
  static constexpr auto field = &MaxStepsOption::max_steps;

  static constexpr OptionInfo info = {
      .name = "max_steps",
      .range = {.least = 1, .includes_least = true, .includes_infinity = true},
      .sentence = "The run ends with status ``max_steps`` after this many attempted steps.",
  };

  void limit(Limits& limits) const { limits.max_steps = max_steps; }
};

}  // namespace pendcore
