/// \file
/// Numbers in memory, one for each link, wave or order.
#pragma once

#include <cstddef>
#include <vector>

#include "arithmetic/dual_rows.hpp"
#include "arithmetic/pair.hpp"

namespace pendcore {

/// `Number` is a double, or a pack with a trajectory in each lane. `Row` is as many numbers as
/// `places`, side by side.
template <class Row, class Number>
class RowsInMemory {
  static constexpr int lanes = Lanes<Number>::width;

 public:
  static constexpr int places = Lanes<Row>::width / lanes;

  void assign(std::size_t count) { numbers_.assign(count * lanes, 0.0); }
  PENDCORE_INLINE Number operator[](std::ptrdiff_t i) const {
    return load<Number>(numbers_.data() + i * lanes);
  }
  PENDCORE_INLINE void set(std::ptrdiff_t i, const Number& x) {
    store(numbers_.data() + i * lanes, x);
  }
  /// Sets number i of one trajectory.
  void put(std::ptrdiff_t i, int lane, double x) { numbers_[i * lanes + lane] = x; }
  /// The row, or the pair, that begins at number i.
  PENDCORE_INLINE Row row(std::ptrdiff_t i) const { return load<Row>(numbers_.data() + i * lanes); }
  PENDCORE_INLINE PairOf<Number> pair(std::ptrdiff_t i) const {
    if constexpr (lanes == 1) {
      return load<Pair>(numbers_.data() + i);
    } else {
      return {(*this)[i], (*this)[i + 1]};
    }
  }
  template <class Any>
  PENDCORE_INLINE void set_row(std::ptrdiff_t i, const Any& x) {
    store(numbers_.data() + i * lanes, x);
  }

 private:
  std::vector<double> numbers_;
};

/// Numbers with slopes.
template <class Along>
class RowsInMemory<Dual<double, Along>, Dual<double, Along>> {
  using Number = Dual<double, Along>;

 public:
  static constexpr int places = 1;

  void assign(std::size_t count) { numbers_.assign(count, Number{}); }
  PENDCORE_INLINE const Number& operator[](std::ptrdiff_t i) const { return numbers_[i]; }
  PENDCORE_INLINE const Number& row(std::ptrdiff_t i) const { return numbers_[i]; }
  PENDCORE_INLINE PairOf<Number> pair(std::ptrdiff_t i) const {
    return pair_of(numbers_[i], numbers_[i + 1]);
  }
  PENDCORE_INLINE void set(std::ptrdiff_t i, const Number& x) { numbers_[i] = x; }
  PENDCORE_INLINE void set_row(std::ptrdiff_t i, const Number& x) { numbers_[i] = x; }

 private:
  std::vector<Number> numbers_;
};

}  // namespace pendcore
