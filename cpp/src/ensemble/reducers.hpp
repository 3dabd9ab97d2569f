/// \file
/// Numbers of a whole run, which are found while it is made.
///
/// The extremes are those of the dense output: within a step, a component is largest at an end or
/// at a turning point of its polynomial. A step is not searched if the bounds of its polynomial, by
/// the sum of the coefficients' sizes or in Bernstein form, do not exceed what was found.
///
/// The energy drift is the largest |E(t) - E(0) - W(t)| at the ends of steps, where E is the total
/// energy and W the work of effects, less the losses, that the ledger has (energetics/ledger.hpp).
#pragma once

#include <span>
#include <vector>

#include "dynamics/energetics/ledger.hpp"
#include "integrate/events/root.hpp"
#include "simulate/step_watch.hpp"

namespace pendcore {

/// The least and the greatest angles, rad, and rates, rad/s.
class Extremes final : public StepWatch {
 public:
  explicit Extremes(std::size_t n) : least_(2 * n), greatest_(2 * n) {}
  bool asks_for_dense_output() const override { return true; }
  void starts(double t, std::span<const double> y) override;
  void steps(const WatchedStep& step) override;
  void jumps(double t, std::span<const double> y) override;
  /// Writes the least values, then the greatest, (2, 2n).
  void write(double* to) const;

 private:
  std::vector<double> least_, greatest_;
  std::vector<double> polynomial_, bounds_;
  std::vector<TurningPoint> turning_points_;
};

/// The largest energy drift, J. Where effects do work, the run must keep the ledger.
class EnergyDrift final : public StepWatch {
 public:
  explicit EnergyDrift(const Scene& scene) : scene_(scene), accounts_(accounts_of(scene)) {}
  bool asks_for_dense_output() const override { return false; }
  void starts(double t, std::span<const double> y) override;
  void steps(const WatchedStep& step) override { jumps(step.t, step.y); }
  void jumps(double t, std::span<const double> y) override;
  double largest() const { return largest_; }

 private:
  /// The energy less what the ledger accounts for, J.
  double unexplained(double t, std::span<const double> y) const;

  Scene scene_;
  std::vector<Account> accounts_;
  double start_ = 0.0;
  double largest_ = 0.0;
};

}  // namespace pendcore
