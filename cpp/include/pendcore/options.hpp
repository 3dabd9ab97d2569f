/// \file
/// How a run is made: method, tolerances, what is kept, and where it ends at the latest.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "pendcore/integrate/integrate.hpp"

namespace pendcore {

/// What is kept of a run. The last mode keeps all, the first two need constant memory.
enum class Store {
  end,    ///< the end
  times,  ///< the times asked for
  steps,  ///< every accepted step
  dense,  ///< the polynomials; and the times asked for, or else every accepted step
};

/// Kept with the solution, so that it can be resumed.
struct Options {
  std::string method = "dopri5";
  std::vector<double> rtol = {1e-9};   ///< 1 number, or one for each of the 2n components
  std::vector<double> atol = {1e-12};  ///< likewise; rad and rad/s
  Store store = Store::dense;
  std::vector<double> t_eval;        ///< s, the times asked for, strictly monotone along the run
  std::optional<double> first_step;  ///< s; chosen from the tolerances unless given
  double max_step = std::numeric_limits<double>::infinity();    ///< s
  std::optional<double> step;                                   ///< s, a fixed step
  long long max_steps = 10'000'000;                             ///< attempted ones
  double time_limit = std::numeric_limits<double>::infinity();  ///< s of computing
  Monitor monitor;
};

/// Throws std::invalid_argument for options out of their range, but for tolerances and times:
void check(const Options& options);

/// for times that do not run from t0 to t_end,
void check_times(const std::vector<double>& times, double t0, double t_end);

/// for tolerances; and returns them for a chain of n links, (2n), as the steps use them: rtol at
/// least 10 eps, what doubles can resolve; atol at least the smallest normal double, so that a
/// component that stays zero has an error of 0, not 0/0.
std::vector<double> relative_tolerances(const Options& options, std::size_t n);
std::vector<double> absolute_tolerances(const Options& options, std::size_t n);

}  // namespace pendcore
