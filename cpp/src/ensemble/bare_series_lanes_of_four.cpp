// The series of bare double pendulums, four trajectories at a time. AVX2 has few registers: by -O3,
// and with fma() left as a loop until GCC has assigned them, members take 0.91 of the time (an AMD
// EPYC without AVX-512, GCC 12). By either alone they take 0.96 and 1.02, three links by both 1.3.
#define PENDCORE_NAMES_FMA 0
#include "ensemble/series_lanes.hpp"

namespace pendcore {

ExpandBareSeriesOfFour expand_bare_series_of_four() {
  return only<&expand_in_lanes<BareDoublePendulumSeries<Pack<4>>, Pack<4>>,
              InstructionSet::x86_64_v3>();
}

}  // namespace pendcore
