// The cost of an effect in the right-hand side of two links, within an attempted step of dopri5:
// the column "a call" is a sixth of the step.
#include <benchmark/benchmark.h>
#include <pendcore/pendcore.hpp>
#include <vector>

#include "calls.hpp"

namespace {

using namespace pendcore;

void step(benchmark::State& state, const std::vector<Effect>& effects) {
  Scene scene = Scene::textbook();
  scene.effects = effects;
  const auto stepper = begun(scene, "dopri5", {0.785, 1.047, 0.3, -0.2});
  for (auto _ : state) benchmark::DoNotOptimize(stepper->attempt({0.0}, 0.01, 0.0));
  set_calls(state, 6);
}

const ViscousJoint first_damped{.joint = 1, .damping = 0.1};
const ViscousJoint damped{.joint = 2, .damping = 0.1};
const TorsionalSpring spring{.joint = 2, .stiffness = 5.0};
const RodDrag first_in_air{.link = 1, .drag_coefficient = 1.2, .diameter = 0.05};
const RodDrag in_air{.link = 2, .drag_coefficient = 1.2, .diameter = 0.05};
const RotorInertia rotor{.joint = 2, .armature = 0.05};
const Motor constant{.joint = 2, .constant = 0.5};
const Motor swinging{
    .joint = 2, .sinusoid = Sinusoid{.amplitude = 0.5, .angular_frequency = 3.0, .phase = 0.0}};
const Motor controlling{.joint = 2, .pd = PD{.kp = 5.0, .kd = 0.5, .reference = 0.3}};
const DrivenPivot shaken{.x = Sinusoid{.amplitude = 0.01, .angular_frequency = 20.0, .phase = 0.0}};

using List = std::vector<Effect>;
BENCHMARK_CAPTURE(step, none, List{})->Name("effects/none");
BENCHMARK_CAPTURE(step, viscous, List{damped})->Name("effects/viscous joint");
BENCHMARK_CAPTURE(step, both, List{first_damped, damped})->Name("effects/viscous joints, both");
BENCHMARK_CAPTURE(step, spring, List{spring})->Name("effects/torsional spring");
BENCHMARK_CAPTURE(step, drag, List{first_in_air, in_air})->Name("effects/rod drag, both links");
BENCHMARK_CAPTURE(step, rotor, List{rotor})->Name("effects/rotor inertia");
BENCHMARK_CAPTURE(step, constant, List{constant})->Name("effects/motor, constant");
BENCHMARK_CAPTURE(step, sinusoid, List{swinging})->Name("effects/motor, sinusoid");
BENCHMARK_CAPTURE(step, pd, List{controlling})->Name("effects/motor, PD");
BENCHMARK_CAPTURE(step, pivot, List{shaken})->Name("effects/driven pivot, sinusoid");
BENCHMARK_CAPTURE(step, all,
                  List{first_damped, damped, spring, first_in_air, in_air, rotor, swinging, shaken})
    ->Name("effects/eight at once");

}  // namespace
