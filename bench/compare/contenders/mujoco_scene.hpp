// Scenes as MuJoCo's models: bodies without shapes, with everything switched off that the scene
// does not have.
#pragma once

#include <mujoco/mujoco.h>

#include <memory>

#include "forward_dynamics.hpp"

namespace contenders {

struct Delete {
  void operator()(mjSpec* spec) const { mj_deleteSpec(spec); }
  void operator()(mjModel* model) const { mj_deleteModel(model); }
  void operator()(mjData* data) const { mj_deleteData(data); }
};
using Spec = std::unique_ptr<mjSpec, Delete>;
using Model = std::unique_ptr<mjModel, Delete>;
using Data = std::unique_ptr<mjData, Delete>;

// Throws Unsupported for an effect without a counterpart in MuJoCo.
Model model_of(const Scene& scene);

// The callbacks of MuJoCo for the effect of that name; empty for most effects.
struct Callbacks {
  mjfGeneric passive = nullptr, control = nullptr;
};
Callbacks callbacks_of(const std::string& effect);

// The value of the actuator for the effect, set once for all calls.
double control_of(const std::string& effect);

}  // namespace contenders
