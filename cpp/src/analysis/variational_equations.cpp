#include "analysis/variational_equations.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "effects/behaviour.hpp"
#include "pendcore/effects/lock.hpp"
#include "pendcore/effects/motor.hpp"
#include "pendcore/parameters.hpp"
#include "scene/effects_of_scene.hpp"
#include "text/message.hpp"

namespace pendcore {
namespace {

/// The number that stands in brackets after q0, qd0 or torque in a name, less one; -1 for another
/// name.
int number_of(const std::string& name, const std::string& kind, int n) {
  if (!name.starts_with(kind)) return -1;
  for (int i = 0; i < n; ++i) {
    if (name == kind + "[" + std::to_string(i + 1) + "]") return i;
  }
  throw std::invalid_argument("sensitivities: \"" + name + "\": must be " + kind + "[1]" +
                              (n > 1 ? " to " + kind + "[" + std::to_string(n) + "]" : ""));
}

/// A pivot with a constant acceleration, beside what else moves it.
struct PushedPivot {
  double x = 0.0, y = 0.0;  ///< m/s^2
  double start = 0.0;       ///< s, until which it has no velocity, which air would feel

  static constexpr EffectInfo info{.name = "PushedPivot",
                                   .kind = "pushed_pivot",
                                   .sentence = "A pivot with a constant acceleration.",
                                   .law = "x_0'' = x,  y_0'' = y",
                                   .source = "d'Alembert's principle",
                                   .depends_on_time = true,
                                   .moves_pivot = true,
                                   .has_series = true};
  static constexpr auto parameters =
      std::tuple{parameter(&PushedPivot::x, {.name = "x", .unit = "m/s^2"}),
                 parameter(&PushedPivot::y, {.name = "y", .unit = "m/s^2"})};
};
class PushedPivotBehaviour final : public EffectOf<PushedPivot> {
 public:
  using EffectOf::EffectOf;
  std::optional<PivotLaw> pivot_law(int /*mode*/) const override {
    return PivotLaw{.x = {.held = given_.x}, .y = {.held = given_.y}, .start = given_.start};
  }
};
std::shared_ptr<const EffectBehaviour> behaviour(PushedPivot given) {
  return std::make_shared<PushedPivotBehaviour>(given);
}

/// Those of the names that are no starts.
ParameterChoice choice_of(const Scene& scene, std::vector<std::string> names) {
  const auto n = static_cast<int>(scene.links.size());
  std::erase_if(names, [n](const std::string& name) {
    return number_of(name, "q0", n) >= 0 || number_of(name, "qd0", n) >= 0;
  });
  for (const std::string& name : names) {
    if (!name.starts_with("q[") && !name.starts_with("qd[")) continue;
    throw std::invalid_argument("sensitivities: \"" + name +
                                "\": a start is named q0[i] or qd0[i]");
  }
  std::vector<std::string> others = input_names(scene);
  for (int i = 1; i <= n; ++i) {
    for (const char* const start : {"q0[", "qd0["})
      others.push_back(start + std::to_string(i) + "]");
  }
  try {
    return {scene, names, others};
  } catch (const std::invalid_argument& unknown) {
    throw std::invalid_argument(std::string("sensitivities: ") + unknown.what() +
                                "; others are q0[i], qd0[i], torque[j], pivot.x and pivot.y");
  }
}

/// The same scene with a motor that gives nothing in each joint whose torque is named, and a pivot
/// that nothing pushes if its acceleration is; and the names with those of their constants.
Scene with_inputs(Scene scene, std::vector<std::string>& names) {
  for (const std::string& name : names) {
    if (std::ranges::count(names, name) == 1) continue;
    throw std::invalid_argument("sensitivities: \"" + name + "\": stands twice: leave one out");
  }
  std::vector<std::string> others = names;
  std::erase_if(others, [](const std::string& name) {
    return name.starts_with("pivot.") || name.starts_with("torque[");
  });
  choice_of(scene, others);  // refuses the names that only the effects of inputs would have
  for (std::string& name : names) {
    if (name != "pivot.x" && name != "pivot.y") continue;
    if (scene.effects.empty() || !scene.effects.back().is<PushedPivot>()) {
      scene.effects.push_back(PushedPivot{});
    }
    name = "effect[" + std::to_string(scene.effects.size()) + "]." + name.back();
  }
  const auto n = static_cast<int>(scene.links.size());
  const std::vector<bool> locked = locked_joints(scene);
  for (std::string& name : names) {
    const int joint = number_of(name, "torque", n);
    if (joint < 0) continue;
    if (locked[joint]) {
      throw std::invalid_argument("sensitivities: \"" + name +
                                  "\": a Lock holds this joint, which no torque turns");
    }
    scene.effects.push_back(Motor{.joint = joint + 1, .constant = 0.0});
    name = "effect[" + std::to_string(scene.effects.size()) + "].constant";
  }
  return scene;
}

void require_smooth(const Scene& scene, const ParameterChoice& choice, std::size_t which) {
  const std::string& name = choice.names()[which];
  const double value = choice.values()[which];
  const Scene other = choice.changed(scene, which, value + 1e-9 * std::max(1.0, value));
  for (std::size_t i = 0; i < scene.effects.size(); ++i) {
    if (other.effects[i]->has_modes() == scene.effects[i]->has_modes()) continue;
    throw std::invalid_argument("sensitivities: \"" + name + "\": is " + text(value) +
                                ", where its law has one piece; beside that, it has several, and "
                                "the run does not look for where they meet: leave this name out, "
                                "or give the parameter another value");
  }
  for (std::size_t i = 0; i < scene.effects.size(); ++i) {
    if (!scene.effects[i].is<Lock>() || name != "effect[" + std::to_string(i + 1) + "].angle") {
      continue;
    }
    throw std::invalid_argument("sensitivities: \"" + name + "\": a run starts at the angle of " +
                                effect_name(scene, i) +
                                ": leave the angle out, and name the start, q0[i]");
  }
}

/// (1 / 2h) (ahead - behind), which is exact up to rounding: supports are linear in parameters.
std::vector<JointSupport> slopes_of(const Scene& scene, const ParameterChoice& choice,
                                    std::size_t which) {
  const double value = choice.values()[which];
  const double h = value == 0.0 ? 1.0 : std::ldexp(1.0, std::ilogb(value) - 8);
  const auto at = [&](double x) {
    const Scene changed = choice.changed(scene, which, x);
    return joint_supports(changed, Inertia(changed));
  };
  std::vector<JointSupport> slopes = at(value + h);
  const std::vector<JointSupport> behind = at(value - h);
  const auto take = [h](double& ahead, double before) {
    ahead = std::isfinite(ahead - before) ? (ahead - before) / (2.0 * h) : 0.0;
  };
  for (std::size_t j = 0; j < slopes.size(); ++j) {
    for (Stop JointSupport::* const stop : {&JointSupport::lower, &JointSupport::upper}) {
      take((slopes[j].*stop).angle, (behind[j].*stop).angle);
      take((slopes[j].*stop).restitution, (behind[j].*stop).restitution);
    }
  }
  return slopes;
}

}  // namespace

VariationalEquations::VariationalEquations(const Scene& scene,
                                           const std::vector<std::string>& names)
    : names_(names),
      known_names_(names),
      scene_(with_inputs(scene, known_names_)),
      n_(static_cast<int>(scene.links.size())),
      equations_(equations_of_motion(scene_)),
      jacobian_(scene_, equations_),
      choice_(choice_of(scene_, known_names_)) {
  for (std::size_t k = 0; k < names.size(); ++k) {
    const std::size_t which = parameters_.size();
    if (which == choice_.size() || known_names_[k] != choice_.names()[which]) continue;
    require_smooth(scene_, choice_, which);
    parameters_.push_back({.column = static_cast<Eigen::Index>(k),
                           .value = choice_.values()[which],
                           .supports = slopes_of(scene_, choice_, which)});
  }
}

Matrix VariationalEquations::changes_of_start() const {
  Matrix changes = Matrix::Zero(2 * n_, static_cast<Eigen::Index>(names_.size()));
  for (Eigen::Index k = 0; k < changes.cols(); ++k) {
    const std::string& name = names_[static_cast<std::size_t>(k)];
    const int angle = number_of(name, "q0", n_);
    const int rate = number_of(name, "qd0", n_);
    if (angle >= 0) changes(angle, k) = 1.0;
    if (rate >= 0) changes(n_ + rate, k) = 1.0;
  }
  return changes;
}

void VariationalEquations::choose_laws(double t, const double* y) {
  for (Effect& one : scene_.effects) {
    if (one.is<PushedPivot>()) one = PushedPivot{.start = t};
  }
  modes_ = modes_at(scene_, t, y, y + n_);
  put_along(t, true);
  along_->refuse_corners();
}

void VariationalEquations::take_laws(double t, const EquationsOfMotion& run, bool forward) {
  modes_ = equations_.effects->modes;  // the run does not have the motors of named torques
  std::ranges::copy(run.effects->modes, modes_.begin());
  for (std::size_t i = 0; i < modes_.size(); ++i) equations_.effects->put_mode(i, modes_[i]);
  equations_.held_joints->restore(*equations_.effects, run.held_joints->saved_state(),
                                  run.held_joints->has_failed());
  put_along(t, forward);
}

/// Makes what depends on modes and holds.
void VariationalEquations::put_along(double t, bool forward) {
  std::vector<bool> held(n_);
  for (int j = 0; j < n_; ++j) held[j] = equations_.effects && equations_.effects->held[j] != 0;
  forces_ = std::make_unique<JointForces>(JointForces::on_free_joints(scene_, held));
  along_ = std::make_unique<MechanismAlong>(scene_, modes_, t, forward, choice_);
  mechanisms_ = along_->with_all_slopes();
  ++changes_of_laws_;
}

void VariationalEquations::at(double t, const double* y, const Eigen::Ref<Matrix>& by_q,
                              const Eigen::Ref<Matrix>& by_qd,
                              const Eigen::Ref<Matrix>& by_parameters) {
  const double* const qd = y + n_;
  jacobian_(t, y, qd, by_q, by_qd);
  if (parameters_.empty()) return;
  qdd_.resize(n_);
  accelerations_in_force(equations_, t, y, qd, qdd_.data());
  const double rate = View(qd, n_).cwiseAbs().maxCoeff();
  size_ = std::max(qdd_.cwiseAbs().maxCoeff(), rate * rate);
  forces_->set_mass_matrix(y);
  forces_->factor_mass();
  by_parameters_.compute(mechanisms_, t, View(y, n_), View(qd, n_), qdd_, *forces_, by_parameters);
}

Vector VariationalEquations::sizes_elsewhere(double t, const double* y) {
  const Vector still = Vector::Zero(n_);
  const Vector q = View(y, n_) + Vector::LinSpaced(n_, 0.7, 0.7 + 0.3 * n_);  // rad
  Matrix by(n_, static_cast<Eigen::Index>(parameters_.size()));
  forces_->set_mass_matrix(q.data());
  forces_->factor_mass();
  by_parameters_.compute(mechanisms_, t, q, still, still, *forces_, by);
  return by.cwiseAbs().colwise().maxCoeff();
}

Vector VariationalEquations::rates(double t, const double* y) const {
  Vector f(2 * n_);
  f.head(n_) = View(y + n_, n_);
  accelerations_in_force(equations_, t, y, y + n_, f.data() + n_);
  return f;
}

}  // namespace pendcore
