// Contenders that compute the accelerations of a chain of rods, in states that the calls go through
// in turn. The number of states is a power of two. q of the first state is followed by q of the
// second, and so on; qd likewise.
#pragma once

#include <span>
#include <utility>

#include "program.hpp"

namespace contenders {

inline constexpr double moment = 0.5;        // s, for laws that depend on time
inline constexpr double user_damping = 0.1;  // N m s/rad, on the rate of link 2: a user's function

// Each call waits for the one before; its parts are right-hand sides. The outcome is qdd (n) at the
// first state; of derivatives, it is those by angles, rates and torques, (n, 3n), row by row.
class Calls : public Prepared {
 public:
  Calls() { shortest_batch_ = 1e-5; }  // long compared with reading the clock
  std::string outcome() override { return words(accelerations()); }

 protected:
  virtual Numbers accelerations() { throw Unsupported("it says nothing of the accelerations"); }
};

// The next state. The acceleration is never NaN here, but the processor has to wait for it, as the
// next stage of a step has to.
inline std::size_t next(std::size_t state, double acceleration, std::size_t states) {
  const std::size_t is_nan = acceleration != acceleration ? 1 : 0;
  return (state + 1 + is_nan) & (states - 1);
}

// Converts angles of links to angles of joints, for all states, and back for one state.
inline Numbers at_joints(const Numbers& of_links, std::size_t n) {
  Numbers result = of_links;
  for (std::size_t i = 0; i < result.size(); ++i)
    if (i % n > 0) result[i] -= of_links[i - 1];
  return result;
}
inline Numbers of_links(std::span<const double> at_joints) {
  Numbers result(at_joints.begin(), at_joints.end());
  for (std::size_t i = 1; i < result.size(); ++i) result[i] += result[i - 1];
  return result;
}

}  // namespace contenders
