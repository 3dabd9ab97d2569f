/// \file
/// What a run leaves behind: times, states, dense output, statistics, and where to go on from.
#pragma once

#include <string>
#include <vector>

#include "pendcore/integrate/integrate.hpp"
#include "pendcore/options.hpp"

namespace pendcore {

/// y(t) between the steps: a polynomial in theta = (t - start) / h for each accepted step.
struct DenseOutput {
  int degree = 0;
  std::vector<double> start;         ///< s, (n_steps)
  std::vector<double> start_low;     ///< s, (n_steps), what its double leaves over of the time
  std::vector<double> h;             ///< s, (n_steps), negative in a backward run
  std::vector<double> coefficients;  ///< (n_steps, degree + 1, 2n) row-major; row p: of theta^p
};

struct Solution {
  Status status = Status::finished;
  std::string message;
  Statistics statistics;
  std::vector<double> t;       ///< s, (n_t)
  std::vector<double> states;  ///< (n_t, 2n) row-major: q_1 .. q_n (rad), qd_1 .. qd_n (rad/s)
  DenseOutput dense;

  Options options;
  double t0 = 0.0;                ///< s, as asked for
  double t_end = 0.0;             ///< s, as asked for
  std::vector<double> start;      ///< (2n), the state at t0
  int dimension = 0;              ///< 2n
  double t_reached = 0.0;         ///< s; before t_end if the run failed
  std::vector<double> y_reached;  ///< (2n), the state there

  /// Where a resumed run goes on: before the first step that the end of this one cut short.
  Position resumable;
  std::size_t resumable_t = 0;      ///< so many of `t` an unstopped run has as well,
  std::size_t resumable_steps = 0;  ///< and so many polynomials

  /// States at m times within the run, (m, 2n) row-major, from the dense output; where two steps
  /// meet, the state itself. Throws std::invalid_argument outside the run or without dense output.
  std::vector<double> at(const std::vector<double>& times) const;
};

}  // namespace pendcore
