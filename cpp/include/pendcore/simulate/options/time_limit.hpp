#pragma once

#include <limits>
#include <optional>

#include "pendcore/simulate/option_info.hpp"

namespace pendcore {

struct TimeLimitOption {
  std::optional<double> time_limit;
  static constexpr auto field = &TimeLimitOption::time_limit;

  static constexpr OptionInfo info = {
      .name = "time_limit",
      .unit = "s",
      .range = {.includes_infinity = true},
      .if_none = "no limit",
      .sentence =
          "Wall-clock time, after which the run ends with status ``time_limit`` and keeps what it "
          "has.",
  };

  void limit(Limits& limits) const {
    limits.time_limit = time_limit.value_or(std::numeric_limits<double>::infinity());
  }
};

}  // namespace pendcore
