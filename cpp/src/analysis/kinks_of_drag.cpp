#include "analysis/kinks_of_drag.hpp"

#include <algorithm>
#include <array>

#include "arithmetic/instruction_set.hpp"
#include "integrate/events/root.hpp"
#include "integrate/horner.hpp"

namespace pendcore {
namespace {

constexpr int samples = 9;  // of a step, with both ends

}  // namespace

std::vector<double> kinks_of_drag(const EndsInAir<double>& air, const WatchedStep& step,
                                  double t_start) {
  std::vector<double> found;
  const int ends = air.count();
  if (ends == 0) return found;
  const auto size = static_cast<int>(step.y.size());
  static const auto sample = fastest<&sample_rows>();
  std::array<double, samples> shares;
  for (int i = 0; i < samples; ++i) shares[i] = i / (samples - 1.0);
  std::vector<double> states(static_cast<std::size_t>(samples) * size);
  std::vector<double> speeds(static_cast<std::size_t>(samples) * ends);
  const std::vector<double> no_derivative(size);  // slopes are not read here
  EndsInAir<double>::Speeds there = air.room_for_speeds();
  const auto sample_speeds = [&](const double* thetas, int count) {
    sample(step.rows(), {}, 1.0, thetas, count, states.data(), size, step.degree);
    for (int i = 0; i < count; ++i) {
      find_speeds(air, t_start + thetas[i] * step.h, &states[static_cast<std::size_t>(i) * size],
                  no_derivative.data(), there);
      for (int end = 0; end < ends; ++end) speeds[i * ends + end] = there.w[end];
    }
  };
  sample_speeds(shares.data(), samples);
  const std::vector<double> sampled = speeds;
  for (int end = 0; end < ends; ++end) {
    const auto speed = [&](double theta) {
      sample_speeds(&theta, 1);
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
