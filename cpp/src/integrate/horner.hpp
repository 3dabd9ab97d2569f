/// \file
/// The dense output of a step at given times, by Horner's scheme in theta = (time - start) / h.
///
/// Coefficients are (degree + 1) rows of numbers, those of theta^0 first. Each column is evaluated
/// by itself, so that the bits do not depend on how many are evaluated together.
#pragma once

#include <cstddef>

#include "arithmetic/pack.hpp"
#include "arithmetic/two_double.hpp"

namespace pendcore {

PENDCORE_INLINE double theta_at(double time, const TwoDouble& start, double h) {
  return ((time - start.high) - start.low) / h;
}

/// The value of a block of columns; rows begin `row` numbers apart.
template <class Block>
PENDCORE_INLINE Block horner(const double* coefficients, int degree, int row, double theta) {
  Block value = load<Block>(coefficients + degree * row);
#pragma GCC unroll 16
  for (int p = degree - 1; p >= 0; --p) {
    value = fma(theta, value, load<Block>(coefficients + p * row));
  }
  return value;
}

/// At `count` times, of a state of so many blocks: (count, blocks) row-major.
template <class Block, int blocks, int degree>
PENDCORE_INLINE void sample_blocks(const double* coefficients, TwoDouble start, double h,
                                   const double* times, int count, double* states) {
  constexpr int width = Lanes<Block>::width;
  for (int k = 0; k < count; ++k) {
    const double theta = theta_at(times[k], start, h);
#pragma GCC unroll 16
    for (int i = 0; i < blocks; ++i) {
      const Block value = horner<Block>(coefficients + i * width, degree, blocks * width, theta);
      store(states + (k * blocks + i) * width, value);
    }
  }
}

/// The same of any dimension and degree.
PENDCORE_INLINE void sample_rows(const double* coefficients, TwoDouble start, double h,
                                 const double* times, int count, double* states, int dimension,
                                 int degree) {
  for (int k = 0; k < count; ++k) {
    const double theta = theta_at(times[k], start, h);
    double* const y = states + static_cast<std::ptrdiff_t>(k) * dimension;
    int at = 0;
    for (; at + 4 <= dimension; at += 4) {
      store(y + at, horner<Pack<4>>(coefficients + at, degree, dimension, theta));
    }
    for (; at < dimension; ++at) {
      y[at] = horner<double>(coefficients + at, degree, dimension, theta);
    }
  }
}

}  // namespace pendcore
