// MuJoCo's forward dynamics at its best, in three ways: mj_forward without its sensors; its parts
// that a bare chain needs, called one by one; and whole runs of its Runge-Kutta method, with four
// right-hand sides a step.
#include <algorithm>
#include <utility>

#include "effect_parameters.hpp"
#include "forward_dynamics.hpp"
#include "mujoco_scene.hpp"

namespace contenders {
namespace {

constexpr std::size_t longest = 1000;
constexpr int steps = 50;  // steps in a run

class MujocoCalls : public Calls {
 public:
  explicit MujocoCalls(const Scene& scene)
      : n_(scene.n()),
        states_(scene.states()),
        phi_(at_joints(scene.q, n_)),
        phid_(at_joints(scene.qd, n_)),
        callbacks_(callbacks_of(scene.effect)),
        model_(model_of(scene)),
        data_(mj_makeData(model_.get())) {
    if (model_->nu > 0) data_->ctrl[0] = control_of(scene.effect);
  }

  void make(int count) override {
    // Other calls of this program may need other callbacks.
    mjcb_passive = callbacks_.passive;
    mjcb_control = callbacks_.control;
    for (; count > 0; --count) state_ = next(state_, call(state_), states_);
  }
  std::vector<double> accelerations() override {
    state_ = 0;
    make(1);
    return of_links({found(), n_});
  }

 protected:
  virtual double call(std::size_t state) = 0;  // the last joint's acceleration
  virtual const double* found() const { return data_->qacc; }

  void set(std::size_t state) {
    std::copy_n(&phi_[state * n_], n_, data_->qpos);
    std::copy_n(&phid_[state * n_], n_, data_->qvel);
    data_->time = moment;
  }

  std::size_t n_, states_, state_ = 0;
  std::vector<double> phi_, phid_;
  Callbacks callbacks_;
  Model model_;
  Data data_;
};

class Forward : public MujocoCalls {
  using MujocoCalls::MujocoCalls;
  double call(std::size_t state) override {
    set(state);
    mj_forwardSkip(model_.get(), data_.get(), mjSTAGE_NONE, 1);
    return data_->qacc[n_ - 1];
  }
};

class Parts : public MujocoCalls {
 public:
  explicit Parts(const Scene& scene) : MujocoCalls(scene) {
    if (scene.effect != "none") throw Unsupported("its parts are those of a bare chain");
  }

 private:
  double call(std::size_t state) override {
    set(state);
    const mjModel* model = model_.get();
    mjData* data = data_.get();
    mj_kinematics(model, data);
    mj_comPos(model, data);
    mj_crb(model, data);
    mj_factorM(model, data);
    mj_comVel(model, data);
    mj_rne(model, data, 0, data->qfrc_bias);
    for (std::size_t i = 0; i < n_; ++i) data->qfrc_smooth[i] = -data->qfrc_bias[i];
    mj_solveM(model, data, data->qacc_smooth, data->qfrc_smooth, 1);
    return data->qacc_smooth[n_ - 1];
  }
  const double* found() const override { return data_->qacc_smooth; }
};

class WholeRun : public MujocoCalls {
  using MujocoCalls::MujocoCalls;
  double right_hand_sides() override { return 4.0 * steps; }
  double call(std::size_t /*state*/) override {
    set(0);
    data_->time = 0;
    for (int i = 0; i < steps; ++i) mj_step(model_.get(), data_.get());
    return data_->qpos[n_ - 1];
  }
  std::vector<double> accelerations() override {
    throw Unsupported("a run says nothing of the accelerations");
  }
};

template <class Kind>
Contender entry(const std::string& word, const std::string& label, const std::string& about) {
  return forward_dynamics(
      "mujoco_" + word, "MuJoCo " + label,
      std::string("MuJoCo ") + mj_versionString() + " " + about + ", all else disabled, " +
          CONTENDER_BUILD,
      [](const Scene& scene) -> std::unique_ptr<Calls> {
        if (scene.n() > longest)
          throw Unsupported("its mass matrix is dense, and its time grows with n^3");
        return std::make_unique<Kind>(scene);
      });
}

}  // namespace

std::vector<Contender> contenders() {
  return {entry<Forward>("forward", "mj_forward", "mj_forwardSkip without sensors"),
          entry<Parts>("parts", "parts of mj_forward",
                       "mj_kinematics, comPos, crb, factorM, comVel, rne, solveM"),
          entry<WholeRun>("run", "in a run", "mj_step, RK4, 50 steps of 0.01 s")};
}

}  // namespace contenders
