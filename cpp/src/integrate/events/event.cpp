#include "pendcore/events.hpp"

#include "text/check.hpp"
#include "text/message.hpp"

namespace pendcore {
namespace {

void check_place(const std::string& where, const char* name, int number, int n) {
  if (number >= 1 && number <= n) return;
  const std::string range =
      n == std::numeric_limits<int>::max() ? ">= 1" : "1 to " + std::to_string(n);
  throw std::invalid_argument(where + name + " = " + std::to_string(number) + ": must be " + range);
}

void check_function(const std::string& where, const events::JointAngle& event, int n) {
  check_place(where, "joint", event.joint, n);
}

void check_function(const std::string& where, const events::LinkAngle& event, int n) {
  check_place(where, "link", event.link, n);
}

void check_function(const std::string& where, const events::RateZero& event, int n) {
  if (event.joint.has_value() == event.link.has_value()) {
    throw std::invalid_argument(where + "needs joint or link, one of the two");
  }
  check_place(where, event.joint ? "joint" : "link", event.joint ? *event.joint : *event.link, n);
}

void check_function(const std::string& where, const events::TipLine& event, int /*n*/) {
  if (event.normal[0] == 0.0 && event.normal[1] == 0.0) {
    throw std::invalid_argument(where + "normal = (0.0, 0.0): must point across the line");
  }
}

void check_function(const std::string& where, const events::Function& event, int /*n*/) {
  if (!event.f) throw std::invalid_argument(where + "f: is empty: must be a function");
  if (event.samples < 1 || event.samples > 1'000'000) {
    throw std::invalid_argument(where + "samples = " + std::to_string(event.samples) +
                                ": must be 1 to 1000000 in each step");
  }
  if (!(event.max_step > 0.0)) refuse(where + "max_step", event.max_step, "> 0 (s)");
}

}  // namespace

std::string event_name(const Event& event, std::size_t i) {
  const std::string name = event.name.empty() ? "" : ", '" + event.name + "'";
  return "event " + std::to_string(i + 1) + " (" + std::string(event.kind()) + name + ")";
}

void check_event(const std::string& where, const Event& event, int n) {
  std::visit(
      [&](const auto& one) {
        check_function(where, one, n);
        for_each_parameter(one, [&]<class Value>(const ParameterInfo& info, const Value& value) {
          // The counts have ranges of their own.
          if constexpr (!std::integral<Value>) check_value(where, info, value);
        });
      },
      event.function);
  if (event.direction < -1 || event.direction > 1) {
    throw std::invalid_argument(where + "direction = " + std::to_string(event.direction) +
                                ": must be 1 (rising), -1 (falling) or 0 (both)");
  }
  if (event.terminal < 0) {
    throw std::invalid_argument(
        where + "terminal = " + std::to_string(event.terminal) +
        ": must be >= 0, the number of occurrences that end the run, 0 for none");
  }
}

}  // namespace pendcore
