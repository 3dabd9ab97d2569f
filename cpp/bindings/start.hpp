/// \file
/// Reads the start and the interval of a run from Python's arguments.
#pragma once

#include "arguments.hpp"
#include "simulate/initial_state.hpp"

namespace pendcore::bindings {

/// Angles (rad) and rates (rad/s), one for each link, and the interval (s).
struct Start {
  std::vector<double> q0, qd0;
  double t0, t_end;
};

/// A single angle or rate counts for all links. `warn` is called with a sentence for each value
/// that is hardly intended. The core refuses values that are wrong.
inline Start start_of(const Scene& scene, py::handle q0, py::handle qd0, py::handle t0,
                      py::handle t_end, py::handle warn) {
  const std::size_t n = scene.links.size();
  const std::string one_a_link = "(" + std::to_string(n) + ",)";
  Start start{.q0 = numbers("q0", q0, one_a_link, n),
              .qd0 = numbers("qd0", qd0, one_a_link, n),
              .t0 = number("t_span[0]", t0),
              .t_end = number("t_span[1]", t_end)};
  if (start.q0.size() == n && start.qd0.size() == n) {
    for (const std::string& warning : run_warnings(scene, start.q0, start.t0, start.t_end)) {
      warn(warning);
    }
  }
  return start;
}

}  // namespace pendcore::bindings
