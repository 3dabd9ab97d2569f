/// \file
/// All of pendcore in one include.
#pragma once

#include "pendcore/defect.hpp"
#include "pendcore/dynamics/cost.hpp"
#include "pendcore/dynamics/energy.hpp"
#include "pendcore/dynamics/equations_of_motion.hpp"
#include "pendcore/dynamics/inertia.hpp"
#include "pendcore/dynamics/jacobian.hpp"
#include "pendcore/dynamics/kinematics.hpp"
#include "pendcore/dynamics/ledger.hpp"
#include "pendcore/dynamics/reactions.hpp"
#include "pendcore/lyapunov.hpp"
#include "pendcore/scene.hpp"
#include "pendcore/simulate.hpp"
#include "pendcore/solution.hpp"
