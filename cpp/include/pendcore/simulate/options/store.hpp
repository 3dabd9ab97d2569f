#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "pendcore/simulate/option_info.hpp"

namespace pendcore {

/// What is kept of a run. The last mode keeps everything; the first two need constant memory.
enum class Store {
  end,    ///< the end
  times,  ///< the times asked for
  steps,  ///< every accepted step
  dense,  ///< the polynomials, with the times asked for or else with every accepted step
};

inline constexpr std::array<std::string_view, 4> store_names = {"end", "times", "steps", "dense"};

constexpr std::string_view store_name(Store store) {
  return store_names[static_cast<std::size_t>(store)];
}

/// The mode of that name, if there is one.
constexpr std::optional<Store> find_store(std::string_view name) {
  for (std::size_t i = 0; i < store_names.size(); ++i) {
    if (store_names[i] == name) return static_cast<Store>(i);
  }
  return std::nullopt;
}
/// What a message says where no mode has the given name.
inline constexpr std::string_view must_be_store = R"(must be "dense", "steps", "times" or "end")";

struct StoreOption {
  std::optional<Store> store;
  static constexpr auto field = &StoreOption::store;

  static constexpr OptionInfo info = {
      .name = "store",
      .type = "{\"dense\", \"steps\", \"times\", \"end\"}",
      .if_none = "``\"times\"`` with ``t_eval``, otherwise ``\"dense\"``",
      .sentence =
          "Which states the run keeps. ``\"dense\"`` keeps every step with its interpolant, "
          "``\"steps\"`` every step, ``\"times\"`` only those of ``t_eval``, and ``\"end\"`` only"
          " the last. The last two take constant memory.",
  };
};

}  // namespace pendcore
