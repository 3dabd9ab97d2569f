#include "simulate/method_choice.hpp"

#include "integrate/method_list.hpp"
#include "pendcore/methods.hpp"
#include "scene/effects_of_scene.hpp"
#include "simulate/checked_options.hpp"

namespace pendcore {
namespace {

/// Below this tolerance dop853 takes less time than dopri5 for the same error.
constexpr double tight = 1e-6;

}  // namespace

std::string_view chosen_method(const Scene& scene, const Options& options) {
  if (options.method != automatic) return find_method(options.method, automatic).name;
  const std::size_t n = scene.links.size();
  // A fixed step may be longer than a series is valid, and no stability test shortens it.
  if (options.step) return dormand_prince_5.info.name;
  // A single link is cheap to evaluate, so that a series does not save time.
  if (n > 1 && !without_series(scene)) return taylor_radau5.info.name;
  return tightest_tolerance(options, n) < tight ? dop853_radau5.info.name : dopri5_radau5.info.name;
}

}  // namespace pendcore
