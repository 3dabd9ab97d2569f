#include "arithmetic/instruction_set.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <string_view>

namespace pendcore {
namespace {

InstructionSet best_of_processor() {
#if PENDCORE_CLONES
  __builtin_cpu_init();
  const bool v3 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                  __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2") &&
                  __builtin_cpu_supports("lzcnt") && __builtin_cpu_supports("movbe") &&
                  __builtin_cpu_supports("f16c");
  const bool v4 = v3 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
                  __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
                  __builtin_cpu_supports("avx512vl");
  if (v4) return InstructionSet::x86_64_v4;
  if (v3) return InstructionSet::x86_64_v3;
#endif
  return InstructionSet::baseline;
}

InstructionSet allowed_by_environment() {
  const char* wish = std::getenv("PENDCORE_INSTRUCTION_SET");
  if (wish == nullptr) return InstructionSet::x86_64_v4;
  for (const InstructionSet set :
       {InstructionSet::baseline, InstructionSet::x86_64_v3, InstructionSet::x86_64_v4}) {
    if (std::string_view(wish) == name(set)) return set;
  }
  throw std::invalid_argument("PENDCORE_INSTRUCTION_SET = " + std::string(wish) +
                              ": must be baseline, x86-64-v3 or x86-64-v4");
}

}  // namespace

InstructionSet instruction_set() {
  static const InstructionSet chosen = std::min(best_of_processor(), allowed_by_environment());
  return chosen;
}

const char* name(InstructionSet set) {
  static constexpr std::array names = {"baseline", "x86-64-v3", "x86-64-v4"};
  return names[static_cast<std::size_t>(set)];
}

}  // namespace pendcore
