// Lanes of Runge-Kutta methods for AVX-512: eight trajectories in a pack.
#include "ensemble/runge_kutta_runner.hpp"

namespace pendcore {

#if PENDCORE_CLONES
template std::unique_ptr<LaneRunner> make_runge_kutta_lanes<InstructionSet::x86_64_v4>(
    std::string_view, const LaneTask&);
#endif

}  // namespace pendcore
