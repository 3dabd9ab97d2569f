/// \file
/// A dual number: a value, and its derivative along one direction, or along several, which are the
/// lanes of a pack.
///
///     (x + x' e)(y + y' e) = x y + (x y' + x' y) e,   e^2 = 0
///
/// Code for a row of numbers (a double, a pair, a pack) runs unchanged on a dual row. It gives the
/// exact derivative beside the value, and the value has the same bits as without the derivative.
///
/// Source: Griewank and Walther, Evaluating Derivatives (2008), chapter 3, the forward mode. Cost:
/// two to three times the cost of the row. At x = 0, |x| has the derivative that it has for x > 0.
#pragma once

#include <type_traits>

#include "arithmetic/exponential.hpp"
#include "arithmetic/row_of_links.hpp"

namespace pendcore {

template <class Row, class Along = Row>
struct Dual {
  Row value;
  // GCC reports the alignment of a pack beside a number as on the baseline, and its clones rely on
  // the true one.
  alignas(std::is_same_v<Row, Along> ? alignof(Along)
          : sizeof(Along) < 64       ? sizeof(Along)
                                     : 64) Along slope;

  Dual() = default;
  PENDCORE_INLINE Dual(const Row& constant)  // NOLINT(google-explicit-constructor): as a row would
      : value(constant), slope{} {}
  PENDCORE_INLINE Dual(const Row& x, const Along& along) : value(x), slope(along) {}
  // GCC would copy the structure in parts of 16 bytes. The load of a wider pack cannot be forwarded
  // from several stores, and waits for them: series took twice as long.
  PENDCORE_INLINE Dual(const Dual& x)
      : value(x.value), slope(x.slope) {}           // NOLINT(*-use-equals-default)
  PENDCORE_INLINE Dual& operator=(const Dual& x) {  // NOLINT(*-use-equals-default)
    value = x.value;
    slope = x.slope;
    return *this;
  }
  ~Dual() = default;

  PENDCORE_INLINE friend Dual operator-(const Dual& x) { return {-x.value, -x.slope}; }
  PENDCORE_INLINE friend Dual operator+(const Dual& x, const Dual& y) {
    return {x.value + y.value, x.slope + y.slope};
  }
  PENDCORE_INLINE friend Dual operator-(const Dual& x, const Dual& y) {
    return {x.value - y.value, x.slope - y.slope};
  }
  PENDCORE_INLINE friend Dual operator*(const Dual& x, const Dual& y) {
    return {x.value * y.value, pendcore::fma(x.value, y.slope, Along(x.slope * y.value))};
  }
  PENDCORE_INLINE friend Dual operator*(double x, const Dual& y) {
    return {x * y.value, x * y.slope};
  }
  PENDCORE_INLINE friend Dual operator/(double x, const Dual& y) {
    const Row quotient = x / y.value;
    return {quotient, -(quotient * y.slope) / y.value};
  }
  PENDCORE_INLINE friend Dual fma(const Dual& a, const Dual& b, const Dual& c) {
    return {pendcore::fma(a.value, b.value, c.value),
            pendcore::fma(a.value, b.slope, pendcore::fma(b.value, a.slope, c.slope))};
  }
  PENDCORE_INLINE friend Dual fma(double a, const Dual& b, const Dual& c) {
    return {pendcore::fma(a, b.value, c.value), pendcore::fma(a, b.slope, c.slope)};
  }
  PENDCORE_INLINE Dual& operator+=(const Dual& x) { return *this = *this + x; }
  PENDCORE_INLINE Dual& operator-=(const Dual& x) { return *this = *this - x; }
};

/// Products with a row of constants.
template <class Row>
PENDCORE_INLINE Dual<Row> operator*(const Row& x, const Dual<Row>& y) {
  return {x * y.value, x * y.slope};
}
template <class Row>
PENDCORE_INLINE Dual<Row> fma(const Row& a, const Dual<Row>& b, const Dual<Row>& c) {
  return {fma(a, b.value, c.value), fma(a, b.slope, c.slope)};
}

/// The type of a constant beside a row: that of the row, or of its value if it is dual.
template <class Row>
struct WithoutSlope {
  using Type = Row;
};
template <class Row, class Along>
struct WithoutSlope<Dual<Row, Along>> {
  using Type = Row;
};
template <class Row>
using ConstantOf = typename WithoutSlope<Row>::Type;

/// A lane of a dual row is a dual number.
template <class Row>
struct Lanes<Dual<Row>> {
  static constexpr int width = Lanes<Row>::width;
  using Number = Dual<double>;
};
template <class Along>
  requires(!std::is_same_v<Along, double>)
struct Lanes<Dual<double, Along>> {
  static constexpr int width = 1;
  using Number = Dual<double, Along>;
};

template <class Row, class Along>
struct Constants<Dual<Row, Along>> {
  template <class Constant>
  PENDCORE_INLINE static Dual<Row, Along> of(const Constant& x)
    requires requires { Constants<Row>::of(x); }
  {
    return Dual<Row, Along>(Constants<Row>::of(x));
  }
  PENDCORE_INLINE static Dual<Row, Along> of(const Dual<Row, Along>& x) { return x; }
};

template <class Along>
PENDCORE_INLINE double value_of(const Dual<double, Along>& x) {
  return x.value;
}
template <class Row, class Along>
bool is_zero(const Dual<Row, Along>& x) {
  return is_zero(x.value) && is_zero(x.slope);
}

/// Loads a row from consecutive numbers in memory, or stores it. Plain numbers are constants.
template <class DualRow>
  requires requires(DualRow x) { x.slope; }
PENDCORE_INLINE DualRow load(const double* from) {
  return load<decltype(DualRow::value)>(from);
}
template <class DualRow>
PENDCORE_INLINE DualRow load(const Dual<double>* from) {
  DualRow x;
  for (int i = 0; i < Lanes<DualRow>::width; ++i) {
    set_lane(x.value, i, from[i].value);
    set_lane(x.slope, i, from[i].slope);
  }
  return x;
}
template <class Row>
PENDCORE_INLINE void store(Dual<double>* to, const Dual<Row>& x) {
  for (int i = 0; i < Lanes<Row>::width; ++i) to[i] = {lane(x.value, i), lane(x.slope, i)};
}

/// A function that only moves numbers, or adds some to others, does so with values and slopes.
#define PENDCORE_LINEAR_FUNCTION(function)                        \
  template <class... Rows, class... Alongs>                       \
  PENDCORE_INLINE auto function(const Dual<Rows, Alongs>&... x) { \
    return Dual(function(x.value...), function(x.slope...));      \
  }
PENDCORE_LINEAR_FUNCTION(other)
PENDCORE_LINEAR_FUNCTION(before)
PENDCORE_LINEAR_FUNCTION(after)

/// A number with several slopes is a row by itself.
template <class Number>
  requires requires(Number x) { x.slope[0]; }
PENDCORE_INLINE Number load(const Number* from) {
  return *from;
}
template <class Along>
  requires(Lanes<Along>::width > 1)
PENDCORE_INLINE void store(Dual<double, Along>* to, const Dual<double, Along>& x) {
  *to = x;
}
template <class Along>
PENDCORE_INLINE Dual<double, Along> before(const Dual<double, Along>& /*x*/) {
  return 0.0;
}
template <class Along>
PENDCORE_INLINE const Dual<double, Along>& before(const Dual<double, Along>& /*x*/,
                                                  const Dual<double, Along>& row_before) {
  return row_before;  // NOLINT(bugprone-return-const-ref-from-parameter): rows stay in memory
}
template <class Along>
PENDCORE_INLINE const Dual<double, Along>& after(const Dual<double, Along>& /*x*/,
                                                 const Dual<double, Along>& row_after) {
  return row_after;  // NOLINT(bugprone-return-const-ref-from-parameter): rows stay in memory
}

template <class Row, class Along>
PENDCORE_INLINE Dual<Row, Along> absolute(const Dual<Row, Along>& x) {
  return {absolute(x.value), x.value < Row{} ? Along(-x.slope) : x.slope};
}
template <class Row, class Along>
PENDCORE_INLINE void sine_cosine(const Dual<Row, Along>& x, Dual<Row, Along>& sine,
                                 Dual<Row, Along>& cosine) {
  Row s, c;
  sine_cosine(x.value, s, c);
  sine = {s, c * x.slope};
  cosine = {c, -(s * x.slope)};
}
template <class Row, class Along>
PENDCORE_INLINE Dual<Row, Along> exponential(const Dual<Row, Along>& x) {
  const Row value = exponential(x.value);
  return {value, value * x.slope};
}
/// x^p for x >= 0 and p >= 1.
template <class Row, class Along>
PENDCORE_INLINE Dual<Row, Along> power(const Dual<Row, Along>& x, double p) {
  if (p == 1.0) return x;
  return {power(x.value, p), broadcast<Row>(p) * power(x.value, p - 1.0) * x.slope};
}
/// The same where the exponent has a slope, too: (x^p)' = p x^(p-1) x' + p' x^p log x.
template <class Along>
PENDCORE_INLINE Dual<double, Along> power(const Dual<double, Along>& x,
                                          const Dual<double, Along>& p) {
  Dual<double, Along> result = power(x, p.value);
  if (x.value > 0.0) result.slope += p.slope * (result.value * logarithm(x.value));
  return result;
}

}  // namespace pendcore
