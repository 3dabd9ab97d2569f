#include "simulate/continuation.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "pendcore/parameters.hpp"
#include "simulate/checked_options.hpp"
#include "text/message.hpp"

namespace pendcore {
namespace {

/// Checks that every number of the scene is as it was, where that is known.
void check_unchanged(const Scene& scene, const Scene& before) {
  if (before.links.empty()) return;
  const std::vector<NamedNumber> now = parameters(scene);
  const std::vector<NamedNumber> known = parameters(before);
  const auto [one, other] =
      std::ranges::mismatch(now, known, [](const NamedNumber& a, const NamedNumber& b) {
        return a.name == b.name && a.value == b.value;
      });
  if (one == now.end() && other == known.end()) return;
  const std::string rule = ": must be the scene of the solution";
  if (one == now.end() || other == known.end() || one->name != other->name) {
    throw std::invalid_argument("scene: has other effects than the solution" + rule);
  }
  throw std::invalid_argument("scene: " + one->name + " = " + text(one->value) +
                              ", and the solution has " + text(other->value) + rule);
}

}  // namespace

void check_continuation(const Scene& scene, const Solution& solution, double t_end,
                        const std::vector<double>& t_eval) {
  if (solution.resumable == nullptr) {
    throw std::invalid_argument("solution: is empty: must be what simulate() or resume() returned");
  }
  if (scene.links.size() != static_cast<std::size_t>(solution.n)) {
    throw std::invalid_argument("scene: has " + std::to_string(scene.links.size()) +
                                " links, and the solution has " + std::to_string(solution.n) +
                                ": must be the scene of the solution");
  }
  check_unchanged(scene, solution.scene);
  const double reached = solution.t_reached;
  // A run of no length has no direction yet: it takes the direction of its continuation.
  const bool has_length = solution.t_end != solution.t0;
  const double span = (has_length ? solution.t_end : t_end) - solution.t0;
  auto before = [span](double a, double b) { return span < 0.0 ? b < a : span > 0.0 && a < b; };
  const std::string beyond = span < 0.0 ? "before " : "beyond ";
  const std::string way = span < 0.0 ? " s: this run goes back in time" : " s";
  if (!std::isfinite(t_end) || before(t_end, reached)) {
    refuse("t_end", t_end,
           "finite and at or " + beyond + "the end reached, " + text(reached) + way);
  }
  const std::vector<double>& asked = solution.options.t_eval;
  if (!asked.empty() && before(t_end, asked.back())) {
    refuse("t_end", t_end,
           "at or " + beyond + "the last time asked for, " + text(asked.back()) + way);
  }
  if (t_eval.empty()) return;
  if (asked.empty()) {
    throw std::invalid_argument(
        "t_eval: this run was not asked for times, and keeps what it kept so far: leave t_eval "
        "out");
  }
  check_times(t_eval, reached, t_end);
  if (!before(asked.back(), t_eval.front())) {
    refuse("t_eval[0]", t_eval.front(),
           beyond + "the last time asked for so far, " + text(asked.back()) + way);
  }
}

}  // namespace pendcore
