/// \file
/// From a scene and a start to a solution.
#pragma once

#include <memory>
#include <optional>

#include "pendcore/dynamics/equations_of_motion.hpp"
#include "pendcore/integrate/stepper.hpp"
#include "pendcore/scene/scene.hpp"
#include "pendcore/simulate/solution.hpp"

namespace pendcore {

/// The method applied to the equations of motion that the scene calls for. If the ledger is kept,
/// its quadratures are beside the state; steps are compensated if that is asked for. Throws
/// std::invalid_argument for an unknown method. With a pair of methods, the scene must outlive the
/// stepper.
std::unique_ptr<Stepper> make_stepper(const Scene& scene, std::string_view method);
std::unique_ptr<Stepper> make_stepper(const Scene& scene, const EquationsOfMotion& equations,
                                      std::string_view method, bool ledger, bool compensated);

/// The method of Taylor series for those equations; `rates` is their right-hand side, followed by
/// the rates of `quadratures`. Throws std::invalid_argument for a scene with an effect that has no
/// series.
std::unique_ptr<Stepper> make_taylor_stepper(const Scene& scene, const EquationsOfMotion& equations,
                                             Rates rates, int quadratures, bool compensated);

/// Throws std::invalid_argument for options with which no start of the scene can be run, but for
/// methods and tolerances, which make_stepper() and relative_tolerances() check.
void check_options(const Scene& scene, const Options& options, double t0, double t_end);

/// Simulates the scene from angles q0 (rad, n) and rates qd0 (rad/s, n) over t0 .. t_end (s), which
/// may run backward. Throws std::invalid_argument for bad input, naming the argument. A run that
/// fails returns what it has, with a status and a message that say why.
Solution simulate(const Scene& scene, const std::vector<double>& q0, const std::vector<double>& qd0,
                  double t0, double t_end, Options options = {});

/// The solution of the same run, continued to t_end, bit for bit as if it had never stopped.
/// `t_eval` names further times of a run that was asked for times; max_steps, time_limit and
/// monitor count for this leg. Throws std::invalid_argument for an end, or times, that the run has
/// passed.
Solution resume(const Scene& scene, const Solution& solution, double t_end,
                const std::vector<double>& t_eval, long long max_steps,
                std::optional<double> time_limit, const Monitor& monitor);

}  // namespace pendcore
