/// \file
/// How a run changes with its start and with parameters of its scene: the variational equations
/// (variational_equations.hpp) along the run, step by step.
///
/// Where the laws in force have a Taylor series, the changes go on by series of numbers with slopes
/// (changes_by_series.hpp), in steps of their own. Where they have none, or where a step of the run
/// would take many, the rest of that step is a linear system: d(dqd)/dt is the polynomial that
/// holds at the points of a Gauss quadrature (gauss_collocation.hpp), along the run's dense output.
/// A part ends where drag has a kink (kinks_of_drag.hpp). One in which the polynomial has not
/// converged is halved, again and again at another kink; where it never converges, there are no
/// derivatives from there on (NaN). Where laws change, the changes go on by their saltation
/// (saltation.hpp), or are refused.
///
/// Source: Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I (1993), I.14, II.7.
/// Cost: that of the series; or for each step s Jacobians, O(n^3 s^3), and for each parameter s
/// inverse dynamics on dual numbers.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pendcore/scene.hpp"
#include "simulate/step_watch.hpp"

namespace pendcore {

/// Finds the derivatives of one run while it is made. It may ask for the dense output of any step;
/// the run may keep anything.
class Sensitivities final : public KeepingWatch {
 public:
  /// Names are those of VariationalEquations, which throws std::invalid_argument for others.
  Sensitivities(const Scene& scene, const std::vector<std::string>& names);
  ~Sensitivities() override;
  Sensitivities(Sensitivities&&) noexcept;

  void keep(Store store, const Options& options) override;
  bool asks_for_dense_output() const override { return true; }
  void starts(double t, std::span<const double> y) override;
  void steps(const WatchedStep& step) override;
  void jumps(double /*t*/, std::span<const double> /*y*/) override {}
  void changes(const WatchedChange& change) override;

  /// d(q, qd)/d(name), (n_t, 2n, k) row-major, of what the run has kept; at its end they are
  /// computed by this call.
  const std::vector<double>& values() const;
  /// Why there are none from some time on, and from when; empty if there are.
  const std::string& refusal() const;
  std::size_t states() const;  ///< 2n
  std::size_t names() const;   ///< k

 private:
  struct Variation;
  std::unique_ptr<Variation> variation_;
};

}  // namespace pendcore
