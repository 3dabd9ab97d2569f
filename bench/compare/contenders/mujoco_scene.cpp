#include "mujoco_scene.hpp"

#include <cmath>

#include "effect_parameters.hpp"

namespace contenders {
namespace {

constexpr int everything = mjDSBL_CONSTRAINT | mjDSBL_EQUALITY | mjDSBL_FRICTIONLOSS |
                           mjDSBL_LIMIT | mjDSBL_CONTACT | mjDSBL_SPRING | mjDSBL_DAMPER |
                           mjDSBL_CLAMPCTRL | mjDSBL_ACTUATION | mjDSBL_SENSOR | mjDSBL_EULERDAMP |
                           mjDSBL_AUTORESET | mjDSBL_ISLAND;

void fill(double* to, double a, double b, double c) { to[0] = a, to[1] = b, to[2] = c; }

mjsJoint* add_link(mjsBody*& body, double begins_at, double mass, double length) {
  body = mjs_addBody(body, nullptr);
  const double inertia = mass * length * length / 12;
  fill(body->pos, begins_at, 0, 0);
  fill(body->ipos, length / 2, 0, 0);
  // MuJoCo would not compile an exactly slender rod. The inertia about its own axis has no effect.
  fill(body->inertia, 1e-6 * inertia, inertia, inertia);
  body->mass = mass;
  body->explicitinertial = 1;
  mjsJoint* joint = mjs_addJoint(body, nullptr);
  joint->type = mjJNT_HINGE;
  fill(joint->axis, 0, 1, 0);
  return joint;
}

mjsActuator* add_actuator(mjSpec* spec, mjsJoint* joint) {
  mjs_setName(joint->element, "driven");
  mjsActuator* actuator = mjs_addActuator(spec, nullptr);
  actuator->trntype = mjTRN_JOINT;
  mjs_setString(actuator->target, "driven");
  spec->option.disableflags &= ~mjDSBL_ACTUATION;
  return actuator;
}

void add_effect(mjSpec* spec, mjsBody* tip, double length, mjsJoint* joint,
                const std::string& effect) {
  int& off = spec->option.disableflags;
  if (effect == "none") return;
  if (effect == "user") {
    off &= ~mjDSBL_DAMPER;  // with springs and dampers off, mj_passive does nothing at all
  } else if (effect == "viscous_joint" || effect == "viscous_joint_3") {
    off &= ~mjDSBL_DAMPER;
    joint->damping[0] = damping;
    if (effect == "viscous_joint_3") joint->damping[1] = damping2, joint->damping[2] = damping3;
  } else if (effect == "dry_joint_friction") {
    off &= ~(mjDSBL_CONSTRAINT | mjDSBL_FRICTIONLOSS);
    joint->frictionloss = coulomb;
  } else if (effect == "rod_drag") {
    off &= ~mjDSBL_DAMPER;
    spec->option.density = air_density;
  } else if (effect == "torsional_spring") {
    off &= ~mjDSBL_SPRING;
    joint->stiffness[0] = stiffness;
    joint->springref = rest_angle;
  } else if (effect == "motor_constant" || effect == "motor_sinusoid") {
    mjs_setToMotor(add_actuator(spec, joint));
  } else if (effect == "motor_pd") {
    mjsActuator* actuator = add_actuator(spec, joint);
    double gain[1] = {kd};
    mjs_setToPosition(actuator, kp, gain, nullptr, nullptr, 0);
    actuator->forcelimited = mjLIMITED_TRUE;
    actuator->forcerange[0] = -limit, actuator->forcerange[1] = limit;
  } else if (effect == "rotor_inertia") {
    joint->armature = armature;
  } else if (effect == "payload") {
    // One body takes less work than a body that is fixed to another.
    const double mass = tip->mass + payload_mass, center = tip->ipos[0];
    const double moved = payload_mass / mass * (length - center);
    tip->inertia[1] += tip->mass * moved * (length - center) + payload_inertia;
    tip->inertia[2] = tip->inertia[1];
    tip->ipos[0] = center + moved;
    tip->mass = mass;
  } else if (effect == "joint_limit") {
    off &= ~(mjDSBL_CONSTRAINT | mjDSBL_LIMIT);
    joint->limited = mjLIMITED_TRUE;
    joint->range[0] = -bound, joint->range[1] = bound;
  } else {
    throw Unsupported("it has no " + effect);
  }
}

}  // namespace

Model model_of(const Scene& scene) {
  const Spec spec(mj_makeSpec());
  spec->compiler.degree = 0;
  spec->option.disableflags = everything;
  spec->option.integrator = mjINT_RK4;
  spec->option.timestep = 0.01;
  fill(spec->option.gravity, 0, 0, -scene.gravity);
  mjsBody* body = mjs_findBody(spec.get(), "world");
  mjsJoint* joint = nullptr;
  for (std::size_t i = 0; i < scene.n(); ++i) {
    const double begins_at = i > 0 ? scene.lengths[i - 1] : 0.0;
    joint = add_link(body, begins_at, scene.masses[i], scene.lengths[i]);
  }
  add_effect(spec.get(), body, scene.lengths.back(), joint, scene.effect);
  Model model(mj_compile(spec.get(), nullptr));
  if (!model) throw std::runtime_error(mjs_getError(spec.get()));
  return model;
}

Callbacks callbacks_of(const std::string& effect) {
  Callbacks callbacks;
  if (effect == "user") {
    callbacks.passive = [](const mjModel* /*model*/, mjData* data) {
      // The damper depends on the rate of link 2, and thus acts on the angles of both joints.
      const double couple = -user_damping * (data->qvel[0] + data->qvel[1]);
      data->qfrc_passive[0] += couple;
      data->qfrc_passive[1] += couple;
    };
  } else if (effect == "motor_sinusoid") {
    callbacks.control = [](const mjModel* /*model*/, mjData* data) {
      data->ctrl[0] = torque * std::sin(angular_frequency * data->time + phase);
    };
  }
  return callbacks;
}

double control_of(const std::string& effect) {
  if (effect == "motor_constant") return torque;
  return effect == "motor_pd" ? reference : 0.0;
}

}  // namespace contenders
