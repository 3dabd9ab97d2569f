#include "analysis/kinks_of_drag.hpp"

#include <algorithm>
#include <span>

#include "arithmetic/instruction_set.hpp"
#include "arithmetic/sine_cosine.hpp"
#include "integrate/events/root.hpp"
#include "integrate/horner.hpp"
#include "pendcore/effects/rod_drag.hpp"
#include "pendcore/mechanics.hpp"
#include "scene/effects_of_scene.hpp"

namespace pendcore {
namespace {

constexpr int samples = 9;  // of a step, with both ends

}  // namespace

KinksOfDrag::KinksOfDrag(const Scene& scene) : scene_(scene) {
  ends_ = 2 * static_cast<int>(std::ranges::distance(effects_of<RodDrag>(scene)));
  for (int i = 0; i < samples; ++i) thetas_.push_back(i / (samples - 1.0));
}

/// The speeds of both ends of each rod across it, against the wind, m/s.
void KinksOfDrag::take_speeds(double t, const double* y, double* speeds) const {
  const std::size_t n = scene_.links.size();
  const Points ends = velocities(scene_, t, std::span(y, n), std::span(y + n, n));
  for (const RodDrag& drag : effects_of<RodDrag>(scene_)) {
    double sine, cosine;
    sine_cosine(y[drag.link - 1], sine, cosine);
    for (const int end : {drag.link - 1, drag.link}) {
      *speeds++ = (ends(end, 1) - drag.wind[1]) * cosine - (ends(end, 0) - drag.wind[0]) * sine;
    }
  }
}

std::vector<double> KinksOfDrag::find(const WatchedStep& step, double t_start) {
  std::vector<double> found;
  if (ends_ == 0) return found;
  const auto size = static_cast<int>(step.y.size());
  static const auto sample = fastest<&sample_rows>();
  states_.resize(static_cast<std::size_t>(samples) * size);
  speeds_.resize(static_cast<std::size_t>(samples) * ends_);
  const auto take = [&](const double* thetas, int count) {
    sample(step.rows(), {}, 1.0, thetas, count, states_.data(), size, step.degree);
    for (int i = 0; i < count; ++i) {
      take_speeds(t_start + thetas[i] * step.h, &states_[static_cast<std::size_t>(i) * size],
                  &speeds_[static_cast<std::size_t>(i) * ends_]);
    }
  };
  take(thetas_.data(), samples);
  const std::vector<double> sampled = speeds_;
  for (int end = 0; end < ends_; ++end) {
    const auto speed = [&](double theta) {
      take(&theta, 1);
      return speeds_[end];
    };
    int last = 0;  // the last sample that is not zero
    for (int i = 0; i < samples; ++i) {
      const int after = sign(sampled[i * ends_ + end]);
      if (after == 0) continue;
      if (after == -sign(sampled[last * ends_ + end])) {
        found.push_back(bisect(speed, thetas_[last], thetas_[i], after));
      }
      last = i;
    }
  }
  std::ranges::sort(found);
  return found;
}

}  // namespace pendcore
