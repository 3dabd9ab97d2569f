#include "pendcore/methods.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "integrate/method_list.hpp"

namespace pendcore {

std::span<const MethodInfo* const> methods() { return Methods::infos; }

const MethodInfo& find_method(std::string_view name, std::string_view or_else) {
  for (const MethodInfo* info : methods()) {
    if (info->name == name) return *info;
    if (std::ranges::find(info->aliases, name) != info->aliases.end()) return *info;
  }
  std::string known(or_else);
  for (const MethodInfo* info : methods()) {
    known += (known.empty() ? "" : ", ") + std::string(info->name);
    for (std::string_view alias : info->aliases) known += ", " + std::string(alias);
  }
  throw std::invalid_argument("method = \"" + std::string(name) + "\": must be one of " + known);
}

}  // namespace pendcore
