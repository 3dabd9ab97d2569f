#pragma once

#include <string>
#include <string_view>

#include "pendcore/simulate/option_info.hpp"

namespace pendcore {

/// The method of a run that names none: method_choice.hpp has the rule.
inline constexpr std::string_view automatic = "auto";

struct MethodOption {
  std::string method{automatic};
  static constexpr auto field = &MethodOption::method;

  static constexpr OptionInfo info = {
      .name = "method",
      .sentence =
          "``\"auto\"`` chooses by scene and tolerances; ``sol.method`` says which method it "
          "chose. A run in fixed steps takes ``\"dopri5\"``. Two links or more whose effects all "
          "have Taylor series take ``\"taylor-radau5\"``. Other scenes take "
          "``\"dop853-radau5\"``, or ``\"dopri5-radau5\"`` where ``max(rtol, atol)`` is 1e-6 or "
          "more in all components. Each of these pairs gives the bits of its first method until "
          "stability limits the steps and ``\"radau5\"`` can take steps ten times as long; the "
          "run then continues with ``\"radau5\"``."
          "\n{methods}",
      .chosen_for_error = true,
  };
};

}  // namespace pendcore
