// pendcore's right-hand side as a C++ user calls it, and within whole runs.
#include "arithmetic/instruction_set.hpp"
#include "dynamics/first_order.hpp"
#include "effects/laws.hpp"
#include "forward_dynamics.hpp"
#include "integrate/method_list.hpp"
#include "integrate/runge_kutta/runge_kutta_fixed.hpp"
#include "pendcore_scene.hpp"
#include "simulate/steppers.hpp"

namespace contenders {
namespace {

void damp_second_link(double /*t*/, int /*n*/, const double* /*q*/, const double* qd, double* Q,
                      void* /*data*/) {
  Q[1] -= user_damping * qd[1];
}

// The scene of rods and effects, with this program's function if the effect is a user's.
pendcore::Scene whole_scene_of(const Given& given) {
  pendcore::Scene scene = scene_of(given);
  const std::string& effect = given.words.at("effect");
  if (effect == "user")
    scene.effects.push_back(
        pendcore::CompiledUser{.address = reinterpret_cast<std::uintptr_t>(&damp_second_link)});
  else if (effect != "none" && scene.effects.empty())
    throw Unsupported("it has no " + effect);
  return scene;
}

class RightHandSides : public Calls {
 public:
  explicit RightHandSides(const Given& given)
      : n_(given.n()),
        states_(given["q"].size() / n_),
        q_(given["q"]),
        qd_(given["qd"]),
        qdd_(n_),
        equations_(pendcore::equations_of_motion(whole_scene_of(given))) {
    accelerations();  // chooses the modes
  }
  void make(int count) override {
    for (; count > 0; --count) {
      const std::size_t at = state_ * n_;
      pendcore::accelerations_in_force(equations_, moment, &q_[at], &qd_[at], qdd_.data());
      state_ = next(state_, qdd_.back(), states_);
    }
  }
  Numbers accelerations() override {
    pendcore::accelerations(equations_, moment, q_.data(), qd_.data(), qdd_.data());
    return qdd_;
  }

 private:
  std::size_t n_, states_, state_ = 0;
  Numbers q_, qd_, qdd_;
  pendcore::EquationsOfMotion equations_;
};

class WholeRuns : public Calls {
 public:
  explicit WholeRuns(const Given& given) : scene_(whole_scene_of(given)) {
    const auto n = static_cast<std::ptrdiff_t>(given.n());
    q0_.assign(given["q"].begin(), given["q"].begin() + n);
    qd0_.assign(given["qd"].begin(), given["qd"].begin() + n);
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
  double parts() override { return static_cast<double>(solution_.statistics.nfev); }

 private:
  pendcore::Scene scene_;
  Numbers q0_, qd0_;
  pendcore::Options options_;
  pendcore::Solution solution_;
};

class Steps : public Calls {
 public:
  explicit Steps(const Given& given)
      : Steps(given, pendcore::make_stepper(whole_scene_of(given), "dopri5")) {}
  Steps(const Given& given, std::unique_ptr<pendcore::Stepper> stepper)
      : stepper_(std::move(stepper)) {
    const auto n = static_cast<std::ptrdiff_t>(given.n());
    Numbers y(given["q"].begin(), given["q"].begin() + n);
    y.insert(y.end(), given["qd"].begin(), given["qd"].begin() + n);
    Numbers rates(y.size());
    const Numbers tolerance(y.size(), 1e-9);
    stepper_->set_tolerances(tolerance.data(), tolerance.data());
    stepper_->evaluate(0.0, y.data(), rates.data());
    stepper_->start(y.data(), rates.data());
  }
  void make(int count) override {
    for (; count > 0; --count) error_ += stepper_->attempt({0.0}, 0.01, 0.0).squared_error;
  }
  double parts() override { return 6.0; }

 private:
  std::unique_ptr<pendcore::Stepper> stepper_;
  double error_ = 0;
};

// A and B, (2n, 2n) and (2n, n), with a torque in every joint.
class Linearizations : public Calls {
 public:
  explicit Linearizations(const Given& given)
      : states_(given["q"].size() / given.n()), equations_(scene_of(given)) {
    const auto n = static_cast<Eigen::Index>(given.n());
    for (std::size_t k = 0; k < states_; ++k) {
      q_.emplace_back(Eigen::Map<const pendcore::Vector>(&given["q"][k * given.n()], n));
      qd_.emplace_back(Eigen::Map<const pendcore::Vector>(&given["qd"][k * given.n()], n));
    }
    for (int joint = 1; joint <= n; ++joint) torques_.push_back({.joint = joint});
  }
  void make(int count) override {
    for (; count > 0; --count) {
      const pendcore::Linearization found = at(state_);
      state_ = next(state_, found.A(found.A.rows() - 1, 0), states_);
    }
  }
  std::string outcome() override {
    const pendcore::Linearization found = at(0);
    const auto n = found.B.cols();
    pendcore::Matrix both(n, 3 * n);
    both << found.A.bottomRows(n), found.B.bottomRows(n);
    return words({both.data(), both.data() + both.size()});
  }

 private:
  pendcore::Linearization at(std::size_t state) {
    return equations_.linearize(moment, q_[state], qd_[state], torques_);
  }
  std::size_t states_, state_ = 0;
  std::vector<pendcore::Vector> q_, qd_;
  pendcore::Equations equations_;
  std::vector<pendcore::Input> torques_;
};

// The kernel of the bare double pendulum, named by its type, without any code for effects.
std::unique_ptr<Calls> steps_of_kernel(const Given& given) {
  using namespace pendcore;
  using System = FirstOrder<DoublePendulum>;
  if (given.n() != 2 || given.words.at("effect") != "none")
    throw Unsupported("this kernel is for two bare links");
  const pendcore::Scene scene = whole_scene_of(given);
  return std::make_unique<Steps>(given, std::make_unique<RungeKuttaFixed<dormand_prince_5, System>>(
                                            System{DoublePendulum(scene, Inertia(scene))}));
}

const std::string registered =
    ", " + std::to_string(std::variant_size_v<pendcore::AnyLaw>) + " laws registered, ";

template <class Kind>
Contender entry(const std::string& name, const std::string& label, const std::string& about) {
  return {name, label, about + registered + CONTENDER_BUILD,
          [](const Given& given) { return std::make_unique<Kind>(given); }};
}

}  // namespace

std::vector<Contender> contenders() {
  return {entry<RightHandSides>("pendcore", "pendcore", "pendcore::accelerations_in_force"),
          entry<Steps>("pendcore_step", "pendcore in a step", "attempted steps of dopri5"),
          {"pendcore_kernel", "pendcore's kernel", "steps of its type", steps_of_kernel},
          entry<WholeRuns>("pendcore_run", "pendcore in a run",
                           "pendcore::simulate, dopri5, 5 s, rtol = atol = 1e-9"),
          entry<Linearizations>("pendcore_derivatives", "pendcore, linearize",
                                "pendcore::Equations::linearize")};
}

}  // namespace contenders
