/// \file
/// Going through the numbers of a structure of constants: one function for every structure.
///
/// A structure lists its numbers, rows, arrays and smaller structures once:
///
///     template <class Any>
///     static auto fields(Any& x) {
///       return std::tie(x.m, x.L);
///     }
#pragma once

#include <cstddef>
#include <tuple>
#include <type_traits>
#include <utility>

namespace pendcore {

template <class Structure>
concept HasFields = requires(Structure& x) { Structure::fields(x); };

/// Calls use(to, from) with each number, or row of numbers, of two structures that are alike.
template <class To, class From, class Use>
void each_field(To& to, const From& from, const Use& use) {
  if constexpr (HasFields<To>) {
    const auto into = To::fields(to);
    const auto given = From::fields(from);
    static_assert(std::tuple_size_v<decltype(into)> == std::tuple_size_v<decltype(given)>);
    [&]<std::size_t... i>(std::index_sequence<i...>) {
      (each_field(std::get<i>(into), std::get<i>(given), use), ...);
    }(std::make_index_sequence<std::tuple_size_v<decltype(into)>>{});
  } else if constexpr (std::is_array_v<To>) {
    for (std::size_t i = 0; i < std::extent_v<To>; ++i) each_field(to[i], from[i], use);
  } else {
    use(to, from);
  }
}

}  // namespace pendcore
