// The series of double pendulums in lanes, with options of their own (CMakeLists.txt).
#include "ensemble/series_of_double_pendulums.hpp"

namespace pendcore {

PENDCORE_SERIES_OF_DOUBLE_PENDULUMS()

}  // namespace pendcore
