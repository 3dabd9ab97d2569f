/// \file
/// How a run is made: method, tolerances, what is kept, and where it ends at the latest.
#pragma once

#include <vector>

#include "pendcore/simulate/options/atol.hpp"
#include "pendcore/simulate/options/compensated.hpp"
#include "pendcore/simulate/options/events.hpp"
#include "pendcore/simulate/options/first_step.hpp"
#include "pendcore/simulate/options/ledger.hpp"
#include "pendcore/simulate/options/max_step.hpp"
#include "pendcore/simulate/options/max_steps.hpp"
#include "pendcore/simulate/options/method.hpp"
#include "pendcore/simulate/options/rtol.hpp"
#include "pendcore/simulate/options/step.hpp"
#include "pendcore/simulate/options/store.hpp"
#include "pendcore/simulate/options/t_eval.hpp"
#include "pendcore/simulate/options/time_limit.hpp"
#include "pendcore/simulate/step_watch.hpp"

namespace pendcore {

/// In the order of Python's signature. A new option is one file and its name here.
using AllOptions = OptionList<MethodOption, RtolOption, AtolOption, TEvalOption, StoreOption,
                              FirstStepOption, MaxStepOption, StepOption, MaxStepsOption,
                              TimeLimitOption, EventsOption, LedgerOption, CompensatedOption>;

/// Kept with the solution, so that it can be resumed.
struct Options : AllOptions {
  Monitor monitor;
  StepWatch* watch = nullptr;  ///< looks on; must outlive the run
};

/// What is kept of a run whose `store` is not given.
inline Store usual_store(const Options& options) {
  return options.t_eval.empty() ? Store::dense : Store::times;
}

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
