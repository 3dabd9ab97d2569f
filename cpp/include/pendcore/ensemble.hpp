/// \file
/// Many runs of one scene, which differ in their starts and in parameters of the scene.
///
/// A member has the bits of simulate() with its scene and its start, whatever runs beside it: the
/// number of threads and the order in which they take members change nothing. A member that cannot
/// be run, or fails, does not affect the others; its status says so.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pendcore/options.hpp"
#include "pendcore/scene.hpp"
#include "pendcore/status.hpp"

namespace pendcore {

/// What tells the members apart.
struct Members {
  std::size_t count = 0;
  std::vector<std::string> names;  ///< of the parameters that vary (parameters.hpp)
  /// Writes the start of member i, angles (rad, n) and rates (rad/s, n), and its values of the
  /// parameters. Several threads call it at once.
  std::function<void(std::size_t i, double* q0, double* qd0, double* values)> read;
};

/// The status of a member: that of its run, or one of two more.
enum class MemberStatus : std::uint8_t {
  not_run = status_texts.size(),  ///< the ensemble was stopped before
  refused,                        ///< simulate() would throw: the member is not allowed
};
constexpr std::uint8_t code(Status status) { return static_cast<std::uint8_t>(status); }
constexpr std::uint8_t code(MemberStatus status) { return static_cast<std::uint8_t>(status); }

/// The words of all codes: those of Status, "not_run", "refused".
std::vector<std::string_view> member_status_names();
/// Whether a member with that code reached its goal.
constexpr bool is_success(std::uint8_t code) {
  return code < status_texts.size() && status_texts[code].success;
}

/// The results that are kept. The caller owns the memory, and has filled the numbers with NaN and
/// the statuses with not_run.
struct MemberResults {
  std::span<std::uint8_t> status;  ///< (count)
  std::span<double> t;             ///< s, (count): where the run ended
  /// (count, states of a member, 2n): the last state, or those at the times of options.t_eval
  std::span<double> states;
  /// s, (count, events): when each event of the options was first found; empty if not wanted
  std::span<double> first_found;
  std::span<double> extremes =
      {};  ///< (count, 2, 2n): the least and the largest of each; empty if not wanted
  std::span<double> energy_drift = {};  ///< J, (count); empty if not wanted
  /// 1/s, (count): the largest Lyapunov exponent (lyapunov.hpp); empty if not wanted
  std::span<double> largest_exponent = {};
  /// (count, 2n, k): d(q, qd)/d(name) at the end of each member that reaches its goal; NaN where it
  /// has no derivative. Empty if not wanted
  std::span<double> sensitivities = {};
  /// (k): "q0[i]" or "qd0[i]", i counted from 1, or parameters (parameters.hpp)
  std::vector<std::string> sensitivity_names = {};
};

struct EnsembleLimits {
  int workers = 0;  ///< threads; 0: one for each processor
  double time_limit = std::numeric_limits<double>::infinity();  ///< s, for the whole ensemble
  Monitor monitor = {};                                         ///< is called on the calling thread
};

/// What a whole ensemble came to.
struct EnsembleEnding {
  Status status = Status::finished;  ///< or time_limit, or interrupted
  std::size_t done = 0;              ///< members that were run to their ends
  Statistics statistics;             ///< sums over them
};

/// Runs the members from t0 to t_end (s). `options.store` is end or times. Throws
/// std::invalid_argument for what no member could run with; a user's functions are called from
/// several threads.
EnsembleEnding run_ensemble(const Scene& scene, const Members& members, double t0, double t_end,
                            const Options& options, const EnsembleLimits& limits,
                            const MemberResults& results);

}  // namespace pendcore
