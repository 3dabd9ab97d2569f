#include "pendcore/effects/driven_pivot.hpp"

#include <cmath>
#include <stdexcept>
#include <utility>

#include "arithmetic/floating_point_environment.hpp"
#include "arithmetic/sine_cosine.hpp"
#include "effects/behaviour.hpp"
#include "effects/times.hpp"

namespace pendcore {
namespace {

/// The piece of a spline from point k on, in time since that point.
struct Cubic {
  double start, value, velocity, second, third;
};

Cubic cubic(const std::vector<double>& t, const std::vector<double>& values,
            const std::vector<double>& second, int k) {
  const double h = t[k + 1] - t[k];
  const double velocity =
      (values[k + 1] - values[k]) / h - h * (2.0 * second[k] + second[k + 1]) / 6.0;
  return {t[k], values[k], velocity, second[k], (second[k + 1] - second[k]) / h};
}

class DrivenPivotBehaviour final : public EffectOf<DrivenPivot> {
 public:
  explicit DrivenPivotBehaviour(DrivenPivot given) : EffectOf(std::move(given)) {
    const FloatingPointEnvironment ieee;
    if (!given_.spline) return;
    second_of_x_ = given_.spline->second_derivatives(given_.spline->x);
    second_of_y_ = given_.spline->second_derivatives(given_.spline->y);
  }

  PivotMotion pivot_motion(double t) const override;
  std::optional<PivotLaw> pivot_law(int mode) const override;
  std::vector<Sinusoid> waves() const override {
    std::vector<Sinusoid> waves;
    for (const std::optional<Sinusoid>& axis : {given_.x, given_.y}) {
      if (axis) waves.push_back(*axis);
    }
    return waves;
  }

  bool has_modes() const override { return given_.spline.has_value(); }
  int mode_at(double t, double /*phi*/, double /*phid*/, bool forward) const override {
    return given_.spline ? piece_at(given_.spline->t, t, forward) : 0;
  }
  double next_time(double t, bool forward) const override {
    if (!given_.spline) return forward ? never : -never;
    return next_of(given_.spline->t, t, forward);
  }
  double first_time() const override { return given_.spline ? given_.spline->t.front() : -never; }
  double last_time() const override { return given_.spline ? given_.spline->t.back() : never; }

 private:
  void check_together(const std::string& where) const override {
    if (given_.spline && (given_.x || given_.y)) {
      throw std::invalid_argument(where + "x, y and spline given: give x, y or both, or a spline");
    }
    if (!given_.spline && !given_.x && !given_.y) {
      throw std::invalid_argument(where + "no motion given: give x, y or both, or a spline");
    }
  }

  std::vector<double> second_of_x_, second_of_y_;  // derivatives at the points of the spline
};

std::optional<PivotLaw> DrivenPivotBehaviour::pivot_law(int mode) const {
  PivotLaw law;
  if (given_.spline) {
    const Spline& spline = *given_.spline;
    const int pieces = static_cast<int>(spline.t.size()) - 1;
    if (mode < 0 || mode >= pieces) {
      law.x.held = law.y.held = std::nan("");
      return law;
    }
    const Cubic along_x = cubic(spline.t, spline.x, second_of_x_, mode);
    const Cubic along_y = cubic(spline.t, spline.y, second_of_y_, mode);
    law.start = along_x.start;
    law.x = {.held = along_x.second, .slope = along_x.third, .velocity = along_x.velocity};
    law.y = {.held = along_y.second, .slope = along_y.third, .velocity = along_y.velocity};
    return law;
  }
  int waves = 0;
  const auto swing = [&waves](const std::optional<Sinusoid>& wave) -> PivotLaw::Axis {
    if (!wave) return {};
    const double w = wave->angular_frequency;
    return {.gain = -wave->amplitude * w * w, .swing = wave->amplitude * w, .wave = waves++};
  };
  law.x = swing(given_.x);
  law.y = swing(given_.y);
  return law;
}

PivotMotion DrivenPivotBehaviour::pivot_motion(double t) const {
  PivotMotion motion;
  const std::optional<Sinusoid>* const axes[] = {&given_.x, &given_.y};
  for (int axis = 0; axis < 2; ++axis) {
    if (const std::optional<Sinusoid>& one = *axes[axis]) {
      const double w = one->angular_frequency;
      double sine, cosine;
      sine_cosine(fma(w, t, one->phase), sine, cosine);
      motion.position[axis] = one->amplitude * sine;
      motion.velocity[axis] = one->amplitude * w * cosine;
      motion.acceleration[axis] = -one->amplitude * w * w * sine;
    }
  }
  if (!given_.spline) return motion;
  const int last = static_cast<int>(given_.spline->t.size()) - 2;
  const int piece = piece_at(given_.spline->t, t, true);
  for (int axis = 0; axis < 2; ++axis) {
    const std::vector<double>& values = axis == 0 ? given_.spline->x : given_.spline->y;
    const std::vector<double>& second = axis == 0 ? second_of_x_ : second_of_y_;
    if (piece < 0 || piece > last) {
      motion.position[axis] = motion.velocity[axis] = motion.acceleration[axis] = std::nan("");
      continue;
    }
    const Cubic c = cubic(given_.spline->t, values, second, piece);
    const double s = t - c.start;
    motion.position[axis] = c.value + s * (c.velocity + s * (c.second / 2.0 + s * (c.third / 6.0)));
    motion.velocity[axis] = c.velocity + s * (c.second + s * (c.third / 2.0));
    motion.acceleration[axis] = c.second + s * c.third;
  }
  return motion;
}

}  // namespace

std::shared_ptr<const EffectBehaviour> behaviour(DrivenPivot given) {
  return std::make_shared<DrivenPivotBehaviour>(std::move(given));
}

}  // namespace pendcore
