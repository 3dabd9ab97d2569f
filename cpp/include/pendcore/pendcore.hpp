/// \file
/// All of pendcore in one include.
#pragma once

#include "pendcore/analysis/defect.hpp"
#include "pendcore/analysis/defect_correction.hpp"
#include "pendcore/analysis/lyapunov.hpp"
#include "pendcore/dynamics/cost.hpp"
#include "pendcore/dynamics/energetics/energy.hpp"
#include "pendcore/dynamics/energetics/ledger.hpp"
#include "pendcore/dynamics/energetics/reactions.hpp"
#include "pendcore/dynamics/equations_of_motion.hpp"
#include "pendcore/dynamics/inertia.hpp"
#include "pendcore/dynamics/jacobian.hpp"
#include "pendcore/dynamics/kinematics.hpp"
#include "pendcore/effects/registry.hpp"
#include "pendcore/ensemble/ensemble.hpp"
#include "pendcore/scene/scene.hpp"
#include "pendcore/simulate/simulate.hpp"
#include "pendcore/simulate/solution.hpp"
