/// \file
/// Lyapunov exponents: how fast motions that begin close together separate, from the variational
/// equations along one motion.
///
///     d(dq)/dt = dqd,   d(dqd)/dt = (d qdd/d q) dq + (d qdd/d qd) dqd
///
/// They are integrated beside the state for k small changes (dq, dqd) of it at once, with exact
/// derivatives of the right-hand side (equations.hpp), or of the Taylor series where the
/// scene has one on dual numbers. The changes are part of the error norm, as
/// the state is. They are made orthonormal again, Phi = Q R, as soon as an R_ii is not within
/// [1/16, 16], and the logarithms of the diagonal of R are summed:
///
///     growth_i(t) = sum of ln R_ii        exponent_i = growth_i/(t - t_0), in 1/s
///
/// The length of a change is the length of the vector of its 2n numbers in rad and rad/s. Locked
/// joints have no changes: a chain with m free joints has 2m exponents.
///
/// Source: Benettin, Galgani, Giorgilli, Strelcyn, Meccanica 15 (1980), 9-20.
/// Cost: a series on dual numbers for each step and each of the k changes, or 12 right-hand sides
/// of dop853.
#pragma once

#include <exception>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "pendcore/scene.hpp"
#include "pendcore/status.hpp"
#include "pendcore/vector.hpp"

namespace pendcore {

struct LyapunovOptions {
  std::optional<long long> count{};  ///< k, the number of exponents; else all
  double rtol = 1e-9;                ///< relative tolerance of the state
  double atol = 1e-12;               ///< rad and rad/s; the changes have `rtol` of their length
  std::optional<double> since{};     ///< s, from which growth counts; else the start
  NumberList t_eval;                 ///< s, strictly monotone along the run; empty: the end
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
  std::vector<double> t;       ///< s, (n_t), `since` and those of t_eval that were reached
  std::vector<double> growth;  ///< (n_t, k) row-major, without a unit
  std::vector<double> states;  ///< (n_t, 2n) row-major: the motion itself
  double t_reached = 0.0;      ///< s
  std::exception_ptr error;    ///< what a user's function threw, if it ended the run
};

/// Throws std::invalid_argument for effects that make the motion or the law of motion jump (dry
/// friction and stops): the variational equations do not hold there.
void check_has_exponents(const Scene& scene);

/// Throws std::invalid_argument for bad input, and for a scene without exponents.
TangentGrowth lyapunov(const Scene& scene, const Numbers& q0, const Numbers& qd0, double t0,
                       double t_end, const LyapunovOptions& options = {});

}  // namespace pendcore
