#include "pendcore/effects/driven_pivot.hpp"

#include <cmath>

#include "pendcore/arithmetic/sine_cosine.hpp"

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

}  // namespace

void DrivenPivot::check(const std::string& where) const {
  if (spline && (x || y)) {
    throw std::invalid_argument(where + "x, y and spline given: give x, y or both, or a spline");
  }
  if (!spline && !x && !y) {
    throw std::invalid_argument(where + "no motion given: give x, y or both, or a spline");
  }
}

int DrivenPivot::mode_at(double t, double /*phi*/, double /*phid*/, bool forward) const {
  return spline ? piece_at(spline->t, t, forward) : 0;
}

DrivenPivot DrivenPivot::compiled() const {
  DrivenPivot pivot = *this;
  if (spline) {
    pivot.spline->xdd = spline->second_derivatives(spline->x);
    pivot.spline->ydd = spline->second_derivatives(spline->y);
  }
  return pivot;
}

void DrivenPivot::put_mode(Law& law, int /*lane*/, int mode) const {
  if (!spline) return;
  const int pieces = static_cast<int>(spline->t.size()) - 1;
  if (mode < 0 || mode >= pieces) {
    law.x = law.y = {.held = std::nan("")};
    return;
  }
  const Cubic along_x = cubic(spline->t, spline->x, spline->xdd, mode);
  const Cubic along_y = cubic(spline->t, spline->y, spline->ydd, mode);
  law.start = along_x.start;
  law.x = {.held = along_x.second, .slope = along_x.third, .velocity = along_x.velocity};
  law.y = {.held = along_y.second, .slope = along_y.third, .velocity = along_y.velocity};
}

PivotMotion DrivenPivot::at(double t) const {
  PivotMotion motion;
  const std::optional<Sinusoid>* const axes[] = {&x, &y};
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
  if (!spline) return motion;
  const int last = static_cast<int>(spline->t.size()) - 2;
  const int piece = piece_at(spline->t, t, true);
  for (int axis = 0; axis < 2; ++axis) {
    const std::vector<double>& values = axis == 0 ? spline->x : spline->y;
    const std::vector<double>& known = axis == 0 ? spline->xdd : spline->ydd;
    if (piece < 0 || piece > last) {
      motion.position[axis] = motion.velocity[axis] = motion.acceleration[axis] = std::nan("");
      continue;
    }
    const Cubic c = known.empty()
                        ? cubic(spline->t, values, spline->second_derivatives(values), piece)
                        : cubic(spline->t, values, known, piece);
    const double s = t - c.start;
    motion.position[axis] = c.value + s * (c.velocity + s * (c.second / 2.0 + s * (c.third / 6.0)));
    motion.velocity[axis] = c.velocity + s * (c.second + s * (c.third / 2.0));
    motion.acceleration[axis] = c.second + s * c.third;
  }
  return motion;
}

}  // namespace pendcore
