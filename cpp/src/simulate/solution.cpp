#include "pendcore/solution.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "arithmetic/bits.hpp"
#include "arithmetic/floating_point_environment.hpp"
#include "integrate/horner.hpp"
#include "integrate/taylor/taylor_step.hpp"
#include "pendcore/methods.hpp"
#include "text/message.hpp"

namespace pendcore {

Matrix Solution::sample(const Numbers& times) const {
  const FloatingPointEnvironment ieee;
  if (options.store != Store::dense) {
    throw std::invalid_argument(
        "t: this solution keeps no dense output: simulate with store=\"dense\"");
  }
  // All steps of a pair are evaluated as steps of its first method, as in the run itself.
  const bool is_series = find_method(options.method).dense_output_is_series;
  const auto sample = is_series ? fastest<&sample_series>() : fastest<&sample_rows>();
  const double direction = t_reached < t0 ? -1.0 : 1.0;
  const std::size_t row = static_cast<std::size_t>((dense.degree + 1) * dimension);
  Matrix result(times.size(), dimension);
  double* y = result.data();
  for (const double time : times) {
    if (!((time - t0) * direction >= 0.0 && (t_reached - time) * direction >= 0.0)) {
      refuse("t", time, "within the run, " + text(t0) + " to " + text(t_reached) + " s");
    }
    if (time == t_reached) {
      std::ranges::copy(y_reached, y);
    } else {
      const auto after = std::upper_bound(
          dense.start.begin(), dense.start.end(), time,
          [direction](double a, double b) { return direction * a < direction * b; });
      const auto step = static_cast<std::size_t>(after - dense.start.begin()) - 1;
      const double* coefficients = dense.coefficients.data() + step * row;
      if (time == dense.start[step]) {
        std::copy_n(coefficients, dimension, y);
      } else {
        sample(coefficients, {dense.start[step], dense.start_low[step]}, dense.h[step], &time, 1, y,
               dimension, dense.degree);
      }
    }
    y += dimension;
  }
  return result;
}

State Solution::at(double time) const {
  const Matrix row = sample({time});
  const Eigen::Map<const Vector> y(row.data(), dimension);
  return {.t = time, .q = y.head(n), .qd = y.segment(n, n), .accounts = y.tail(dimension - 2 * n)};
}

StateView Solution::operator[](std::size_t i) const& {
  if (i >= t.size()) {
    throw std::out_of_range("this solution keeps " + std::to_string(t.size()) + " states");
  }
  const double* const y = states.data() + i * static_cast<std::size_t>(dimension);
  return {.t = t[i], .q = {y, n}, .qd = {y + n, n}, .accounts = {y + 2 * n, dimension - 2 * n}};
}

Rows Solution::q() const& {
  return {states.data(), static_cast<Eigen::Index>(t.size()), n, Eigen::OuterStride<>(dimension)};
}

Rows Solution::qd() const& {
  return {states.data() + n, static_cast<Eigen::Index>(t.size()), n,
          Eigen::OuterStride<>(dimension)};
}

std::uint64_t fingerprint(const Solution& solution) {
  const std::uint64_t h = hash_bits(hash_bits(solution.t), solution.states);
  return hash_bits(h, solution.dense.coefficients);
}

}  // namespace pendcore
