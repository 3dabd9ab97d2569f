/// \file
/// The result of a run: times, states, dense output, statistics, and the position to resume from.
#pragma once

#include <cstdint>
#include <exception>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pendcore/options.hpp"
#include "pendcore/scene.hpp"
#include "pendcore/status.hpp"
#include "pendcore/vector.hpp"

namespace pendcore {

/// y(t) between the steps: a polynomial in theta = (t - start) / h for each accepted step.
struct DenseOutput {
  int degree = 0;
  std::vector<double> start;         ///< s, (n_steps)
  std::vector<double> start_low;     ///< s, (n_steps), the part of the time below the double
  std::vector<double> h;             ///< s, (n_steps), negative in a backward run
  std::vector<double> coefficients;  ///< (n_steps, degree + 1, dimension) row-major
};

/// A state of a run: time (s), angles (rad, n), rates (rad/s, n), accounts of the ledger (J).
struct State {
  double t;
  Vector q, qd, accounts;
};

/// A state that a solution keeps; it lives as long as the solution does.
struct StateView {
  double t;
  View q, qd, accounts;
  operator State() const { return {t, q, qd, accounts}; }
};

/// Columns of the states that a solution keeps; they live as long as the solution does.
using Rows = Eigen::Map<const Matrix, 0, Eigen::OuterStride<>>;

struct IntegratorState;

struct Solution {
  Solution() = default;
  explicit Solution(Options own) : options(std::move(own)) {}

  Status status = Status::finished;
  std::string message;
  std::string last_method;  ///< with which the run ended: of a pair, one of its two
  Statistics statistics;
  std::vector<double> t;  ///< s, (n_t)
  /// (n_t, dimension) row-major: q_1 .. q_n (rad), qd_1 .. qd_n (rad/s), the accounts (J)
  std::vector<double> states;
  DenseOutput dense;

  Scene scene;  ///< whose run it is; without links in one that was read from a file
  Options options;
  double t0 = 0.0;                ///< s, as asked for
  double t_end = 0.0;             ///< s, as asked for
  std::vector<double> start;      ///< (dimension), the state at t0
  int n = 0;                      ///< links
  int dimension = 0;              ///< 2n, and the accounts of the ledger
  std::vector<Account> accounts;  ///< the ledger's, if it is kept
  double t_reached = 0.0;         ///< s; before t_end if the run failed
  std::vector<double> y_reached;  ///< (dimension), the state there
  std::vector<FoundEvent> found;  ///< the events found along the run
  std::exception_ptr error;       ///< what a user's function threw, if it ended the run

  /// Where a resumed run continues: before the first step that the end of this run cut short.
  std::shared_ptr<const IntegratorState> resumable;
  /// What a run that never stopped has kept up to there, too.
  struct Kept {
    std::size_t t = 0, steps = 0, found = 0;  ///< so many of `t`, of the polynomials, of the events
  };
  Kept resumable_kept;

  /// The states kept, in their order: i = 0 .. t.size() - 1. solution.back().q(1) is the second
  /// angle at the last of them. Throws std::out_of_range where none is kept.
  StateView operator[](std::size_t i) const&;
  StateView back() const& { return (*this)[t.size() - 1]; }
  /// Their angles and rates, (n_t, n).
  Rows q() const&;
  Rows qd() const&;
  // A solution that nobody keeps, as in simulate(...).back(), gives copies.
  State operator[](std::size_t i) const&& { return (*this)[i]; }
  State back() const&& { return back(); }
  Matrix q() const&& { return q(); }
  Matrix qd() const&& { return qd(); }

  /// The state at a time within the run, or a row for each of m times, (m, dimension), from the
  /// dense output; where two steps meet, the state itself. Throws std::invalid_argument outside the
  /// run or without dense output.
  State at(double time) const;
  Matrix sample(const Numbers& times) const;
};

/// A hash of every bit of the times, the states and the dense output.
std::uint64_t fingerprint(const Solution& solution);

}  // namespace pendcore
