/// \file
/// Those who record a step see the states at its ends, and its dense output.
#pragma once

#include <cmath>
#include <span>

#include "arithmetic/two_double.hpp"

namespace pendcore {

class StepOutput {
 public:
  virtual ~StepOutput() = default;

  virtual int dimension() const = 0;                      ///< numbers in a state
  virtual int controlled() const { return dimension(); }  ///< the first so many count in errors
  virtual int interpolant_degree() const = 0;             ///< the degree of the polynomial in theta

  virtual void get_state(double* y) const = 0;      ///< y at the start of the step
  virtual void get_new_state(double* y) const = 0;  ///< y at its end

  /// The dense output of the attempted step, (degree + 1, dimension) row-major,
  /// y(t + theta h) = sum_p theta^p coefficient[p].
  virtual void interpolant(double h, double* coefficients) = 0;
  /// The same, or a straight line to the new state where the interpolant overflows although the new
  /// state does not. This happens with tolerances of 1, or with laws of 1e145 times a rate. The
  /// motion has its line, and quadratures have theirs: neither depends on the other. The caller
  /// passes dimension(), because a virtual call at every step costs time.
  void finite_interpolant(double h, std::span<double> coefficients, std::size_t dimension) {
    interpolant(h, coefficients.data());
    // An overflow in a stage, or in a term of a series, shows in the highest coefficient as well:
    // only that one is looked at. The sum is finite only if all its terms are.
    double sum = 0.0;
    for (const double x : coefficients.last(dimension)) sum += x;
    if (!std::isfinite(sum)) [[unlikely]]
      straighten(coefficients.data());
  }
  /// Puts straight lines in the place of the interpolants that overflow, if any do.
  void straighten(double* coefficients);

  /// The values of such a polynomial for a step of size h from `start`, at `count` times: (count,
  /// dimension) row-major. A method whose states have a size that the compiler knows is faster.
  virtual void sample(const double* coefficients, const TwoDouble& start, double h,
                      const double* times, int count, double* states) const;
  /// The state at a share theta of the step.
  void state_within(const double* coefficients, double theta, double* y) const {
    sample(coefficients, {}, 1.0, &theta, 1, y);
  }
};

}  // namespace pendcore
