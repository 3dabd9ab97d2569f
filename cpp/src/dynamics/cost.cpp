#include "dynamics/cost.hpp"

#include <algorithm>
#include <chrono>
#include <limits>

#include "dynamics/equations_of_motion.hpp"
#include "dynamics/row.hpp"
#include "scene/effects_of_scene.hpp"

namespace pendcore {
namespace {

thread_local int counted = 0;

/// A number that counts the operations done with it.
struct Counted {
  double value = 0.0;
  Counted() = default;
  Counted(double x) : value(x) {}  // NOLINT(google-explicit-constructor): as a double would
};

Counted count(double x, int operations = 1) {
  counted += operations;
  return {x};
}
Counted operator+(Counted a, Counted b) { return count(a.value + b.value); }
Counted operator-(Counted a, Counted b) { return count(a.value - b.value); }
Counted operator*(Counted a, Counted b) { return count(a.value * b.value); }
Counted operator/(Counted a, Counted b) { return count(a.value / b.value); }
Counted operator-(Counted a) { return {-a.value}; }  // a sign costs nothing, because it is fused
Counted fma(Counted a, Counted b, Counted c) { return count(a.value * b.value + c.value); }
Counted absolute(Counted a) { return count(a.value < 0.0 ? -a.value : a.value); }
Counted exponential(Counted a) { return count(pendcore::exponential(a.value), 20); }
Counted power(Counted a, double p) { return count(pendcore::power(a.value, p), p == 2.0 ? 1 : 45); }
Counted before(Counted /*x*/) { return {}; }

/// The number of operations of one effect in a right-hand side.
std::optional<int> operations_of(const EffectBehaviour& effect) {
  if (effect.info().is_function) return std::nullopt;
  counted = 0;
  double waves[8] = {};
  const RowAt<Counted> at{.q = 0.5,
                          .qd = 1.0,
                          .s = 0.6,
                          .c = 0.8,
                          .L = 1.0,
                          .t = 0.0,
                          .pivot_vx = 0.1,
                          .pivot_vy = 0.2};
  RowLoads<Counted> loads;
  const int mode = effect.mode_at(0.0, 0.0, 0.0, true);
  const LinkConstants on{.mass = 1.0, .length = 1.0, .center = 0.5, .gravity = 9.807};
  if (effect.couple(mode)) {
    loads.couple(Couples<double>{}.torque(at));
  } else if (const auto any = effect.law(mode, on)) {
    std::visit([&](const auto& law) { law.add(at, loads); }, *any);
  } else if (const auto pivot = effect.pivot_law(mode)) {
    Counted x, y;
    pivot->add_acceleration(0.0, waves, x, y);
  }
  return counted;
}

class Contender {
 public:
  explicit Contender(const Scene& scene)
      : t_(time_of(scene)),
        equations_(equations_of_motion(scene)),
        q_(scene.links.size(), 0.5),
        qd_(scene.links.size(), 0.7),
        qdd_(scene.links.size()) {
    if (equations_.effects) choose_modes(*equations_.effects, t_, q_.data(), qd_.data(), true);
    const double once = seconds(1);
    calls_ = std::clamp(static_cast<long long>(0.3e-3 / std::max(once, 1e-9)), 1LL, 100000LL);
  }

  void measure() { least_ = std::min(least_, seconds(calls_) / static_cast<double>(calls_)); }
  double nanoseconds() const { return 1e9 * least_; }

 private:
  /// Each call depends on the result of the call before, as the stages of a step do.
  double seconds(long long calls) {
    using Clock = std::chrono::steady_clock;
    const Clock::time_point start = Clock::now();
    for (long long i = 0; i < calls; ++i) {
      accelerations_in_force(equations_, t_, q_.data(), qd_.data(), qdd_.data());
      q_[0] = 0.5 + 1e-12 * qdd_[0];
    }
    return std::chrono::duration<double>(Clock::now() - start).count();
  }

  /// A time at which all tables of the scene have begun.
  static double time_of(const Scene& scene) {
    double t = 0.0;
    for (const Effect& effect : scene.effects) {
      t = std::max(t, effect->first_time());
    }
    return t;
  }

  double t_;
  EquationsOfMotion equations_;
  std::vector<double> q_, qd_, qdd_;
  long long calls_ = 1;
  double least_ = std::numeric_limits<double>::infinity();
};

}  // namespace

std::vector<Cost> costs(const Scene& scene) {
  std::vector<Contender> contenders;
  contenders.emplace_back(Scene{.links = scene.links, .gravity = scene.gravity});
  for (const Effect& effect : scene.effects) {
    contenders.emplace_back(
        Scene{.links = scene.links, .gravity = scene.gravity, .effects = {effect}});
  }
  contenders.emplace_back(scene);
  for (int round = 0; round < 12; ++round) {
    for (Contender& contender : contenders) contender.measure();
  }
  const double links = contenders.front().nanoseconds();
  std::vector<Cost> result{{"links", links, std::nullopt}};
  for (std::size_t i = 0; i < scene.effects.size(); ++i) {
    result.push_back({effect_name(scene, i), contenders[i + 1].nanoseconds() - links,
                      operations_of(*scene.effects[i])});
  }
  result.push_back({"all", contenders.back().nanoseconds(), std::nullopt});
  return result;
}

}  // namespace pendcore
