#include "dynamics/inverse_dynamics.hpp"

#include "arithmetic/instruction_set.hpp"
#include "arithmetic/sine_cosine.hpp"
#include "dynamics/kinematics.hpp"

namespace pendcore {

template <class Number>
void InverseDynamics<Number>::compute(const Mechanism<Number>& mechanism, double t,
                                      const Numbers& q, const Numbers& qd, const Numbers& qdd) {
  const auto n = static_cast<int>(mechanism.bodies.size());
  sine_.resize(n);
  cosine_.resize(n);
  sine_cosine(q.data(), n, sine_.data(), cosine_.data());
  waves_.assign(mechanism.effects.size(), {});
  at_.resize(n);
  inertial_.resize(n);
  loads_.assign(n, {});
  torques_.resize(n);
  forces_.resize(n);
  on_this_processor<&InverseDynamics::go_out_and_back>(this, &mechanism, t, q.data(), qd.data(),
                                                       qdd.data());
}

template <class Number>
PENDCORE_INLINE void InverseDynamics<Number>::go_out_and_back(InverseDynamics* self,
                                                              const Mechanism<Number>* mechanism,
                                                              double t, const double* q,
                                                              const double* qd, const double* qdd) {
  using Vector2 = Planar<Number>;
  const auto constant = [](double x) { return Constants<Number>::of(x); };
  const auto n = static_cast<int>(mechanism->bodies.size());
  const double* const sine = self->sine_.data();
  const double* const cosine = self->cosine_.data();

  // The waves, and the motion of the pivot.
  Vector2 velocity, acceleration;
  for (std::size_t e = 0; e < mechanism->effects.size(); ++e) {
    const auto& effect = mechanism->effects[e];
    auto& [s, c] = self->waves_[e];
    for (std::size_t k = 0; k < effect.waves.size(); ++k) {
      const Number angle = t * effect.waves[k].angular_frequency + effect.waves[k].phase;
      sine_cosine(angle, s[k], c[k]);
    }
    if (!effect.moves_pivot) continue;
    effect.pivot.add_acceleration(constant(t), s, acceleration.x, acceleration.y);
    effect.pivot.add_velocity(constant(t), c, velocity.x, velocity.y);
  }

  // From the pivot to the tip: where each joint goes, and what it takes to move each link.
  acceleration.y = acceleration.y - mechanism->gravity;
  for (int i = 0; i < n; ++i) {
    const auto& body = mechanism->bodies[i];
    self->at_[i] = {.t = t,
                    .q = constant(q[i]),
                    .qd = constant(qd[i]),
                    .s = constant(sine[i]),
                    .c = constant(cosine[i]),
                    .L = body.length,
                    .angle = constant(relative(q, i + 1)),
                    .rate = constant(relative(qd, i + 1)),
                    .vx_of_joint = velocity.x,
                    .vy_of_joint = velocity.y};
    velocity = {velocity.x - (qd[i] * sine[i]) * body.length,
                velocity.y + (qd[i] * cosine[i]) * body.length};
    const double square = qd[i] * qd[i];
    const double x = -qdd[i] * sine[i] - square * cosine[i];  // of an arm of 1 m
    const double y = qdd[i] * cosine[i] - square * sine[i];
    self->inertial_[i] = {body.mass * (acceleration.x + x * body.center),
                          body.mass * (acceleration.y + y * body.center)};
    acceleration = {acceleration.x + x * body.length, acceleration.y + y * body.length};
  }

  for (std::size_t e = 0; e < mechanism->effects.size(); ++e) {
    const auto& [pivot, law, couple, waves, place, moves_pivot] = mechanism->effects[e];
    RowLoads<Number>& loads = self->loads_[place];
    if (couple) {
      loads.couple(couple->torque(t, relative(q, place + 1), relative(qd, place + 1),
                                  self->waves_[e].sine[0]));
    } else if (law) {
      std::visit([&](const auto& one) { one.add(self->at_[place], loads); }, *law);
    }
  }

  // From the tip to the pivot.
  Vector2 beyond{mechanism->payload_mass * acceleration.x,
                 mechanism->payload_mass * acceleration.y};  // F_{i,i+1}
  Number torque = qdd[n - 1] * mechanism->payload_inertia;
  for (int i = n; i-- > 0;) {
    const auto& body = mechanism->bodies[i];
    const RowLoads<Number>& loads = self->loads_[i];
    const Vector2& inertial = self->inertial_[i];
    const auto across = [&](const Vector2& force) __attribute__((always_inline)) {
      return cosine[i] * force.y - sine[i] * force.x;
    };
    torque = torque + qdd[i] * body.inertia + body.center * across(inertial) +
             body.length * across(beyond) - loads.moments;
    beyond = {beyond.x + inertial.x - loads.fx, beyond.y + inertial.y - loads.fy};
    self->forces_[i] = beyond;
    self->torques_[i] = torque + relative(qdd, i + 1) * body.armature - loads.couples;
  }
}

template class InverseDynamics<double>;
template class InverseDynamics<AlongParameters>;

void ChangesOfAccelerations::compute(const std::vector<Mechanism<AlongParameters>>& mechanisms,
                                     double t, const Numbers& q, const Numbers& qd,
                                     const Numbers& qdd, JointForces& forces,
                                     Eigen::Ref<Matrix> changes) {
  const std::size_t m = forces.joints.size();
  torques_.resize(m);
  change_.resize(q.size());
  for (std::size_t p = 0; p < mechanisms.size(); ++p) {
    motion_.compute(mechanisms[p], t, q, qd, qdd);
    for (std::size_t k = 0; k < parameters_at_once; ++k) {
      const auto column = static_cast<Eigen::Index>(p * parameters_at_once + k);
      if (column >= changes.cols()) break;
      for (std::size_t r = 0; r < m; ++r) {
        torques_[r] = -lane(motion_.torques()[forces.joints[r]].slope, static_cast<int>(k));
      }
      forces.respond(torques_.data(), change_.data());
      changes.col(column) = change_;
    }
  }
}

}  // namespace pendcore
