// MuJoCo's forward dynamics at its best, in three ways: mj_forward without its sensors; its parts
// that a bare chain needs, called one by one; and whole runs of its Runge-Kutta method, with four
// right-hand sides a step. The word `model` of what is given names the file of the model, which
// mujoco_models.py makes.
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>

#include "forward_dynamics.hpp"

namespace contenders {
namespace {

constexpr int steps = 50;  // steps in a run

struct Delete {
  void operator()(mjModel* model) const { mj_deleteModel(model); }
  void operator()(mjData* data) const { mj_deleteData(data); }
};

const double* wave = nullptr;  // that of the calls that are made now

void damp_second_link(const mjModel* /*model*/, mjData* data) {
  // The damper depends on the rate of link 2, and thus acts on the angles of both joints.
  const double couple = -user_damping * (data->qvel[0] + data->qvel[1]);
  data->qfrc_passive[0] += couple;
  data->qfrc_passive[1] += couple;
}

void drive(const mjModel* /*model*/, mjData* data) {
  data->ctrl[0] = wave[0] * std::sin(wave[1] * data->time + wave[2]);
}

class MujocoCalls : public Calls {
 public:
  explicit MujocoCalls(const Given& given)
      : n_(given.n()),
        states_(given["q"].size() / n_),
        phi_(at_joints(given["q"], n_)),
        phid_(at_joints(given["qd"], n_)),
        is_user_(given.words.at("effect") == "user"),
        model_(mj_loadModel(given.words.at("model").c_str(), nullptr)),
        data_(mj_makeData(model_.get())) {
    for (const auto& [kind, parameters] : given.effects)
      for (const auto& [name, numbers] : parameters) {
        if (name == "constant" || name == "pd.reference") data_->ctrl[0] = numbers[0];
        if (name == "sinusoid.amplitude") wave_ = {numbers[0], 0, 0};
        if (name == "sinusoid.angular_frequency") wave_[1] = numbers[0];
        if (name == "sinusoid.phase") wave_[2] = numbers[0];
      }
  }

  void make(int count) override {
    // Other calls of this program may need other callbacks.
    mjcb_passive = is_user_ ? damp_second_link : nullptr;
    mjcb_control = wave_.empty() ? nullptr : drive;
    wave = wave_.data();
    for (; count > 0; --count) state_ = next(state_, call(state_), states_);
  }
  Numbers accelerations() override {
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
  Numbers phi_, phid_;
  Numbers wave_;  // amplitude, angular frequency and phase of a motor
  bool is_user_;
  std::unique_ptr<mjModel, Delete> model_;
  std::unique_ptr<mjData, Delete> data_;
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
  explicit Parts(const Given& given) : MujocoCalls(given) {
    if (given.words.at("effect") != "none")
      throw Unsupported("its parts are those of a bare chain");
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
  double parts() override { return 4.0 * steps; }
  double call(std::size_t /*state*/) override {
    set(0);
    data_->time = 0;
    for (int i = 0; i < steps; ++i) mj_step(model_.get(), data_.get());
    return data_->qpos[n_ - 1];
  }
  Numbers accelerations() override { return Calls::accelerations(); }
};

template <class Kind>
Contender entry(const std::string& word, const std::string& label, const std::string& about) {
  return {"mujoco_" + word, "MuJoCo " + label,
          std::string("MuJoCo ") + mj_versionString() + " " + about + ", all else disabled, " +
              CONTENDER_BUILD,
          [](const Given& given) { return std::make_unique<Kind>(given); }};
}

}  // namespace

std::vector<Contender> contenders() {
  return {entry<Forward>("forward", "mj_forward", "mj_forwardSkip without sensors"),
          entry<Parts>("parts", "parts of mj_forward",
                       "mj_kinematics, comPos, crb, factorM, comVel, rne, solveM"),
          entry<WholeRun>("run", "in a run", "mj_step, RK4, 50 steps of 0.01 s")};
}

}  // namespace contenders
