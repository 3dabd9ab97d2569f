#include "dynamics/ends_in_air.hpp"

#include "arithmetic/instruction_set.hpp"

namespace pendcore {
namespace {

PENDCORE_INLINE void find(const EndsInAir<double>* air, double t, const double* y,
                          const double* dydt, EndsInAir<double>::Speeds* found) {
  air->find(t, y, dydt, *found);
}

}  // namespace

void find_speeds(const EndsInAir<double>& air, double t, const double* y, const double* dydt,
                 EndsInAir<double>::Speeds& found) {
  on_this_processor<&find>(&air, t, y, dydt, &found);
}

}  // namespace pendcore
