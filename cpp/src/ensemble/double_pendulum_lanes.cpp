// The series of double pendulums in lanes, with options of their own (CMakeLists.txt).
#include "pendcore/ensemble/series_lanes.hpp"

namespace pendcore {

PENDCORE_DOUBLE_PENDULUM_LANES(BareDoublePendulumSeries, x86_64_v3);
PENDCORE_DOUBLE_PENDULUM_LANES(LoadedDoublePendulumSeries, x86_64_v3);
#if PENDCORE_CLONES
PENDCORE_DOUBLE_PENDULUM_LANES(BareDoublePendulumSeries, x86_64_v4);
PENDCORE_DOUBLE_PENDULUM_LANES(LoadedDoublePendulumSeries, x86_64_v4);
#endif

}  // namespace pendcore
