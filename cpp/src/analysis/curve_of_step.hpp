/// \file
/// The curve of which defect_correction.hpp finds the error, in one step: the rates of the dense
/// output, and as angles their integral, from the dense output's angles at theta = 0 on.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "arithmetic/order_of_series.hpp"
#include "arithmetic/pair.hpp"

namespace pendcore {

/// How many numbers the n links take in memory, so that packs of them fit.
inline std::size_t padded(std::size_t n) { return n <= 2 ? n : (n + 3) / 4 * 4; }

/// In powers of theta. Angles and rates take padded(n) numbers each; those beyond the links have no
/// meaning, and nothing reads them.
struct CurveOfStep {
  std::size_t n, width;
  std::size_t degree = 0;              ///< of the angles, one more than that of the rates
  std::vector<double> powers{};        ///< (degree + 1, 2 width): angles, rates
  std::vector<double> angle_offset{};  ///< (degree + 1, width): angles less the dense output's

  explicit CurveOfStep(std::size_t links) : n(links), width(padded(links)) {}
};

/// Loads the links from k on, where memory ends with the last of them.
template <class Row>
PENDCORE_INLINE Row load_links(const double* from, std::size_t k, std::size_t n) {
  constexpr std::size_t width = Lanes<Row>::width;
  if (k + width <= n) return load<Row>(from + k);
  Row some = broadcast<Row>(0.0);
  for (std::size_t i = 0; i < width && k + i < n; ++i) {
    set_lane(some, static_cast<int>(i), from[k + i]);
  }
  return some;
}

/// Sets the curve of a step of length h, s, from the dense output: a row of `stride` numbers for
/// each power, which begins with angles and rates. The vectors of the curve have the right size.
PENDCORE_INLINE void set_curve(const double* rows, std::size_t stride, double h,
                               CurveOfStep* curve) {
  with_row_for(curve->n, [=]<class Row>() __attribute__((always_inline)) {
    const std::size_t n = curve->n;
    const std::size_t width = curve->width;
    for (std::size_t k = 0; k < width; k += Lanes<Row>::width) {
      Row integral = load<Row>(rows + k);
      Row angles = integral;
      for (std::size_t p = 0; p < curve->degree; ++p) {
        const double* const from = rows + p * stride;
        const bool is_last = p + 1 == curve->degree;  // no numbers need follow its rates
        const Row rates = is_last ? load_links<Row>(from + n, k, n) : load<Row>(from + n + k);
        store(&curve->powers[2 * p * width + k], integral);
        store(&curve->powers[(2 * p + 1) * width + k], rates);
        store(&curve->angle_offset[p * width + k], Row(integral - angles));
        integral = h * inverse_of[p + 1] * rates;
        angles = is_last ? broadcast<Row>(0.0) : load<Row>(from + stride + k);
      }
      const std::size_t top = curve->degree;
      store(&curve->powers[2 * top * width + k], integral);
      store(&curve->powers[(2 * top + 1) * width + k], broadcast<Row>(0.0));
      store(&curve->angle_offset[top * width + k], integral);
    }
  });
}

/// The values of a block of columns of the curve at `count` values of theta, and their slopes times
/// a factor. The points are the inner loop, so that none waits for another.
template <class Block, std::size_t count, bool has_slopes>
PENDCORE_INLINE void evaluate_columns(const CurveOfStep& curve,
                                      const std::array<double, count>& theta, double factor,
                                      std::size_t column, double* y, double* slope) {
  const std::size_t row = 2 * curve.width;
  const double* const powers = curve.powers.data() + column;
  Block value[count];
  Block derivative[count];
  for (std::size_t i = 0; i < count; ++i) {
    value[i] = load<Block>(powers + curve.degree * row);
    derivative[i] = broadcast<Block>(0.0);
  }
  for (std::size_t p = curve.degree; p-- > 0;) {
    const Block c = load<Block>(powers + p * row);
#pragma GCC unroll 16
    for (std::size_t i = 0; i < count; ++i) {
      if constexpr (has_slopes) derivative[i] = fma(theta[i], derivative[i], value[i]);
      value[i] = fma(theta[i], value[i], c);
    }
  }
#pragma GCC unroll 16
  for (std::size_t i = 0; i < count; ++i) {
    store(y + i * row + column, value[i]);
    if constexpr (has_slopes) store(slope + i * row + column, factor * derivative[i]);
  }
}

/// The curve at so many values of theta, (count, 2 width), and the slopes of its rates times a
/// factor, in the second half of each row.
template <std::size_t count>
PENDCORE_INLINE void evaluate_curve(const CurveOfStep& curve,
                                    const std::array<double, count>& theta, double factor,
                                    double* y, double* slope) {
  const std::size_t width = curve.width;
  if (width == 1) {
    evaluate_columns<Pair, count, true>(curve, theta, factor, 0, y, slope);
  } else if (width == 2) {
    evaluate_columns<Pack<4>, count, true>(curve, theta, factor, 0, y, slope);
  } else {
    for (std::size_t k = 0; k < width; k += 4) {
      evaluate_columns<Pack<4>, count, false>(curve, theta, factor, k, y, slope);
      evaluate_columns<Pack<4>, count, true>(curve, theta, factor, width + k, y, slope);
    }
  }
}

/// By how much the curve is off the run's state y at theta, where a step ends: (2 width). The state
/// at the start comes last, so that little is rounded.
PENDCORE_INLINE void offset_from_state(const CurveOfStep& curve, double theta, const double* y,
                                       double* offset) {
  with_row_for(curve.n, [&, theta, y, offset]<class Row>() __attribute__((always_inline)) {
    const std::size_t width = curve.width;
    const Row at = broadcast<Row>(theta);
    for (std::size_t k = 0; k < width; k += Lanes<Row>::width) {
      const double* const powers = &curve.powers[k];
      Row angles = broadcast<Row>(0.0);
      Row rates = angles;
      for (std::size_t p = curve.degree; p > 0; --p) {
        angles = fma(at, angles, load<Row>(powers + 2 * p * width));
        rates = fma(at, rates, load<Row>(powers + (2 * p + 1) * width));
      }
      const Row angles_off = load<Row>(powers) - load_links<Row>(y, k, curve.n);
      const Row rates_off = load<Row>(powers + width) - load_links<Row>(y + curve.n, k, curve.n);
      store(offset + k, fma(at, angles, angles_off));
      store(offset + width + k, fma(at, rates, rates_off));
    }
  });
}

}  // namespace pendcore
