// Pinocchio's articulated-body algorithm and its derivatives at their best: the joint type is known
// at compile time, in a collection of its own (a fifth quicker than the default one of twenty-five
// types), header-only.
#include <pinocchio/algorithm/aba-derivatives.hpp>
#include <pinocchio/algorithm/aba.hpp>
#include <utility>

#include "forward_dynamics.hpp"

namespace contenders {
namespace {

namespace pin = pinocchio;

template <class Scalar_, int options>
struct Hinges {
  using Scalar = Scalar_;
  static constexpr int Options = options;
  using JointModelRZ = pin::JointModelRevoluteTpl<Scalar, Options, 2>;
  using JointDataRZ = pin::JointDataRevoluteTpl<Scalar, Options, 2>;
  // The library's checks require this name.
  using JointModelMimic = pin::JointModelMimicTpl<Scalar, Options, contenders::Hinges>;
  using JointDataMimic = pin::JointDataMimicTpl<Scalar, Options, contenders::Hinges>;
  using JointModelVariant = boost::variant<JointModelRZ, boost::recursive_wrapper<JointModelMimic>>;
  using JointDataVariant = boost::variant<JointDataRZ, boost::recursive_wrapper<JointDataMimic>>;
};
using Model = pin::ModelTpl<double, 0, Hinges>;
using Data = pin::DataTpl<double, 0, Hinges>;
using Hinge = Hinges<double, 0>::JointModelRZ;

constexpr std::size_t longest = 200;

Model model_of(const Given& given) {
  Model model;
  model.gravity.linear() = Eigen::Vector3d(0, given["gravity"][0], 0);
  pin::JointIndex joint = 0;
  for (std::size_t i = 0; i < given.n(); ++i) {
    pin::SE3 placement = pin::SE3::Identity();
    if (i > 0) placement.translation()[0] = given["lengths"][i - 1];
    joint = model.addJoint(joint, Hinge(), placement, std::to_string(i));
    const double m = given["masses"][i], length = given["lengths"][i],
                 inertia = m * length * length / 12;
    const Eigen::Matrix3d about_center = Eigen::Vector3d(0, inertia, inertia).asDiagonal();
    const Eigen::Vector3d center(length / 2, 0, 0);
    model.appendBodyToJoint(joint, pin::Inertia(m, center, about_center), pin::SE3::Identity());
  }
  return model;
}

class PinocchioCalls : public Calls {
 public:
  PinocchioCalls(const Given& given, pin::Convention convention)
      : n_(given.n()),
        states_(given["q"].size() / n_),
        phi_(at_joints(given["q"], n_)),
        phid_(at_joints(given["qd"], n_)),
        convention_(convention),
        model_(model_of(given)),
        data_(model_),
        tau_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(n_))) {
    data_.kinematic_hessians.resize(6, 0, 0);
  }
  void make(int count) override {
    for (; count > 0; --count) state_ = next(state_, evaluate(state_)[last_], states_);
  }
  Numbers accelerations() override {
    const Eigen::VectorXd& found = evaluate(0);
    return of_links({found.data(), n_});
  }

 protected:
  using State = Eigen::Map<const Eigen::VectorXd>;
  State phi(std::size_t state) const { return {&phi_[state * n_], last_ + 1}; }
  State phid(std::size_t state) const { return {&phid_[state * n_], last_ + 1}; }
  const Eigen::VectorXd& evaluate(std::size_t state) {
    return pin::aba(model_, data_, phi(state), phid(state), tau_, convention_);
  }

  std::size_t n_, states_, state_ = 0;
  Eigen::Index last_ = static_cast<Eigen::Index>(n_) - 1;
  Numbers phi_, phid_;
  pin::Convention convention_;
  Model model_;
  Data data_;
  Eigen::VectorXd tau_;
};

// d phidd/d phi, d phidd/d phid and M^-1, of the joints' angles. The accelerations come first, by
// the same recursion or by aba.
class PinocchioDerivatives : public PinocchioCalls {
 public:
  PinocchioDerivatives(const Given& given, bool after_aba)
      : PinocchioCalls(given, pin::Convention::WORLD), after_aba_(after_aba) {}
  void make(int count) override {
    for (; count > 0; --count) {
      differentiate(state_);
      state_ = next(state_, data_.ddq_dq(last_, last_), states_);
    }
  }
  std::string outcome() override {
    differentiate(0);
    const Eigen::Index n = last_ + 1;
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> found(n, 3 * n);
    found << data_.ddq_dq, data_.ddq_dv, data_.Minv;
    return words({found.data(), found.data() + found.size()});
  }

 private:
  void differentiate(std::size_t state) {
    if (after_aba_) {
      evaluate(state);
      pin::computeABADerivatives(model_, data_);
    } else {
      pin::computeABADerivatives(model_, data_, phi(state), phid(state), tau_);
    }
  }
  bool after_aba_;
};

Contender entry(const std::string& word, pin::Convention convention) {
  return {"pinocchio_" + word + "_" CONTENDER_SUFFIX,
          "Pinocchio ABA, " + word + " frames, " CONTENDER_ARCHITECTURE,
          "Pinocchio " PINOCCHIO_VERSION " aba, Convention of " + word +
              " frames, collection of one joint type, " CONTENDER_BUILD,
          [convention](const Given& given) {
            if (given.words.at("effect") != "none")
              throw Unsupported("its ABA has no effects of its own");
            if (given.n() > longest)
              throw Unsupported("its Data holds 6 n^3 doubles, 0.4 GB at n = 200");
            return std::make_unique<PinocchioCalls>(given, convention);
          }};
}

Contender derivatives(bool after_aba) {
  const std::string way = after_aba ? "aba and computeABADerivatives" : "computeABADerivatives";
  return {
      std::string("pinocchio_") + (after_aba ? "after_aba_" : "") + CONTENDER_SUFFIX "_derivatives",
      "Pinocchio, " + way + ", " CONTENDER_ARCHITECTURE,
      "Pinocchio " PINOCCHIO_VERSION " " + way + ", collection of one joint type, " CONTENDER_BUILD,
      [after_aba](const Given& given) {
        return std::make_unique<PinocchioDerivatives>(given, after_aba);
      }};
}

}  // namespace

std::vector<Contender> contenders() {
  return {entry("local", pin::Convention::LOCAL), entry("world", pin::Convention::WORLD),
          derivatives(false), derivatives(true)};
}

}  // namespace contenders
