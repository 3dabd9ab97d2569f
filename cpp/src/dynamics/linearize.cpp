#include <algorithm>
#include <cmath>
#include <iterator>

#include "arithmetic/epsilon.hpp"
#include "arithmetic/floating_point_environment.hpp"
#include "dynamics/compiled_equations.hpp"
#include "dynamics/contact/held_joints.hpp"
#include "dynamics/inverse_dynamics.hpp"
#include "dynamics/kinematics.hpp"
#include "dynamics/possible_state.hpp"
#include "effects/behaviour.hpp"
#include "pendcore/effects/joint_stop.hpp"
#include "pendcore/effects/lock.hpp"
#include "pendcore/effects/motor.hpp"
#include "pendcore/effects/payload.hpp"
#include "pendcore/effects/rotor_inertia.hpp"
#include "pendcore/effects/viscous_joint.hpp"

namespace pendcore {
namespace {

/// The largest difference of two derivatives, as a share of the largest entry, that is rounding.
constexpr double rounding_of_derivatives = 1e-10;

std::string joint_name(const EffectBehaviour& effect) {
  return "joint " + std::to_string(effect.joint());
}

/// Throws for a joint that is at an end of its range, or beyond it.
void require_inside_stops(const Scene& scene, const double* q) {
  for (std::size_t i = 0; i < scene.effects.size(); ++i) {
    const auto* stop = scene.effects[i].get_if<JointStop>();
    if (stop == nullptr) continue;
    const double phi = relative(q, stop->joint);
    const auto [lower, upper] = stop->range;
    const double rounding = last_bits_share * std::max(1.0, std::abs(phi));
    if (phi - lower > rounding && upper - phi > rounding) continue;
    throw std::invalid_argument(
        effect_name(scene, i) + ": joint " + std::to_string(stop->joint) + " is at " + text(phi) +
        " rad, an end of its range: the motion has no derivative there; inside the range it has "
        "one, and at rest at the stop it is that of a scene with Lock(joint=" +
        std::to_string(stop->joint) + ")");
  }
}

/// The modes that meet at a state beside the mode of an effect there: those of the guards that are
/// zero, and that of a run which comes to this time from the other side.
std::vector<int> modes_beside(const EffectBehaviour& effect, int mode, int from_other_side,
                              const double* q, const double* qd, double speed) {
  std::vector<int> found;
  if (from_other_side != mode) found.push_back(from_other_side);
  const int joint = effect.joint();
  const double phi = joint > 0 ? relative(q, joint) : 0.0;
  const double phid = joint > 0 ? relative(qd, joint) : 0.0;
  const std::vector<Guard> guards = effect.guards(mode);
  for (std::size_t k = 0; k < guards.size(); ++k) {
    const auto& [offset, on_phi, on_phid] = guards[k];
    const double size = std::abs(offset) + std::abs(on_phi * phi) +
                        std::abs(on_phid) * std::max(std::abs(phid), speed);
    const double value = offset + on_phi * phi + on_phid * phid;
    if (std::abs(value) <= last_bits_share * size) found.push_back(effect.next_mode(mode, k));
  }
  return found;
}

[[noreturn]] void refuse_corner(const Scene& scene, std::size_t i, double t, bool is_in_time) {
  const EffectBehaviour& effect = *scene.effects[i];
  const std::string name = effect_name(scene, i) + ": ";
  if (is_in_time) {
    throw std::invalid_argument(name + "its law jumps at t = " + text(t) +
                                " s: the motion has no derivative there; it has one at any time "
                                "before or after that");
  }
  if (effect.holding_torque()) {
    throw std::invalid_argument(
        name + joint_name(effect) +
        " is at rest, where dry friction jumps: the motion has no derivative there. It has one "
        "where the joint slides, at a rate of either sign; and where it sticks, that of a scene "
        "with Lock(" +
        joint_name(effect).replace(5, 1, "=") + ") in place of the friction");
  }
  throw std::invalid_argument(name + "two of its laws meet at this state of " + joint_name(effect) +
                              ": the motion has no derivative there; it has one on either side, at "
                              "a slightly larger or smaller angle or rate");
}

/// What has to agree on both sides of a state: the accelerations and their derivatives.
struct DerivativesAt {
  Vector qdd;
  Derivatives by;
  Matrix by_parameters;  ///< (n, k)

  bool agree(const DerivativesAt& other) const {
    const double largest = std::max({largest_of(qdd), largest_of(by.by_q), largest_of(by.by_qd)});
    const double rounding = rounding_of_derivatives * largest;
    const Vector columns = by_parameters.cwiseAbs().colwise().maxCoeff().transpose();
    const Matrix differences = (by_parameters - other.by_parameters).cwiseAbs();
    for (Eigen::Index k = 0; k < columns.size(); ++k) {
      if (largest_of(differences.col(k)) > rounding_of_derivatives * columns[k]) return false;
    }
    return largest_of(qdd - other.qdd) <= rounding &&
           largest_of(by.by_q - other.by.by_q) <= rounding &&
           largest_of(by.by_qd - other.by.by_qd) <= rounding;
  }

 private:
  template <class Numbers>
  static double largest_of(const Numbers& numbers) {
    return numbers.size() == 0 ? 0.0 : numbers.cwiseAbs().maxCoeff();
  }
};

std::string input_name(int joint) { return "inputs: torque in joint " + std::to_string(joint); }

void require_joint(const Scene& scene, int joint) {
  const auto n = static_cast<int>(scene.links.size());
  if (joint >= 1 && joint <= n) return;
  throw std::invalid_argument(input_name(joint) + ": must be one of the joints 1 to " +
                              std::to_string(n));
}

/// The links, payloads, rotors and locks of a scene, with a damper of 1 N m s in each joint that
/// turns, and a gravity of -1 m/s^2: at rest, qdd is what an acceleration of the pivot of 1 m/s^2
/// along y gives. It changes as if by one along x where all links turn, and by the torques of the
/// dampers where rates change.
Scene scene_of_inputs(const Scene& scene) {
  Scene result{.links = scene.links, .gravity = -1.0};
  std::ranges::copy_if(scene.effects, std::back_inserter(result.effects), [](const Effect& one) {
    return one.is<Payload>() || one.is<RotorInertia>() || one.is<Lock>();
  });
  const std::vector<bool> locked = locked_joints(scene);
  for (int joint = 1; joint <= std::ssize(locked); ++joint) {
    if (locked[joint - 1]) continue;
    result.effects.push_back(ViscousJoint{.joint = joint, .damping = 1.0});
  }
  return result;
}

/// What inputs of one unit add to qdd, (k, n); nothing for a parameter. The Jacobian is that of
/// scene_of_inputs().
Matrix responses_to(const std::vector<Input>& inputs, const Scene& scene, const Numbers& q,
                    const Jacobian& jacobian) {
  const Eigen::Index n = q.size();
  const auto count = static_cast<Eigen::Index>(inputs.size());
  const std::vector<bool> locked = locked_joints(scene);
  Matrix angles = Matrix::Zero(count, n);
  Matrix rates = angles;
  for (Eigen::Index k = 0; k < count; ++k) {
    if (inputs[k].kind == Input::Kind::pivot_x) angles.row(k).setOnes();
    if (inputs[k].kind != Input::Kind::torque) continue;
    const int joint = inputs[k].joint;
    require_joint(scene, joint);
    if (locked[joint - 1]) {
      throw std::invalid_argument(input_name(joint) +
                                  ": a Lock holds this joint, which no torque turns: choose "
                                  "another joint, or a scene without this Lock");
    }
    rates.row(k).tail(n - joint + 1).setConstant(-1.0);
  }
  const Vector rest = Vector::Zero(n);
  Vector qdd(n);
  Matrix responses(count, n);
  jacobian.along(0.0, q.data(), rest.data(), static_cast<int>(count), angles.data(), rates.data(),
                 qdd.data(), responses.data());
  for (Eigen::Index k = 0; k < count; ++k) {
    if (inputs[k].kind == Input::Kind::pivot_y) responses.row(k) = qdd.transpose();
  }
  return responses;
}

ParameterChoice choice_of(const Scene& scene, const std::vector<std::string>& names) {
  try {
    return {scene, names, input_names(scene)};
  } catch (const std::invalid_argument& unknown) {
    throw std::invalid_argument(std::string("inputs: ") + unknown.what() +
                                "; others are torque[j], pivot.x and pivot.y");
  }
}

}  // namespace

Linearization Equations::linearize(double t, const Numbers& q, const Numbers& qd,
                                   const std::vector<Input>& inputs) {
  const FloatingPointEnvironment ieee;
  compiled_->require_state(q, qd);
  const Scene& scene = compiled_->scene;
  const EquationsOfMotion& equations = compiled_->equations;
  const Eigen::Index n = q.size();
  require_possible(scene, {"q", q.span()}, {"qd", qd.span()});
  require_inside_stops(scene, q.data());
  Linearization result{.drift = Vector(2 * n),
                       .A = Matrix::Zero(2 * n, 2 * n),
                       .B = Matrix::Zero(2 * n, static_cast<Eigen::Index>(inputs.size()))};
  std::vector<Eigen::Index> of_parameters;  // their columns
  std::vector<std::string> names;
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    if (inputs[k].kind != Input::Kind::parameter) continue;
    of_parameters.push_back(static_cast<Eigen::Index>(k));
    names.push_back(inputs[k].parameter);
  }
  if (names.size() < inputs.size()) {
    std::optional<Jacobian>& jacobian = compiled_->of_inputs;
    if (!jacobian) {
      const Scene alone = scene_of_inputs(scene);
      jacobian.emplace(alone, equations_of_motion(alone));
    }
    result.B.bottomRows(n) = responses_to(inputs, scene, q, *jacobian).transpose();
  }
  if (!names.empty()) {
    compiled_->free_joints().set_mass_matrix(q.data());
    compiled_->free_joints().factor_mass();
  }

  if (!compiled_->derivatives) compiled_->derivatives.emplace(scene, equations);
  if (equations.effects) choose_modes(*equations.effects, t, q.data(), qd.data(), true);
  std::vector<int> modes = modes_at(scene, t, q.data(), qd.data());
  const auto here = [&] {
    DerivativesAt found{
        .qdd = Vector(n),
        .by = {.by_q = Matrix(n, n), .by_qd = Matrix(n, n)},
        .by_parameters = Matrix(n, static_cast<Eigen::Index>(of_parameters.size()))};
    (*compiled_->derivatives)(t, q.data(), qd.data(), found.by.by_q, found.by.by_qd);
    accelerations_in_force(equations, t, q.data(), qd.data(), found.qdd.data());
    if (!names.empty()) {
      const MechanismAlong along(scene, modes, t, true, choice_of(scene, names));
      along.refuse_corners();
      compiled_->by_parameters.compute(along.with_all_slopes(), t, q, qd, found.qdd,
                                       compiled_->free_joints(), found.by_parameters);
    }
    return found;
  };
  const DerivativesAt found = here();
  if (!(found.qdd.allFinite() && found.by.by_q.allFinite() && found.by.by_qd.allFinite())) {
    throw std::invalid_argument("t = " + text(t) +
                                ": a law of an effect is not finite there: choose a time within "
                                "its table, or another state");
  }
  for (std::size_t i = 0; i < scene.effects.size(); ++i) {
    const EffectBehaviour& effect = *scene.effects[i];
    if (!effect.has_modes()) continue;
    const int mode = modes[i];
    const int from_other_side = mode_at(effect, t, q.data(), qd.data(), false);
    const bool is_in_time = from_other_side != mode;
    for (const int other : modes_beside(effect, mode, from_other_side, q.data(), qd.data(),
                                        equations.held_joints->natural_speed())) {
      modes[i] = other;
      equations.effects->put_mode(i, other);
      const bool is_smooth = here().agree(found);
      modes[i] = mode;
      equations.effects->put_mode(i, mode);
      if (!is_smooth) refuse_corner(scene, i, t, is_in_time);
    }
  }

  result.drift << qd, found.qdd;
  result.A.topRightCorner(n, n).setIdentity();
  result.A.bottomLeftCorner(n, n) = found.by.by_q;
  result.A.bottomRightCorner(n, n) = found.by.by_qd;
  for (std::size_t k = 0; k < of_parameters.size(); ++k) {
    result.B.col(of_parameters[k]).tail(n) = found.by_parameters.col(static_cast<Eigen::Index>(k));
  }
  return result;
}

Vector Equations::trim(double t, const Numbers& q, const std::vector<int>& joints) {
  const FloatingPointEnvironment ieee;
  const Scene& scene = compiled_->scene;
  const Vector rest = Vector::Zero(q.size());
  compiled_->require_state(q, rest);
  require_possible(scene, {"q", q.span()}, {"the rates of rest", Numbers(rest).span()});
  const Vector wanted = inverse_dynamics(t, q, rest, rest);
  Scene driven = scene;
  Vector torques(joints.size());
  std::vector<bool> is_driven(scene.links.size());
  for (std::size_t k = 0; k < joints.size(); ++k) {
    require_joint(scene, joints[k]);
    if (is_driven[joints[k] - 1]) {
      throw std::invalid_argument(input_name(joints[k]) + ": stands twice");
    }
    torques[static_cast<Eigen::Index>(k)] = wanted[joints[k] - 1];
    is_driven[joints[k] - 1] = true;
    driven.effects.push_back(Motor{.joint = joints[k], .constant = wanted[joints[k] - 1]});
  }
  if (!wanted.allFinite()) throw std::invalid_argument("q: a law of an effect is not finite there");
  const Vector qdd = Equations(driven).accelerations(t, q, rest);
  const Inertia inertia(scene);
  std::vector<double> moments(scene.links.size());  // of all weights beyond each joint, at most
  double beyond = inertia.payload_mass;
  double moment = 0.0;
  for (std::size_t i = moments.size(); i-- > 0;) {
    beyond += scene.links[i].mass;
    moment += std::abs(scene.gravity) * beyond * scene.links[i].length;
    moments[i] = moment;
  }
  std::string told;
  for (int j = 1; j <= qdd.size(); ++j) {
    const double rounding = rounding_of_derivatives * (moments[j - 1] + std::abs(wanted[j - 1]));
    const double missing = inertia.links[j - 1].diagonal * relative(qdd.data(), j);
    if (is_driven[j - 1] || std::abs(missing) <= rounding) continue;
    if (std::abs(wanted[j - 1]) <= rounding) continue;
    told.append(told.empty() ? "joint " : " and joint ").append(std::to_string(j));
    told.append(" takes ").append(text(wanted[j - 1])).append(" N m");
  }
  if (told.empty()) return torques;
  throw std::invalid_argument("q: these angles do not rest: " + told +
                              ", which nothing there gives: drive it, too, or choose other angles");
}

}  // namespace pendcore
