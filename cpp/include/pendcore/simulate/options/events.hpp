#pragma once

#include <vector>

#include "pendcore/integrate/events/event.hpp"
#include "pendcore/simulate/option_info.hpp"

namespace pendcore {

struct EventsOption {
  std::vector<Event> events;
  static constexpr auto field = &EventsOption::events;

  static constexpr OptionInfo info = {
      .name = "events",
      .type = "iterable of pendcore.events.Event",
      .sentence =
          "Events to look for; ``sol.events`` has a list for each. Events change no step. A "
          "``terminal`` event ends the run, with status ``event``.",
  };
};

}  // namespace pendcore
