#include "ensemble/lanes.hpp"

#include "ensemble/few_links_in_lanes.hpp"
#include "ensemble/lane_loop.hpp"
#include "pendcore/methods.hpp"
#include "scene/effects_of_scene.hpp"

namespace pendcore {
namespace {

template <InstructionSet set>
std::unique_ptr<LaneRunner> lanes_of(std::string_view method, const LaneTask& task) {
  if (method == taylor.info.name) return make_series_lanes<set>(task);
  return make_runge_kutta_lanes<set>(method, task);
}

bool has_lanes(std::string_view method, const Scene& scene, const EquationsOfMotion& equations) {
  if (instruction_set() < least_of_special_kernels || !equations.are_steady()) return false;
  if (method == taylor.info.name) {
    const std::size_t n = scene.links.size();
    return n >= 2 && n <= most_links_in_lanes && !without_series(scene);
  }
  const bool is_embedded =
      method == dormand_prince_5.info.name || method == dormand_prince_8.info.name;
  return is_embedded && with_runge_kutta_form<Pack<4>>(scene, equations, []<class>() {});
}

}  // namespace

std::vector<std::string_view> methods_with_lanes(const Scene& scene) {
  const EquationsOfMotion equations = equations_of_motion(scene);
  std::vector<std::string_view> methods{dormand_prince_5.info.name, dormand_prince_8.info.name,
                                        taylor.info.name};
  std::erase_if(methods, [&](std::string_view one) { return !has_lanes(one, scene, equations); });
  return methods;
}

std::unique_ptr<LaneRunner> make_lanes(const Scene& scene, double t0, double t_end,
                                       const Options& options) {
  const bool is_plain = !options.step && !options.compensated && !options.ledger &&
                        (options.store == Store::times || options.store == Store::end);
  if (!is_plain || t0 == t_end) return nullptr;
  const std::string_view method = find_method(chosen_method(scene, options)).first();
  if (method == taylor.info.name && options.first_step) return nullptr;
  const auto equations = std::make_shared<const EquationsOfMotion>(equations_of_motion(scene));
  if (!has_lanes(method, scene, *equations)) return nullptr;
  const auto is_function = [](const Event& event) {
    return std::holds_alternative<events::Function>(event.function);
  };
  if (std::ranges::any_of(options.events, is_function)) return nullptr;
  const LaneTask task{scene, equations, t0, t_end, options};
  if constexpr (PENDCORE_CLONES != 0) {
    if (instruction_set() == InstructionSet::x86_64_v4) {
      return lanes_of<InstructionSet::x86_64_v4>(method, task);
    }
  }
  return lanes_of<InstructionSet::x86_64_v3>(method, task);
}

}  // namespace pendcore
