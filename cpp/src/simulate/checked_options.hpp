/// \file
/// The options of a run, checked and completed.
#pragma once

#include <vector>

#include "pendcore/options.hpp"
#include "pendcore/scene.hpp"

namespace pendcore {

/// The mode of a run whose `store` is not given: it keeps the times asked for, or else everything.
inline Store usual_store(const Options& options) {
  return options.t_eval.empty() ? Store::dense : Store::times;
}

/// Throws std::invalid_argument for options out of their range or at odds with each other, except
/// the number of tolerances and the order of times.
void check(const Options& options);

/// Throws std::invalid_argument for times that do not run one after the other from t0 to t_end.
void check_times(const std::vector<double>& times, double t0, double t_end);

/// The relative tolerances of a chain of n links, (2n), at least 10 eps: doubles resolve no more.
/// Throws std::invalid_argument for a wrong number of them.
std::vector<double> relative_tolerances(const Options& options, std::size_t n);

/// The absolute ones, (2n), at least 1e-150: what stays zero has an error of 0, not 0/0.
/// Throws std::invalid_argument for a wrong number of them.
std::vector<double> absolute_tolerances(const Options& options, std::size_t n);

/// The least of max(rtol, atol) over the components.
double tightest_tolerance(const Options& options, std::size_t n);

/// Throws std::invalid_argument for options with which no start of the scene can be run, except
/// methods and tolerances, which make_stepper() and relative_tolerances() check.
void check_options(const Scene& scene, const Options& options, double t0, double t_end);

}  // namespace pendcore
