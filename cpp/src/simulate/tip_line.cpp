#include "simulate/tip_line.hpp"

#include <algorithm>
#include <cmath>

#include "arithmetic/epsilon.hpp"
#include "arithmetic/sine_cosine.hpp"
#include "effects/pivot_motion.hpp"
#include "pendcore/effects/driven_pivot.hpp"
#include "scene/effects_of_scene.hpp"

namespace pendcore {
namespace {

double largest_size(const std::vector<double>& values) {
  double largest = 0.0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  return largest;
}

/// An upper bound of the acceleration of the pivot: A omega^2, or the largest at the points of a
/// spline.
double largest_acceleration(const Scene& scene) {
  double sum = 0.0;
  for (const DrivenPivot& pivot : effects_of<DrivenPivot>(scene)) {
    for (const std::optional<Sinusoid>& axis : {pivot.x, pivot.y}) {
      if (!axis) continue;
      sum += std::abs(axis->amplitude) * axis->angular_frequency * axis->angular_frequency;
    }
    if (const std::optional<Spline>& spline = pivot.spline) {
      sum += largest_size(spline->second_derivatives(spline->x));
      sum += largest_size(spline->second_derivatives(spline->y));
    }
  }
  return sum;
}

/// A bound on |p^(order)| over [0, 1] of link i's angle p.
double bound(const double* rows, int degree, int dimension, int i, int order) {
  double derivative[highest_degree + 1] = {};
  double bernstein[highest_degree + 1];
  if (degree < order) return 0.0;
  for (int k = order; k <= degree; ++k) {
    const double factor = order == 2 ? k * (k - 1.0) : k;
    derivative[k - order] = factor * rows[static_cast<std::ptrdiff_t>(k) * dimension + i];
  }
  bernstein_form(derivative, degree - order, bernstein);
  double largest = 0.0;
  for (int k = 0; k <= degree - order; ++k) largest = std::max(largest, std::abs(bernstein[k]));
  return largest;
}

}  // namespace

TipLine::TipLine(const Scene& scene, const events::TipLine& line)
    : scene_(scene),
      line_(line),
      size_of_normal_(std::sqrt(line.normal[0] * line.normal[0] + line.normal[1] * line.normal[1])),
      pivot_acceleration_(largest_acceleration(scene)),
      angles_(scene.links.size()),
      rates_(scene.links.size()),
      sines_(scene.links.size()),
      cosines_(scene.links.size()) {}

double TipLine::at(double t, const double* q) {
  sine_cosine(q, static_cast<long long>(sines_.size()), sines_.data(), cosines_.data());
  const PivotMotion pivot = pivot_motion(scene_, t);
  double x = pivot.position[0] - line_.point[0];
  double y = pivot.position[1] - line_.point[1];
  for (std::size_t i = 0; i < sines_.size(); ++i) {
    x = fma(scene_.links[i].length, cosines_[i], x);
    y = fma(scene_.links[i].length, sines_[i], y);
  }
  return line_.normal[0] * x + line_.normal[1] * y;
}

double TipLine::rounding(double t, const double* q) const {
  const PivotMotion pivot = pivot_motion(scene_, t);
  double lengths = std::abs(line_.point[0]) + std::abs(line_.point[1]);
  for (int axis = 0; axis < 2; ++axis) {
    lengths += std::abs(pivot.position[axis]) + std::abs(t * pivot.velocity[axis]);
  }
  for (std::size_t i = 0; i < sines_.size(); ++i) {
    lengths += scene_.links[i].length * (1.0 + std::abs(q[i]));
  }
  return last_bits_share * size_of_normal_ * lengths;
}

TipLine::Point TipLine::along(double theta) {
  const std::size_t n = sines_.size();
  for (std::size_t i = 0; i < n; ++i) {
    double angle = 0.0;
    double rate = 0.0;
    for (int p = degree_; p >= 0; --p) {
      rate = fma(theta, rate, angle);
      angle = fma(theta, angle, rows_[static_cast<std::size_t>(p) * dimension_ + i]);
    }
    angles_[i] = angle;
    rates_[i] = rate;
  }
  const double t = fma(theta, h_, t_);
  const double value = at(t, angles_.data());
  const PivotMotion pivot = pivot_motion(scene_, t);
  double slope = h_ * (line_.normal[0] * pivot.velocity[0] + line_.normal[1] * pivot.velocity[1]);
  for (std::size_t i = 0; i < n; ++i) {
    const double across = line_.normal[1] * cosines_[i] - line_.normal[0] * sines_[i];
    slope = fma(scene_.links[i].length * rates_[i], across, slope);
  }
  return {value, slope};
}

void TipLine::bound_curvature() {
  curvature_ = h_ * h_ * pivot_acceleration_;
  double lengths = std::abs(line_.point[0]) + std::abs(line_.point[1]);
  for (std::size_t i = 0; i < sines_.size(); ++i) {
    const int link = static_cast<int>(i);
    const double length = scene_.links[i].length;
    const double rate = bound(rows_, degree_, dimension_, link, 1);
    const double second = bound(rows_, degree_, dimension_, link, 2);
    curvature_ += length * std::sqrt(second * second + rate * rate * rate * rate);
    lengths += length * (1.0 + std::abs(rows_[i]) + rate);
  }
  const PivotMotion pivot = pivot_motion(scene_, t_);
  lengths += std::abs(pivot.position[0]) + std::abs(pivot.position[1]);
  curvature_ *= size_of_normal_;
  noise_ = last_bits_share * size_of_normal_ * lengths;
}

void TipLine::search(double low, double high, int depth) {
  const double width = high - low;
  const double middle = 0.5 * (low + high);
  const Point point = along(middle);
  const double slope = std::abs(point.slope);
  const double bend = 0.5 * curvature_ * width;
  const double change = 0.5 * width * (slope + 0.5 * bend);  // the largest change from the middle
  const bool has_no_zero = std::abs(point.value) > change + 2.0 * noise_;
  const bool is_unresolved = change <= noise_ || depth == 26 || --points_left_ < 0;
  if (has_no_zero || slope > bend || is_unresolved) {
    if (is_unresolved) points_.push_back({middle, point.value});
    if (high < 1.0) points_.push_back({high, along(high).value});
    return;
  }
  search(low, middle, depth + 1);
  search(middle, high, depth + 1);
}

bool TipLine::find(const double* rows, int degree, int dimension, double t, double h, double start,
                   double end, double noise, std::vector<Root>& found) {
  rows_ = rows;
  degree_ = degree;
  dimension_ = dimension;
  t_ = t;
  h_ = h;
  bound_curvature();
  points_.clear();
  points_left_ = 100'000;  // no sensible step has so many turns
  search(0.0, 1.0, 0);
  return find_roots([this](double theta) { return along(theta).value; }, start, points_, end,
                    std::max(noise, noise_), found);
}

}  // namespace pendcore
