/// \file
/// What the integration loop sees of a method applied to a system: no tableau, no pendulum.
#pragma once

#include <functional>
#include <stdexcept>
#include <vector>

#include "integrate/loop/attempt.hpp"
#include "integrate/runge_kutta/tableau.hpp"
#include "integrate/step_output.hpp"

namespace pendcore {

/// A right-hand side on plain numbers, with the rates of quadratures after it.
using Rates = std::function<void(double t, const double* y, double* dydt)>;

/// What the next step depends on beside y and dydt.
struct StepperState {
  std::vector<double> memory = {};  ///< of the method that is at work; its own to read
  bool has_switched = false;        ///< whether the second method of a pair is at work
  double h_asked = 0.0;  ///< s, the implicit step that a pair is to try first; 0 for none
};

class Stepper : public StepOutput {
 public:
  virtual const MethodInfo& info() const = 0;

  /// Sets the tolerances of each component that counts (controlled() numbers each). It comes before
  /// start(): a method may choose its order, and with it its memory, by them.
  virtual void set_tolerances(const double* rtol, const double* atol) = 0;

  /// Begins at y, where the right-hand side is dydt.
  virtual void start(const double* y, const double* dydt) = 0;

  virtual void get_derivative(double* dydt) const = 0;  ///< that of the state before the step
  virtual void set_new_state(const double* y) = 0;      ///< replaces the state after it
  /// The right-hand side at the state after the step: some methods have it as their last stage.
  virtual void get_new_derivative(double* /*dydt*/) const {
    throw std::logic_error("this method has no stage at the end of a step");
  }
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

  /// An estimate of h |lambda|, with lambda the eigenvalue of largest size, from the attempted step
  /// (Hairer and Wanner, volume II, IV.2); for a series, divided by its order.
  virtual double stiffness(double h) = 0;

  /// Called when stability is found to limit the steps. `size_is_given` says whether their size is
  /// fixed, or is the longest allowed. Returns whether to call it again after as many more hits.
  virtual bool stiffness_found(bool /*size_is_given*/) { return false; }

  /// Returns what this method keeps; most methods keep nothing.
  virtual StepperState saved_state() const { return {}; }
  /// Continues from a saved state, instead of from what start() left.
  virtual void restore(const StepperState& /*saved*/) {}

  long long evaluations = 0;     ///< right-hand sides so far
  long long jacobians = 0;       ///< derivatives of them so far, for implicit methods
  long long factorisations = 0;  ///< matrices factored so far
};

}  // namespace pendcore
