#pragma once

#include <optional>

#include "pendcore/simulate/option_info.hpp"

namespace pendcore {

struct FirstStepOption {
  std::optional<double> first_step;
  static constexpr auto field = &FirstStepOption::first_step;

  static constexpr OptionInfo info = {
      .name = "first_step",
      .unit = "s",
      .if_none = "Hairer's rule chooses it from the start, or the first Taylor series does",
      .sentence = "The step to try first.",
  };
};

}  // namespace pendcore
