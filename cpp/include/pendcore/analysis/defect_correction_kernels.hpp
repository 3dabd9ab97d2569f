/// \file
/// The kernels of defect_correction.hpp: what is summed along every step. A row holds the links,
/// and zeros that fill a pack.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "pendcore/analysis/lobatto_points.hpp"
#include "pendcore/arithmetic/instruction_set.hpp"
#include "pendcore/arithmetic/order_of_series.hpp"
#include "pendcore/arithmetic/pack.hpp"

namespace pendcore::defect_detail {

inline std::size_t row_of(std::size_t n) { return n <= 2 ? n : (n + 3) / 4 * 4; }

/// The curve of a step, in powers of theta: the rates of the dense output, and as angles their
/// integral, from the dense output's angles at theta = 0 on.
struct CurveOfStep {
  std::size_t n, row;
  std::size_t degree = 0;         ///< of the angles, one more than that of the rates
  std::vector<double> powers{};   ///< (degree + 1, 2 row): a row of angles, a row of rates
  std::vector<double> farther{};  ///< (degree + 1, row): the angles less those of the dense output

  explicit CurveOfStep(std::size_t links) : n(links), row(row_of(links)) {}
};

/// A neighbour's memory along a part of a step.
struct Memory {
  std::size_t n, row;
  std::vector<double> e_q, e_qd;          ///< the errors of the curve where the part begins, (row)
  std::vector<double> y;                  ///< the curve at the points, as its powers are
  std::vector<double> r;                  ///< (points, 2 row), a row of no use before each row
  std::vector<double> q, qd, qdd;         ///< at a point, (row)
  std::vector<double> end_e_q, end_e_qd;  ///< the errors where the part ends, (row)

  Memory(std::size_t links, std::size_t points) : n(links), row(row_of(links)) {
    for (auto* one : {&e_q, &e_qd, &q, &qd, &qdd, &end_e_q, &end_e_qd}) one->resize(row);
    for (auto* one : {&y, &r}) one->resize(points * 2 * row);
  }
  double* r_at(std::size_t point) { return &r[(2 * point + 1) * row]; }
};

/// Calls a kernel with the kind of pack that fits rows of n links.
template <class Kernel>
PENDCORE_INLINE void in_rows(std::size_t n, const Kernel& kernel) {
  if (n == 1) {
    kernel.template operator()<double>();
  } else if (n == 2) {
    kernel.template operator()<Pair>();
  } else {
    kernel.template operator()<Pack<4>>();
  }
}

/// Loads the part of a row that begins at link k, where memory ends with the links.
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

/// The factors 1/p in the integral of a polynomial.
template <std::size_t... p>
constexpr std::array<double, sizeof...(p)> inverses(std::index_sequence<p...>) {
  return {(p == 0 ? 0.0 : 1.0 / static_cast<double>(p))...};
}
constexpr std::size_t most_powers = 64;
static_assert(highest_order + 1 < most_powers);
constexpr auto inverse = inverses(std::make_index_sequence<most_powers>());

/// Takes the curve from the dense output of a step of length h, s: rows of `stride` numbers, which
/// begin with angles and rates. The memory of the curve suffices.
template <class Row>
PENDCORE_INLINE void take_rows(const double* rows, std::size_t stride, double h,
                               CurveOfStep* curve) {
  const std::size_t n = curve->n;
  const std::size_t row = curve->row;
  for (std::size_t k = 0; k < row; k += Lanes<Row>::width) {
    Row turned = load_links<Row>(rows, k, n);
    Row angles = turned;
    for (std::size_t p = 0; p < curve->degree; ++p) {
      const double* const from = rows + p * stride;
      const bool is_last = p + 1 == curve->degree;
      const Row rates = is_last ? load_links<Row>(from + n, k, n) : load<Row>(from + n + k);
      store(&curve->powers[2 * p * row + k], turned);
      store(&curve->powers[(2 * p + 1) * row + k], rates);
      store(&curve->farther[p * row + k], Row(turned - angles));
      turned = h * inverse[p + 1] * rates;
      angles = is_last ? broadcast<Row>(0.0) : load<Row>(from + stride + k);
    }
    store(&curve->powers[2 * curve->degree * row + k], turned);
    store(&curve->powers[(2 * curve->degree + 1) * row + k], broadcast<Row>(0.0));
    store(&curve->farther[curve->degree * row + k], turned);
  }
}
PENDCORE_INLINE void take_curve(const double* rows, std::size_t stride, double h,
                                CurveOfStep* curve) {
  in_rows(curve->n, [=]<class Row>()
                        __attribute__((always_inline)) { take_rows<Row>(rows, stride, h, curve); });
}

/// The values of a block of columns of the curve at so many theta, and their slopes times a factor.
/// The points are the inner loop, so that none waits for another.
template <class Block, int count, bool has_slopes>
PENDCORE_INLINE void evaluate_block(const CurveOfStep& curve, const double* at, double factor,
                                    std::size_t column, double* y, double* slope) {
  const std::size_t width = 2 * curve.row;
  const double* const powers = curve.powers.data() + column;
  Block value[count];
  Block derivative[count];
  for (int i = 0; i < count; ++i) {
    value[i] = load<Block>(powers + curve.degree * width);
    derivative[i] = broadcast<Block>(0.0);
  }
  for (std::size_t p = curve.degree; p-- > 0;) {
    const Block c = load<Block>(powers + p * width);
#pragma GCC unroll 16
    for (int i = 0; i < count; ++i) {
      if (has_slopes) derivative[i] = fma(at[i], derivative[i], value[i]);
      value[i] = fma(at[i], value[i], c);
    }
  }
#pragma GCC unroll 16
  for (int i = 0; i < count; ++i) {
    store(y + i * width + column, value[i]);
    if (has_slopes) store(slope + i * width + column, factor * derivative[i]);
  }
}

/// Sets out along a part of a step, which begins at `from` and spans `size` in theta, and h in s:
/// with all that needs no new right-hand side. The one at the first point, in qdd, is the last one
/// of the part before. Its state lacked only what the last point itself added to the error.
template <int count>
PENDCORE_INLINE void set_out(const LobattoPoints& points, const CurveOfStep& curve, double from,
                             double size, double h, Memory& memory) {
  const std::size_t row = curve.row;
  const std::size_t width = 2 * row;
  const std::size_t last = (count - 1) * width;
  const bool begins = from == 0.0;
  for (std::size_t k = 0; k < row; ++k) {
    memory.y[k] = begins ? curve.powers[k] : memory.y[last + k];
    memory.y[row + k] = begins ? curve.powers[row + k] : memory.y[last + row + k];
    memory.r[row + k] = begins ? h * memory.qdd[k] - size * curve.powers[width + row + k]
                               : memory.r[last + row + k];
  }
  double at[count - 1];
  for (int i = 1; i < count; ++i) at[i - 1] = from + points.theta[i] * size;
  double* const y = &memory.y[width];
  double* const r = &memory.r[width];
  if (row == 1) {
    evaluate_block<Pair, count - 1, true>(curve, at, -size, 0, y, r);
  } else if (row == 2) {
    evaluate_block<Pack<4>, count - 1, true>(curve, at, -size, 0, y, r);
  } else {
    for (std::size_t k = 0; k < row; k += 4) {
      evaluate_block<Pack<4>, count - 1, false>(curve, at, -size, k, y, r);
      evaluate_block<Pack<4>, count - 1, true>(curve, at, -size, row + k, y, r);
    }
  }
}

/// Goes on with the right-hand side in qdd, at the point before i: sets q and qd at point i, or the
/// errors at the end. A pack that a right-hand side loads is stored as one, for a processor waits
/// where it loads what was stored in pieces.
template <class Row>
PENDCORE_INLINE void go_on_in_rows(const LobattoPoints& points, std::size_t i, double h,
                                   Memory& memory) {
  const std::size_t row = memory.row;
  const LobattoPoints::Sums& to = points.sums[i];
  for (std::size_t k = 0; k < row; k += Lanes<Row>::width) {
    const Row e_qd = load<Row>(&memory.e_qd[k]);
    Row rate = e_qd;
    Row angle = to.theta * e_qd;
    for (std::size_t j = 0; j + 1 < i; ++j) {
      const Row r = load<Row>(memory.r_at(j) + k);
      rate = fma(to.once[j], r, rate);
      angle = fma(to.twice[j], r, angle);
    }
    double* const last = memory.r_at(i - 1) + k;
    Row r = load<Row>(last);
    if (i > 1) {
      r = fma(h, load<Row>(&memory.qdd[k]), r);
      store(last, r);
    }
    rate = fma(to.once[i - 1], r, rate);
    angle = fma(to.twice[i - 1], r, angle);
    angle = fma(h, angle, load<Row>(&memory.e_q[k]));
    if (i < points.count) {
      const double* const curve = &memory.y[2 * i * row + k];
      store(&memory.q[k], Row(load<Row>(curve) + angle));
      store(&memory.qd[k], Row(load<Row>(curve + row) + rate));
    } else {
      store(&memory.end_e_q[k], angle);
      store(&memory.end_e_qd[k], rate);
    }
  }
}
PENDCORE_INLINE void go_on(const LobattoPoints& points, std::size_t i, double h, Memory& memory) {
  in_rows(memory.n, [&, i, h]<class Row>() __attribute__((always_inline)) {
    go_on_in_rows<Row>(points, i, h, memory);
  });
}

/// The polynomials of the errors of the curve's angles along the part, of length h, s.
PENDCORE_INLINE void look_along(const LobattoPoints& points, double h, const Memory& memory,
                                LobattoPoints::Polynomial* along) {
  constexpr int packs = LobattoPoints::powers / 4;
  for (std::size_t link = 0; link < memory.n; ++link) {
    Pack<4> sum[packs]{};
    set_lane(sum[0], 0, memory.e_q[link]);
    set_lane(sum[0], 1, h * memory.e_qd[link]);
    for (std::size_t j = 0; j < points.count; ++j) {
      const double r = h * memory.r[(2 * j + 1) * memory.row + link];
      for (int p = 0; p < packs; ++p) {
        sum[p] = fma(r, load<Pack<4>>(&points.twice_at[j][4 * p]), sum[p]);
      }
    }
    for (int p = 0; p < packs; ++p) store(&along[link][4 * p], sum[p]);
  }
}

/// Errors of the run's angles at some theta of a part, four at a time: those of the curve, which
/// each neighbour has `along` the part, and by how much its angles are farther than the run's.
struct ErrorsWithin {
  const CurveOfStep* curve;
  double from, size;                                        ///< of the part, in theta of the step
  std::span<const LobattoPoints::Polynomial* const> along;  ///< of each neighbour, (n)
  std::span<const double> theta;                            ///< of the part
  double* errors;                                           ///< (theta, neighbours, n)
};
PENDCORE_INLINE void find_errors(const ErrorsWithin& wanted) {
  const CurveOfStep& curve = *wanted.curve;
  const std::size_t n = curve.n;
  const std::size_t neighbours = wanted.along.size();
  for (std::size_t first = 0; first < wanted.theta.size(); first += 4) {
    const std::size_t some = std::min<std::size_t>(4, wanted.theta.size() - first);
    Pack<4> theta{};
    for (std::size_t i = 0; i < some; ++i) theta[i] = wanted.theta[first + i];
    const Pack<4> of_step = fma(wanted.size, theta, broadcast<Pack<4>>(wanted.from));
    for (std::size_t link = 0; link < n; ++link) {
      Pack<4> farther{};
      for (std::size_t p = curve.degree + 1; p-- > 0;) {
        farther = fma(of_step, farther, broadcast<Pack<4>>(curve.farther[p * curve.row + link]));
      }
      for (std::size_t k = 0; k < neighbours; ++k) {
        const LobattoPoints::Polynomial& along = wanted.along[k][link];
        Pack<4> error{};
        for (std::size_t p = LobattoPoints::most + 2; p-- > 0;) {
          error = fma(theta, error, broadcast<Pack<4>>(along[p]));
        }
        error = error + farther;
        double* const to = wanted.errors + (first * neighbours + k) * n + link;
        for (std::size_t i = 0; i < some; ++i) to[i * neighbours * n] = error[i];
      }
    }
  }
}

/// By how much the curve is off the run's state y where a step ends, (2 row). The state at the
/// start comes last, so that little is rounded.
PENDCORE_INLINE void find_jump(const CurveOfStep& curve, double theta, const double* y,
                               double* jump) {
  in_rows(curve.n, [&, theta, y, jump]<class Row>() __attribute__((always_inline)) {
    const std::size_t row = curve.row;
    const Row at = broadcast<Row>(theta);
    for (std::size_t k = 0; k < row; k += Lanes<Row>::width) {
      const double* const powers = &curve.powers[k];
      Row angles = broadcast<Row>(0.0);
      Row rates = angles;
      for (std::size_t p = curve.degree; p > 0; --p) {
        angles = fma(at, angles, load<Row>(powers + 2 * p * row));
        rates = fma(at, rates, load<Row>(powers + (2 * p + 1) * row));
      }
      const Row angles_off = load<Row>(powers) - load_links<Row>(y, k, curve.n);
      const Row rates_off = load<Row>(powers + row) - load_links<Row>(y + curve.n, k, curve.n);
      store(jump + k, fma(at, angles, angles_off));
      store(jump + row + k, fma(at, rates, rates_off));
    }
  });
}

using GoOn = void (*)(const LobattoPoints&, std::size_t, double, Memory&);
using SetOut = void (*)(const LobattoPoints&, const CurveOfStep&, double, double, double, Memory&);

inline SetOut set_out_for(std::size_t points) {
  static const std::array all = {fastest<&set_out<5>>(), fastest<&set_out<6>>(),
                                 fastest<&set_out<7>>(), fastest<&set_out<8>>(),
                                 fastest<&set_out<9>>()};
  return all.at(points - LobattoPoints::least);
}

}  // namespace pendcore::defect_detail
