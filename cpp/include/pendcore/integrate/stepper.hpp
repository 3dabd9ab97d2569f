/// \file
/// What the integration loop sees of a method applied to a system: no tableau, no pendulum.
#pragma once

#include <cmath>
#include <functional>
#include <span>
#include <vector>

#include "pendcore/arithmetic/two_double.hpp"
#include "pendcore/integrate/loop/attempt.hpp"
#include "pendcore/integrate/runge_kutta/tableau.hpp"

namespace pendcore {

/// A right-hand side on plain numbers, with the rates of quadratures after it.
using Rates = std::function<void(double t, const double* y, double* dydt)>;

class Stepper {
 public:
  virtual ~Stepper() = default;

  virtual const MethodInfo& info() const = 0;
  virtual int dimension() const = 0;                      ///< numbers in a state
  virtual int controlled() const { return dimension(); }  ///< the first so many count in errors
  virtual int interpolant_degree() const = 0;             ///< the degree of the polynomial in theta

  /// Sets the tolerances of each component that counts (controlled() numbers each). It comes before
  /// start(): a method may choose its order, and with it its memory, by them.
  virtual void set_tolerances(const double* rtol, const double* atol) = 0;

  /// Begins at y, where the right-hand side is dydt.
  virtual void start(const double* y, const double* dydt) = 0;

  virtual void get_state(double* y) const = 0;          ///< y at the start of the step
  virtual void get_derivative(double* dydt) const = 0;  ///< its derivative
  virtual void get_new_state(double* y) const = 0;      ///< y at the end of the attempted step
  virtual void set_new_state(const double* y) = 0;      ///< replaces it
  virtual void evaluate(double t, const double* y, double* dydt) = 0;  ///< the right-hand side

  /// Called from time to time in a long attempt. If it returns false, the attempt is given up, and
  /// nothing that the next attempt depends on has changed.
  std::function<bool()> keep_going;

  /// The step, s, with which a run begins from the state at time t, if the method knows one; else
  /// 0.
  virtual double own_first_step(double /*t*/) { return 0.0; }

  /// Tries a step of size h from the state at time t, a sum of two numbers; `gain` is the one of
  /// the step control.
  virtual Attempt attempt(const TwoDouble& t, double h, double gain) = 0;

  /// Replaces an attempt by a step in which nothing moves.
  virtual void stay() = 0;

  /// Accepts the attempted step: y becomes y_new.
  virtual void accept(double t_new) = 0;

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
  /// dimension) row-major.
  virtual void sample(const double* coefficients, const TwoDouble& start, double h,
                      const double* times, int count, double* states) const = 0;

  /// An estimate of h |lambda|, with lambda the eigenvalue of largest size, from the attempted step
  /// (Hairer and Wanner, volume II, IV.2); for a series, divided by its order.
  virtual double stiffness(double h) = 0;

  /// Called when stability is found to limit the steps. `size_is_given` says whether their size is
  /// fixed, or is the longest allowed. Returns whether to call it again after as many more hits.
  virtual bool stiffness_found(bool /*size_is_given*/) { return false; }

  /// What the next step depends on beside y and dydt: nothing for most methods.
  virtual std::vector<double> saved_state() const { return {}; }
  /// Continues from a saved state, instead of from what start() left.
  virtual void restore(const std::vector<double>& /*memory*/) {}

  long long evaluations = 0;     ///< right-hand sides so far
  long long jacobians = 0;       ///< derivatives of them so far, for implicit methods
  long long factorisations = 0;  ///< matrices factored so far
};

}  // namespace pendcore
