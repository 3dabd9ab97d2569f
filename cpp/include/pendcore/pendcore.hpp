/// \file
/// All of pendcore in one include.
#pragma once

#include "pendcore/effects.hpp"
#include "pendcore/ensemble.hpp"
#include "pendcore/equations.hpp"
#include "pendcore/lyapunov.hpp"
#include "pendcore/mechanics.hpp"
#include "pendcore/methods.hpp"
#include "pendcore/parameters.hpp"
#include "pendcore/scene.hpp"
#include "pendcore/simulate.hpp"
#include "pendcore/solution.hpp"
