#pragma once

#include "pendcore/simulate/option_info.hpp"

namespace pendcore {

struct CompensatedOption {
  bool compensated = false;
  static constexpr auto field = &CompensatedOption::compensated;

  static constexpr OptionInfo info = {
      .name = "compensated",
      .sentence =
          "Whether each step carries the rounding error of the state over to the next step "
          "(compensated summation), for long runs at small steps. ``docs/background/long_runs.md`` "
          "says when that pays.",
  };
};

}  // namespace pendcore
