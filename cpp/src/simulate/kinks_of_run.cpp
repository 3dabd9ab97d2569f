#include "simulate/kinks_of_run.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include "simulate/checked_options.hpp"

namespace pendcore {
namespace {

/// A state, its derivative, and the speeds of the ends there.
struct Ends {
  std::vector<double> y{}, dydt{};
  EndsInAir<double>::Speeds speeds{};

  void find(const EndsInAir<double>& air, double t) {
    find_speeds(air, t, y.data(), dydt.data(), speeds);
  }
};

/// Most steps begin where the one before ended.
struct KinksOfRun {
  EndsInAir<double> air{};
  double tolerance = 0.0;
  Ends start{}, end{};
  std::vector<double> y{}, dydt{};  ///< at the start of the step

  double operator()(const Stepper& attempted, double t, double h) {
    if (!ends_at_kinks(attempted.info(), tolerance)) return 1.0;
    attempted.get_state(y.data());
    attempted.get_derivative(dydt.data());
    if (end.y == y && end.dydt == dydt) std::swap(start, end);
    if (start.y != y || start.dydt != dydt || air.depend_on_time()) {
      start.y = y;
      start.dydt = dydt;
      start.find(air, t);
    }
    attempted.get_new_state(end.y.data());
    attempted.get_new_derivative(end.dydt.data());
    end.find(air, t + h);
    return air.first_kink(h, start.speeds, end.speeds);
  }
};

}  // namespace

FirstKink first_kink_of(const Scene& scene, const EquationsOfMotion& equations,
                        const Options& options, int dimension) {
  if (options.step || !equations.effects || std::ranges::empty(effects_of<RodDrag>(scene)))
    return {};
  KinksOfRun kinks{.tolerance = tightest_tolerance(options, scene.links.size())};
  kinks.air.prepare(scene, equations.effects.get());
  const std::size_t n = scene.links.size();
  kinks.air.set_tolerances(relative_tolerances(options, n), absolute_tolerances(options, n));
  kinks.air.put(scene);
  kinks.y.assign(dimension, std::nan(""));
  kinks.dydt = kinks.y;
  kinks.start = kinks.end = {.y = kinks.y, .dydt = kinks.y, .speeds = kinks.air.room_for_speeds()};
  return kinks;
}

}  // namespace pendcore
