// Lanes of Runge-Kutta methods for AVX2, and for builds without clones: four trajectories a pack.
#include "ensemble/runge_kutta_runner.hpp"

namespace pendcore {

template std::unique_ptr<LaneRunner> make_runge_kutta_lanes<InstructionSet::x86_64_v3>(
    std::string_view, const LaneTask&);

}  // namespace pendcore
