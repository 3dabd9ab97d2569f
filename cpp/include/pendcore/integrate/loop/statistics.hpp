/// \file
/// The cost of a run.
#pragma once

namespace pendcore {

struct Statistics {
  long long nfev = 0;  ///< right-hand sides
  long long njev = 0;  ///< Jacobians (implicit methods)
  long long nlu = 0;   ///< factorisations (implicit methods)
  long long accepted = 0;
  long long rejected = 0;
  long long limited_by_tolerance = 0;  ///< accepted steps whose size the error control chose
  long long limited_by_max_step = 0;   ///< accepted steps of max_step, or of a fixed step
  long long limited_by_break = 0;      ///< accepted steps cut by the end or by a break point
  double min_step = 0.0;               ///< s, the smallest accepted step, not cut (unless all are)
  double max_step = 0.0;               ///< s, the largest, likewise
  bool stiff = false;                  ///< stability was found to limit the steps: stiffness.hpp
};

/// Counts an accepted step of size h. A step that was cut does not count for the smallest and the
/// largest step.
void count_accepted(Statistics& statistics, double h, bool cut, bool at_max_step);

}  // namespace pendcore
