/// \file
/// Lyapunov exponents: how fast motions that begin close together part, from the variational
/// equations along one motion.
///
///     d(dq)/dt = dqd,   d(dqd)/dt = (d qdd/d q) dq + (d qdd/d qd) dqd
///
/// for k small changes (dq, dqd) of the state at once, integrated beside it, with exact derivatives
/// of the right-hand side (dynamics/jacobian.hpp) and in the error norm as the state is. After each
/// step they are made orthonormal again, Phi = Q R, and what the diagonal of R took away is summed:
///
///     growth_i(t) = sum of ln R_ii        exponent_i = growth_i/(t - t_0), in 1/s
///
/// The length of a change is that of its 2n numbers in rad and rad/s. Changes of joints that are
/// locked do not exist: a chain with m free joints has 2m exponents.
///
/// Source: Benettin, Galgani, Giorgilli, Strelcyn, Meccanica 15 (1980), 9-20.
/// Cost: each step of dop853 takes 12 right-hand sides, on dual numbers, for each of the k changes.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "pendcore/integrate/loop/integrate.hpp"
#include "pendcore/scene/scene.hpp"

namespace pendcore {

struct LyapunovOptions {
  int count = 0;               ///< k, of exponents; 0: all there are
  double rtol = 1e-9;          ///< of the state
  double atol = 1e-12;         ///< rad and rad/s; the changes have `rtol` of their length
  std::vector<double> t_eval;  ///< s, strictly monotone along the run; empty: the end alone
  double max_step = std::numeric_limits<double>::infinity();  ///< s
  long long max_steps = 10'000'000;
  double time_limit = std::numeric_limits<double>::infinity();  ///< s of computing
  Monitor monitor;
};

/// What a run found until it ended.
struct TangentGrowth {
  Status status = Status::finished;
  std::string message;
  Statistics statistics;
  int count = 0;               ///< k
  std::vector<double> t;       ///< s, (n_t), those of t_eval that were reached
  std::vector<double> growth;  ///< (n_t, k) row-major, without a unit
  std::vector<double> states;  ///< (n_t, 2n) row-major: the motion itself
  double t_reached = 0.0;      ///< s
  std::exception_ptr error;    ///< what a function of the user's threw, if it ended the run
};

/// How many exponents a scene has: twice its degrees of freedom.
int lyapunov_count(const Scene& scene);

/// Throws std::invalid_argument for bad input, and for effects under which the motion jumps or its
/// law does, so that the variational equations say nothing: dry friction and stops.
TangentGrowth lyapunov(const Scene& scene, const std::vector<double>& q0,
                       const std::vector<double>& qd0, double t0, double t_end,
                       const LyapunovOptions& options);

}  // namespace pendcore
