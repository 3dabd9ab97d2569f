/// \file
/// The table of an explicit Runge-Kutta method.
///
///     k_s = f(t + c_s h, y + h sum_j a_sj k_j),     y_new = y + h sum_s b_s k_s
///     err = h sum_s e_s k_s                          the difference to the embedded method
///     y(t + theta h) = y + h sum_i f_i(theta) sum_s D_is k_s,    0 <= theta <= 1
///
/// with polynomials f_i(theta) = sum_p F_ip theta^p, p = 1 .. degree: powers of theta, unless the
/// table says otherwise. The dense output may need stages of its own, after those of the step.
///
/// A second embedded method makes err more careful where the first is good by chance (Hairer,
/// Norsett and Wanner, II.10). With the norms of both, |e| of order p and |d| of order q,
///
///     |err| = |e|^2 / sqrt(|e|^2 + 0.01 |d|^2)       of order 2 p - q
///
/// Coefficients are exact numbers (fraction.hpp), which the compiler rounds. The order conditions
/// of b, of b - e and of the interpolant are tested exactly, for every method.
#pragma once

#include <array>

#include "integrate/runge_kutta/fraction.hpp"
#include "pendcore/methods.hpp"

namespace pendcore {

/// The rows of an identity matrix: powers of theta.
template <int degree>
constexpr std::array<std::array<int, degree>, degree> powers() {
  std::array<std::array<int, degree>, degree> rows{};
  for (int i = 0; i < degree; ++i) rows[i][i] = 1;
  return rows;
}

template <int stage_count, int interpolant_degree, int dense_stage_count = 0>
struct Tableau {
  static constexpr int stages = stage_count;
  static constexpr int all_stages = stage_count + dense_stage_count;  ///< with the dense output's
  static constexpr int degree = interpolant_degree;
  using Row = std::array<Fraction, all_stages>;

  MethodInfo info;
  bool first_same_as_last;   ///< the last stage is the first of the next step
  bool written_out = false;  ///< stage by stage for all but long equations, not only short ones
  Row c;
  std::array<Row, all_stages> a;
  Row b;
  Row e;       ///< b minus the weights of the embedded method
  Row d = {};  ///< b minus the weights of the second, if there is one
  std::array<Row, interpolant_degree> interpolant;  ///< D
  std::array<std::array<int, interpolant_degree>, interpolant_degree> basis =
      powers<interpolant_degree>();  ///< F
};

/// A stage as a loop over stages reads it: c_s, and the weights a_sj that are not zero.
struct StageRow {
  double node = 0.0;
  int count = 0;
  std::array<int, 15> stage{};
  std::array<double, 15> weight{};
};
template <class Method>
constexpr auto rows_of(const Method& method) {
  static_assert(Method::all_stages <= 16, "a row has room for fifteen weights");
  std::array<StageRow, Method::all_stages> rows{};
  for (int s = 0; s < Method::all_stages; ++s) {
    rows[s].node = method.c[s].value;
    for (int j = 0; j < s; ++j) {
      if (method.a[s][j].is_zero()) continue;
      rows[s].stage[rows[s].count] = j;
      rows[s].weight[rows[s].count++] = method.a[s][j].value;
    }
  }
  return rows;
}

}  // namespace pendcore
