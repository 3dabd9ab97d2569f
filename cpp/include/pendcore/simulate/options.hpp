/// \file
/// How a run is made: method, tolerances, what is kept, and where it ends at the latest.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pendcore/integrate/events/event.hpp"
#include "pendcore/integrate/loop/integrate.hpp"

namespace pendcore {

/// What is kept of a run. The last mode keeps all, the first two need constant memory.
enum class Store {
  end,    ///< the end
  times,  ///< the times asked for
  steps,  ///< every accepted step
  dense,  ///< the polynomials; and the times asked for, or else every accepted step
};

inline constexpr std::array<std::string_view, 4> store_names = {"end", "times", "steps", "dense"};

constexpr std::string_view store_name(Store store) {
  return store_names[static_cast<std::size_t>(store)];
}

/// The method of a run that names none: method_choice.hpp has the rule.
inline constexpr std::string_view automatic = "auto";

/// Kept with the solution, so that it can be resumed.
struct Options {
  std::string method{automatic};
  std::vector<double> rtol = {1e-9};   ///< 1 number, or one for each of the 2n components
  std::vector<double> atol = {1e-12};  ///< likewise; rad and rad/s
  Store store = Store::dense;
  std::vector<double> t_eval;        ///< s, the times asked for, strictly monotone along the run
  std::optional<double> first_step;  ///< s; chosen from the tolerances unless given
  std::vector<Event> events;         ///< to look for; they change no step
  bool ledger = false;               ///< keep the work and the losses beside the state
  bool compensated = false;          ///< carry on what the rounding of each step leaves over
  double max_step = std::numeric_limits<double>::infinity();    ///< s
  std::optional<double> step;                                   ///< s, a fixed step
  long long max_steps = 10'000'000;                             ///< attempted ones
  double time_limit = std::numeric_limits<double>::infinity();  ///< s of computing
  Monitor monitor;
};

/// Throws std::invalid_argument for options out of their range or at odds with each other, but for
/// tolerances and the order of times.
void check(const Options& options);

/// Throws std::invalid_argument for times that do not run one after the other from t0 to t_end.
void check_times(const std::vector<double>& times, double t0, double t_end);

/// The relative tolerances of a chain of n links, (2n), at least 10 eps: doubles resolve no more.
/// Throws std::invalid_argument for a wrong number of them, or one that is not finite and > 0.
std::vector<double> relative_tolerances(const Options& options, std::size_t n);

/// The absolute ones, (2n), at least 1e-150: what stays zero has an error of 0, not 0/0.
/// Throws std::invalid_argument for a wrong number of them, or one that is not finite and >= 0.
std::vector<double> absolute_tolerances(const Options& options, std::size_t n);

}  // namespace pendcore
