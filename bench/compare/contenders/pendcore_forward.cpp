// pendcore's right-hand side as a C++ user calls it, and within whole runs.
#include <pendcore/pendcore.hpp>
#include <utility>
#include "dynamics/first_order.hpp"
#include "integrate/method_list.hpp"
#include "integrate/runge_kutta/runge_kutta_fixed.hpp"

#include "arithmetic/instruction_set.hpp"
#include "effect_parameters.hpp"
#include "effects/laws.hpp"
#include "forward_dynamics.hpp"
#include "simulate/steppers.hpp"

namespace contenders {
namespace {

void damp_second_link(double /*t*/, int /*n*/, const double* /*q*/, const double* qd, double* Q,
                      void* /*data*/) {
  Q[1] -= user_damping * qd[1];
}

// A name that ends with _0 stands for the same effect with a coefficient of 0.
std::vector<pendcore::Effect> effects_of(const std::string& name) {
  using namespace pendcore;
  if (name == "viscous_joint_0") return {ViscousJoint{.joint = 2, .damping = 0.0}};
  if (name == "torsional_spring_0") return {TorsionalSpring{.joint = 2, .stiffness = 0.0}};
  if (name == "rod_drag_0") {
    const RodDrag first{.link = 1, .drag_coefficient = 0.0, .diameter = diameter};
    RodDrag second = first;
    second.link = 2;
    return {first, second};
  }
  const Sinusoid swing{.amplitude = torque, .angular_frequency = angular_frequency, .phase = phase};
  const Sinusoid shake{.amplitude = drive, .angular_frequency = drive_frequency, .phase = 0.0};
  const PD pd{.kp = kp, .kd = kd, .reference = reference};
  if (name == "none") return {};
  if (name == "viscous_joint") return {ViscousJoint{.joint = 2, .damping = damping}};
  if (name == "viscous_joint_3")
    return {
        ViscousJoint{.joint = 2, .damping = damping, .damping2 = damping2, .damping3 = damping3}};
  if (name == "dry_joint_friction") return {DryJointFriction{.joint = 2, .coulomb = coulomb}};
  if (name == "rod_drag") {
    const RodDrag first{.link = 1,
                        .drag_coefficient = drag_coefficient,
                        .diameter = diameter,
                        .air_density = air_density};
    RodDrag second = first;
    second.link = 2;
    return {first, second};
  }
  if (name == "torsional_spring")
    return {TorsionalSpring{.joint = 2, .stiffness = stiffness, .rest_angle = rest_angle}};
  if (name == "motor_constant") return {Motor{.joint = 2, .constant = torque}};
  if (name == "motor_sinusoid") return {Motor{.joint = 2, .sinusoid = swing}};
  if (name == "motor_table")
    return {Motor{.joint = 2, .table = Table{.t = {-1.0, 10.0}, .torque = {0.0, torque}}}};
  if (name == "motor_pd") return {Motor{.joint = 2, .pd = pd, .limit = limit}};
  if (name == "rotor_inertia") return {RotorInertia{.joint = 2, .armature = armature}};
  if (name == "payload") return {Payload{.mass = payload_mass, .inertia = payload_inertia}};
  if (name == "driven_pivot") return {DrivenPivot{.x = shake}};
  if (name == "joint_limit") return {JointStop{.joint = 2, .range = {-bound, bound}}};
  if (name == "user")
    return {CompiledUser{.address = reinterpret_cast<std::uintptr_t>(&damp_second_link)}};
  throw Unsupported("it has no " + name);
}

pendcore::Scene scene_of(const Scene& given) {
  pendcore::Scene scene;
  for (std::size_t i = 0; i < given.n(); ++i)
    scene.links.push_back(pendcore::Link::uniform_rod(given.masses[i], given.lengths[i]));
  scene.gravity = given.gravity;
  scene.effects = effects_of(given.effect);
  return scene;
}

class RightHandSides : public Calls {
 public:
  explicit RightHandSides(const Scene& given)
      : n_(given.n()),
        states_(given.states()),
        q_(given.q),
        qd_(given.qd),
        qdd_(n_),
        equations_(pendcore::equations_of_motion(scene_of(given))) {
    accelerations();  // chooses the modes
  }
  void make(int count) override {
    for (; count > 0; --count) {
      const std::size_t at = state_ * n_;
      pendcore::accelerations_in_force(equations_, moment, &q_[at], &qd_[at], qdd_.data());
      state_ = next(state_, qdd_.back(), states_);
    }
  }
  std::vector<double> accelerations() override {
    pendcore::accelerations(equations_, moment, q_.data(), qd_.data(), qdd_.data());
    return qdd_;
  }

 private:
  std::size_t n_, states_, state_ = 0;
  std::vector<double> q_, qd_, qdd_;
  pendcore::EquationsOfMotion equations_;
};

class WholeRuns : public Calls {
 public:
  explicit WholeRuns(const Scene& given) : scene_(scene_of(given)) {
    const auto n = static_cast<std::ptrdiff_t>(given.n());
    q0_.assign(given.q.begin(), given.q.begin() + n);
    qd0_.assign(given.qd.begin(), given.qd.begin() + n);
    options_.rtol = options_.atol = {1e-9};
    options_.method = "dopri5";
    options_.store = pendcore::Store::end;
    make(1);
    if (solution_.status != pendcore::Status::finished) throw std::runtime_error(solution_.message);
  }
  void make(int count) override {
    for (; count > 0; --count)
      solution_ = pendcore::simulate(scene_, q0_, qd0_, 0.0, 5.0, options_);
  }
  double right_hand_sides() override { return static_cast<double>(solution_.statistics.nfev); }
  std::vector<double> accelerations() override {
    throw Unsupported("a run says nothing of the accelerations");
  }

 private:
  pendcore::Scene scene_;
  std::vector<double> q0_, qd0_;
  pendcore::Options options_;
  pendcore::Solution solution_;
};

class Steps : public Calls {
 public:
  explicit Steps(const Scene& given)
      : Steps(given, pendcore::make_stepper(scene_of(given), "dopri5")) {}
  Steps(const Scene& given, std::unique_ptr<pendcore::Stepper> stepper)
      : stepper_(std::move(stepper)) {
    const auto n = static_cast<std::ptrdiff_t>(given.n());
    std::vector<double> y(given.q.begin(), given.q.begin() + n);
    y.insert(y.end(), given.qd.begin(), given.qd.begin() + n);
    std::vector<double> rates(y.size());
    const std::vector<double> tolerance(y.size(), 1e-9);
    stepper_->set_tolerances(tolerance.data(), tolerance.data());
    stepper_->evaluate(0.0, y.data(), rates.data());
    stepper_->start(y.data(), rates.data());
  }
  void make(int count) override {
    for (; count > 0; --count) error_ += stepper_->attempt({0.0}, 0.01, 0.0).squared_error;
  }
  double right_hand_sides() override { return 6.0; }
  std::vector<double> accelerations() override {
    throw Unsupported("a step does not give the accelerations");
  }

 private:
  std::unique_ptr<pendcore::Stepper> stepper_;
  double error_ = 0;
};

// The kernel of the bare double pendulum, named by its type, without any code for effects.
std::unique_ptr<Calls> steps_of_kernel(const Scene& given) {
  using namespace pendcore;
  using System = FirstOrder<DoublePendulum>;
  if (given.n() != 2 || given.effect != "none")
    throw Unsupported("this kernel is for two bare links");
  const pendcore::Scene scene = scene_of(given);
  return std::make_unique<Steps>(given, std::make_unique<RungeKuttaFixed<dormand_prince_5, System>>(
                                            System{DoublePendulum(scene, Inertia(scene))}));
}

const std::string registered =
    ", " + std::to_string(std::variant_size_v<pendcore::AnyLaw>) + " laws registered, ";

template <class Kind>
Contender entry(const std::string& name, const std::string& label, const std::string& about) {
  return forward_dynamics(name, label, about + registered + CONTENDER_BUILD,
                          [](const Scene& given) { return std::make_unique<Kind>(given); });
}

}  // namespace

std::vector<Contender> contenders() {
  return {entry<RightHandSides>("pendcore", "pendcore", "pendcore::accelerations_in_force"),
          entry<Steps>("pendcore_step", "pendcore in a step", "attempted steps of dopri5"),
          forward_dynamics("pendcore_kernel", "pendcore's kernel", "steps of its type",
                           steps_of_kernel),
          entry<WholeRuns>("pendcore_run", "pendcore in a run",
                           "pendcore::simulate, dopri5, 5 s, rtol = atol = 1e-9")};
}

}  // namespace contenders
