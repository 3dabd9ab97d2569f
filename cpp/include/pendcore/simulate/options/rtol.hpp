#pragma once

#include <vector>

#include "pendcore/simulate/option_info.hpp"

namespace pendcore {

struct RtolOption {
  std::vector<double> rtol = {1e-9};  ///< one, or one for each of the 2n components
  static constexpr auto field = &RtolOption::rtol;

  static constexpr OptionInfo info = {
      .name = "rtol",
      .type = "float or (2n,)",
      .sentence =
          "The error of a step is kept below ``atol + rtol abs(y)``, in root mean square over ``y"
          " = (q, qd)``. A Taylor series has no error estimate: its last coefficients choose the "
          "step.",
      .chosen_for_error = true,
  };
};

}  // namespace pendcore
