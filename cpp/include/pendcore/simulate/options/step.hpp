#pragma once

#include <optional>

#include "pendcore/simulate/option_info.hpp"

namespace pendcore {

struct StepOption {
  std::optional<double> step;
  static constexpr auto field = &StepOption::step;

  static constexpr OptionInfo info = {
      .name = "step",
      .unit = "s",
      .if_none = "steps by the tolerances",
      .sentence =
          "A fixed step in place of the tolerances. It excludes ``first_step`` and a smaller "
          "``max_step``. An implicit method still solves its equations to the tolerances.",
      .chosen_for_error = true,
  };

  void limit(Limits& limits) const { limits.fixed_step = step.has_value(); }
};

}  // namespace pendcore
