#include "pendcore/simulate/explicit_stepper.hpp"

namespace pendcore {

template std::unique_ptr<Stepper> explicit_stepper<dormand_prince_8>(const Scene&,
                                                                     const EquationsOfMotion&, bool,
                                                                     bool);

}  // namespace pendcore
