/// \file
/// The stepper of a method for the equations of motion that a scene calls for.
#pragma once

#include <memory>
#include <string_view>

#include "dynamics/equations_of_motion.hpp"
#include "integrate/stepper.hpp"
#include "pendcore/scene.hpp"

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

}  // namespace pendcore
