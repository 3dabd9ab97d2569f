#pragma once

#include "pendcore/simulate/option_info.hpp"

namespace pendcore {

struct LedgerOption {
  bool ledger = false;
  static constexpr auto field = &LedgerOption::ledger;

  static constexpr OptionInfo info = {
      .name = "ledger",
      .sentence =
          "Whether ``sol.energy().ledger`` has the work and loss of every effect. They are "
          "integrated beside the state and change no bit of it.",
  };
};

}  // namespace pendcore
