#include "pendcore/integrate/methods.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace pendcore {

const MethodInfo& find_method(std::string_view name, std::string_view or_else) {
  for (const MethodInfo* info : Methods::infos) {
    if (info->name == name) return *info;
    if (std::ranges::find(info->aliases, name) != info->aliases.end()) return *info;
  }
  std::string known(or_else);
  for (const MethodInfo* info : Methods::infos) {
    known += (known.empty() ? "" : ", ") + std::string(info->name);
    for (std::string_view alias : info->aliases) known += ", " + std::string(alias);
  }
  throw std::invalid_argument("method = \"" + std::string(name) + "\": must be one of " + known);
}

}  // namespace pendcore
