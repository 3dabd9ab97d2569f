// Scenes as MuJoCo's models: bodies without shapes, and nothing computed that the scene has not.
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

// Throws Unsupported for an effect that MuJoCo has no counterpart of.
Model model_of(const Scene& scene);

// What MuJoCo calls back for the effect of that name; nothing for most.
struct Callbacks {
  mjfGeneric passive = nullptr, control = nullptr;
};
Callbacks callbacks_of(const std::string& effect);

// What its actuator is set to, once for all calls.
double control_of(const std::string& effect);

}  // namespace contenders
