#pragma once

#include <vector>

#include "pendcore/simulate/option_info.hpp"

namespace pendcore {

struct TEvalOption {
  std::vector<double> t_eval;  ///< strictly monotone along the run
  static constexpr auto field = &TEvalOption::t_eval;

  static constexpr OptionInfo info = {
      .name = "t_eval",
      .unit = "s",
      .type = "array_like, (k,)",
      .if_none = "every step",
      .sentence =
          "Times of the result, one or more, within the run and in its order. They do not change "
          "the steps. Times that the run does not reach are missing from the result.",
  };
};

}  // namespace pendcore
