/// \file
/// What an explicit Runge-Kutta method is: a table.
///
///     k_s = f(t + c_s h, y + h sum_j a_sj k_j),     y_new = y + h sum_s b_s k_s
///     err = h sum_s e_s k_s                          the difference to the embedded method
///     y(t + theta h) = y + h sum_s k_s sum_p P_sp theta^p,  p = 1 .. degree, 0 <= theta <= 1
///
/// Coefficients are exact fractions, rounded to doubles once, by the compiler. The order conditions
/// of b, of b - e and of the interpolant are tested in exact fractions, for every method there is.
#pragma once

#include <array>
#include <span>
#include <string_view>

namespace pendcore {

struct Fraction {
  long long numerator = 0;
  long long denominator = 1;
  /// Numerator and denominator are below 2^53: the quotient is rounded once.
  constexpr double value() const {
    return static_cast<double>(numerator) / static_cast<double>(denominator);
  }
};

/// What kind of table a method is: tableau.hpp, collocation.hpp, automatic.hpp.
enum class MethodKind { explicit_one, implicit_one, automatic };

/// What is said of a method, and how its steps are controlled.
struct MethodInfo {
  std::string_view name;
  std::span<const std::string_view> aliases = {};
  std::string_view citation;
  MethodKind kind = MethodKind::explicit_one;
  int order;              ///< of y_new
  int error_order;        ///< of the embedded method; 0: no error estimate, fixed steps only
  int interpolant_order;  ///< of y(t + theta h), uniformly in theta
  double beta = 0.0;      ///< weight of the previous error in the PI control
  double log2_safety = -0.15200309344504997;  ///< of 0.9: a step aims a tenth short
  double shrink = 0.2;                        ///< a step is at least this share of the one before
  double growth = 10.0;                       ///< and at most this multiple;
  double retry = 0.2;  ///< where a step could not be computed, this share is tried next
  double stability =
      0.0;  ///< h |lambda| on the negative real axis that counts as stiff; 0: no test
  bool compensates = true;  ///< its steps can carry on what their rounding leaves over
};

template <int stage_count, int interpolant_degree>
struct Tableau {
  static constexpr int stages = stage_count;
  static constexpr int degree = interpolant_degree;
  using Row = std::array<Fraction, stage_count>;

  MethodInfo info;
  bool first_same_as_last;  ///< the last stage is the first of the next step
  Row c;
  std::array<Row, stage_count> a;
  Row b;
  Row e;  ///< b minus the weights of the embedded method
  std::array<std::array<Fraction, interpolant_degree>, stage_count> interpolant;  ///< P
};

}  // namespace pendcore
