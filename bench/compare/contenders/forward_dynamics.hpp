// A contender of forward dynamics prepares calls that compute the accelerations of a scene. Each
// side is a program of its own, so that the linker does not mix inline functions of two headers or
// of two builds: a .cpp file that defines `contenders`. forward_dynamics.py speaks to it:
//
//   prepare NAME EFFECT n states masses lengths gravity q qd
//   accelerations CALLS      qdd at the first state
//   bytes CALLS              heap in use after the preparation of the calls, 0 if unknown
//   make CALLS COUNT         makes COUNT calls; answers the number of right-hand sides of one call
//   burst CALLS SECONDS      nanoseconds of a right-hand side, one number for each batch of calls
#pragma once

#include <span>
#include <utility>

#include "conversation.hpp"

namespace contenders {

// A chain of uniform rods (kg, m, m/s^2) with an effect (effect_parameters.hpp, or "none"), and the
// states that the calls go through in turn. The number of states is a power of two. q of the first
// state is followed by q of the second, and so on, in absolute angles from +x towards +y, y down;
// qd likewise.
struct Scene {
  std::vector<double> masses, lengths;
  double gravity = 0;
  std::string effect;
  std::vector<double> q, qd;

  std::size_t n() const { return masses.size(); }
  std::size_t states() const { return q.size() / n(); }
};

class Calls : public Prepared {
 public:
  std::string burst(double seconds) final;
  std::string tell(const std::string& word, std::istream& rest) final;
  std::size_t bytes = 0;  // of the heap, held since the preparation

  virtual void make(int count) = 0;                 // timed; each call waits for the one before
  virtual std::vector<double> accelerations() = 0;  // qdd (n) at the first state
  virtual double right_hand_sides() { return 1; }   // in one call

 private:
  int count_ = 0;  // calls in a batch
};

using PrepareCalls = std::function<std::unique_ptr<Calls>(const Scene&)>;
Contender forward_dynamics(std::string name, std::string label, std::string about,
                           PrepareCalls prepare);

// The next state. The acceleration is never NaN here, but the processor has to wait for it, as the
// next stage of a step has to.
inline std::size_t next(std::size_t state, double acceleration, std::size_t states) {
  const std::size_t is_nan = acceleration != acceleration ? 1 : 0;
  return (state + 1 + is_nan) & (states - 1);
}

// Converts angles of links to angles of joints, for all states, and back for one state.
inline std::vector<double> at_joints(const std::vector<double>& of_links, std::size_t n) {
  std::vector<double> result = of_links;
  for (std::size_t i = 0; i < result.size(); ++i)
    if (i % n > 0) result[i] -= of_links[i - 1];
  return result;
}
inline std::vector<double> of_links(std::span<const double> at_joints) {
  std::vector<double> result(at_joints.begin(), at_joints.end());
  for (std::size_t i = 1; i < result.size(); ++i) result[i] += result[i - 1];
  return result;
}

}  // namespace contenders
