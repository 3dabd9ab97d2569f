#include "text/check.hpp"

#include <stdexcept>
#include <string>

#include "text/message.hpp"

namespace pendcore {
namespace {

std::string named(std::string_view where, const ParameterInfo& info) {
  return std::string(where) + std::string(info.name);
}

[[noreturn]] void refuse_number(const std::string& name, const ParameterInfo& info, double value) {
  std::string range(text(info.range));
  if (!info.unit.empty() && info.unit != "1") range += " (" + std::string(info.unit) + ")";
  refuse(name, value, range);
}

}  // namespace

void check_number(std::string_view where, const ParameterInfo& info, double value) {
  if (!holds(info.range, value)) refuse_number(named(where, info), info, value);
}

void check_numbers(std::string_view where, const ParameterInfo& info,
                   std::span<const double> values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (holds(info.range, values[i])) continue;
    std::string name = named(where, info);
    if (values.size() > 1 || !info.one_may_stand_for_all) name += "[" + std::to_string(i) + "]";
    refuse_number(name, info, values[i]);
  }
}

void check_count(std::string_view where, const ParameterInfo& info, long long value) {
  if (value >= 1) return;
  throw std::invalid_argument(named(where, info) + " = " + std::to_string(value) + ": must be " +
                              std::string(text(Range::count)));
}

}  // namespace pendcore
