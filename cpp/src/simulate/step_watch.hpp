/// \file
/// What looks on while a run is made, step by step, and never changes it.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "pendcore/options.hpp"

namespace pendcore {

struct EquationsOfMotion;
struct JointGuard;

/// An accepted step. Of a step in which an event ends the run, only the part before counts.
struct WatchedStep {
  double t;                   ///< s, at its end
  double h;                   ///< s, from theta = 0 to 1; negative in a backward run
  std::span<const double> y;  ///< the state there: angles, rates, accounts of the ledger
  /// Computes the dense output in powers of theta, (degree + 1, size of y), at its first call, for
  /// watches that ask for it. It is there until steps() returns.
  std::function<const double*()> rows;
  int degree;
  double share;  ///< of the step: theta at its end, 1 unless an event ends it
};

/// The laws with which a run starts, or those that follow others at the end of a step.
struct WatchedChange {
  double t;                               ///< s
  std::span<const double> before, after;  ///< the states
  bool jumped;                            ///< whether they differ by more than rounding
  bool at_start;
  bool lost_order;                     ///< whether impacts came in an order that is unknown
  bool forward;                        ///< the direction of time
  const JointGuard* guard;             ///< whose zero it is; null for a time that is given
  const EquationsOfMotion& equations;  ///< with the modes and the holds from now on
};

class StepWatch {
 public:
  virtual ~StepWatch() = default;
  virtual bool asks_for_dense_output() const = 0;
  virtual void starts(double t, std::span<const double> y) = 0;
  virtual void steps(const WatchedStep& step) = 0;
  /// The state became y at once: at an impact, or at the start.
  virtual void jumps(double t, std::span<const double> y) = 0;
  /// Called before jumps(), where laws may change along the run.
  virtual void changes(const WatchedChange& /*change*/) {}
};

/// A watch that keeps something where the run keeps its states.
class KeepingWatch : public StepWatch {
 public:
  /// Is told how the run is made; `store` is what it keeps.
  virtual void keep(Store store, const Options& options) = 0;
};

}  // namespace pendcore
