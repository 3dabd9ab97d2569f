#include "analysis/kinks_of_drag.hpp"

#include <algorithm>
#include <array>
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

/// The speeds of both ends of each rod across it, against the wind, m/s.
void take_speeds(const Scene& scene, double t, const double* y, double* speeds) {
  const std::size_t n = scene.links.size();
  const Points ends = velocities(scene, t, std::span(y, n), std::span(y + n, n));
  for (const RodDrag& drag : effects_of<RodDrag>(scene)) {
    double sine, cosine;
    sine_cosine(y[drag.link - 1], sine, cosine);
    for (const int end : {drag.link - 1, drag.link}) {
      *speeds++ = (ends(end, 1) - drag.wind[1]) * cosine - (ends(end, 0) - drag.wind[0]) * sine;
    }
  }
}

}  // namespace

std::vector<double> kinks_of_drag(const Scene& scene, const WatchedStep& step, double t_start) {
  std::vector<double> found;
  const int ends = 2 * static_cast<int>(std::ranges::distance(effects_of<RodDrag>(scene)));
  if (ends == 0) return found;
  const auto size = static_cast<int>(step.y.size());
  static const auto sample = fastest<&sample_rows>();
  std::array<double, samples> shares;
  for (int i = 0; i < samples; ++i) shares[i] = i / (samples - 1.0);
  std::vector<double> states(static_cast<std::size_t>(samples) * size);
  std::vector<double> speeds(static_cast<std::size_t>(samples) * ends);
  const auto take = [&](const double* thetas, int count) {
    sample(step.rows(), {}, 1.0, thetas, count, states.data(), size, step.degree);
    for (int i = 0; i < count; ++i) {
      take_speeds(scene, t_start + thetas[i] * step.h, &states[static_cast<std::size_t>(i) * size],
                  &speeds[static_cast<std::size_t>(i) * ends]);
    }
  };
  take(shares.data(), samples);
  const std::vector<double> sampled = speeds;
  for (int end = 0; end < ends; ++end) {
    const auto speed = [&](double theta) {
      take(&theta, 1);
      return speeds[end];
    };
    int last = 0;  // the last sample that is not zero
    for (int i = 0; i < samples; ++i) {
      const int after = sign(sampled[i * ends + end]);
      if (after == 0) continue;
      if (after == -sign(sampled[last * ends + end])) {
        found.push_back(bisect(speed, shares[last], shares[i], after));
      }
      last = i;
    }
  }
  std::ranges::sort(found);
  return found;
}

}  // namespace pendcore
