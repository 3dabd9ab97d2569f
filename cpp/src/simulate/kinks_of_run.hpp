/// \file
/// Lets the steps of a run end where the air's drag has a kink (dynamics/ends_in_air.hpp).
///
/// A step of dop853 across a kink is right to its tolerance and no better, while all others are
/// right to a hundredth of theirs. In 24 random chains of one to four rods, errors at rtol = 1e-9
/// are a 34th if steps end at kinks, and an 80th at 1e-12, by 11 % more evaluations and by none. At
/// 1e-7 the same error costs a tenth less, at 1e-6 an eighth more; dopri5 gains nowhere.
#pragma once

#include "dynamics/ends_in_air.hpp"
#include "dynamics/equations_of_motion.hpp"
#include "integrate/loop/integrate.hpp"
#include "pendcore/methods.hpp"
#include "pendcore/options.hpp"

namespace pendcore {

/// Whether steps end at kinks, if there are any.
inline bool ends_at_kinks(const MethodInfo& method, double tolerance) {
  return tolerance <= method.ends_at_kinks_from;
}

/// Finds the first kink of an attempted step, whose states have `dimension` numbers; empty where
/// steps need not end there. The equations must outlive it.
FirstKink first_kink_of(const Scene& scene, const EquationsOfMotion& equations,
                        const Options& options, int dimension);

}  // namespace pendcore
