#include "run_state.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "arguments.hpp"
#include "bind_effects.hpp"
#include "dynamics/energetics/ledger.hpp"
#include "event_state.hpp"
#include "integrate/loop/integrate.hpp"
#include "integrate/method_list.hpp"
#include "pendcore/effects/user.hpp"
#include "pendcore/methods.hpp"
#include "pendcore/solution.hpp"
#include "scene/effects_of_scene.hpp"

namespace pendcore::bindings {
namespace {

/// Puts fields into a dictionary.
class Writer {
 public:
  py::dict fields;

  template <class Number>
  void operator()(const std::string& key, const Number& value) {
    fields[py::str(key)] = value;
  }
  template <std::derived_from<std::vector<double>> List>
  void operator()(const std::string& key, const List& values) {
    fields[py::str(key)] = copy(values, {static_cast<py::ssize_t>(values.size())});
  }
  /// A number that was not given is a NaN.
  void operator()(const std::string& key, const std::optional<double>& value) {
    fields[py::str(key)] = value.value_or(std::numeric_limits<double>::quiet_NaN());
  }
  void operator()(const std::string& key, Status status) {
    const std::string_view word = text(status).name;
    fields[py::str(key)] = py::str(word.data(), word.size());
  }
  void operator()(const std::string& key, const std::optional<Store>& store) {
    (*this)(key, std::string(store_name(store.value())));
  }
};

/// Takes the same fields out of a dictionary.
class Reader {
 public:
  explicit Reader(const py::dict& fields) : fields_(fields) {}

  template <class Number>
  void operator()(const std::string& key, Number& value) const {
    try {
      value = field(key).template cast<Number>();
    } catch (const py::cast_error&) {
      throw py::value_error(key + ": is not what a solution keeps there");
    }
  }
  template <std::derived_from<std::vector<double>> List>
  void operator()(const std::string& key, List& values) const {
    values = numbers(key.c_str(), field(key));
  }
  void operator()(const std::string& key, std::optional<double>& value) const {
    double number = 0.0;
    (*this)(key, number);
    value = std::isnan(number) ? std::nullopt : std::optional(number);
  }
  void operator()(const std::string& key, Status& status) const {
    std::string word;
    (*this)(key, word);
    for (std::size_t i = 0; i < status_texts.size(); ++i) {
      if (status_texts[i].name == word) {
        status = static_cast<Status>(i);
        return;
      }
    }
    throw py::value_error("status = \"" + word + "\": is none");
  }
  void operator()(const std::string& key, std::optional<Store>& store) const {
    std::string word;
    (*this)(key, word);
    for (std::size_t i = 0; i < store_names.size(); ++i) {
      if (store_names[i] == word) {
        store = static_cast<Store>(i);
        return;
      }
    }
    throw py::value_error("store = \"" + word + "\": is none");
  }

 private:
  py::object field(const std::string& key) const {
    if (!fields_.contains(key)) throw py::value_error(key + ": is missing from this solution");
    return fields_[py::str(key)];
  }

  const py::dict& fields_;
};

template <class Archive, class AnyStatistics>
void visit_statistics(Archive& io, const std::string& prefix, AnyStatistics& s) {
  io(prefix + "nfev", s.nfev);
  io(prefix + "njev", s.njev);
  io(prefix + "nlu", s.nlu);
  io(prefix + "accepted", s.accepted);
  io(prefix + "rejected", s.rejected);
  io(prefix + "limited_by_tolerance", s.limited_by_tolerance);
  io(prefix + "limited_by_max_step", s.limited_by_max_step);
  io(prefix + "limited_by_break", s.limited_by_break);
  io(prefix + "min_step", s.min_step);
  io(prefix + "max_step", s.max_step);
  io(prefix + "stiff", s.stiff);
}

/// Every field of a solution, for writing and for reading.
template <class Archive, class AnySolution>
void visit(Archive& io, AnySolution& s) {
  io("status", s.status);
  io("message", s.message);
  io("last_method", s.last_method);
  visit_statistics(io, "statistics_", s.statistics);
  io("t", s.t);
  io("states", s.states);
  io("dense_degree", s.dense.degree);
  io("dense_start", s.dense.start);
  io("dense_start_low", s.dense.start_low);
  io("dense_h", s.dense.h);
  io("dense_coefficients", s.dense.coefficients);
  for_each_parameter(s.options, [&]<class Value>(const ParameterInfo& info, Value& value) {
    if constexpr (!std::same_as<std::remove_const_t<Value>, std::vector<Event>>) {
      io(std::string(info.name), value);  // event_state.hpp has the events
    }
  });
  io("t_start", s.t0);
  io("t_end", s.t_end);
  io("start", s.start);
  io("t_reached", s.t_reached);
  io("y_reached", s.y_reached);
  io("resumable_t", s.resumable_t);
  io("resumable_steps", s.resumable_steps);
  io("resumable_found", s.resumable_found);
}

/// Every field of the position from which a solution can be resumed.
template <class Archive, class AnyState>
void visit_position(Archive& io, AnyState& p) {
  io("position_t", p.t.high);
  io("position_t_low", p.t.low);
  io("position_h", p.h);
  io("position_h_is_max_step", p.h_is_max_step);
  io("position_trial_was_finite", p.trial_was_finite);
  io("position_crossings_at_once", p.crossings_at_once);
  io("position_log2_error_before", p.control.log2_error_before);
  io("position_after_rejection", p.control.after_rejection);
  io("position_stiff_hits", p.stiff_hits);
  io("position_stiff_misses", p.stiff_misses);
  io("position_stiff_since", p.stiff_since);
  visit_statistics(io, "position_", p.statistics);
  io("position_stepper", p.stepper.memory);
  io("position_stepper_has_switched", p.stepper.has_switched);
  io("position_stepper_h_asked", p.stepper.h_asked);
  io("position_breaks", p.discontinuities);
  io("position_y", p.y);
  io("position_dydt", p.dydt);
}

bool arrays_fit(const Solution& s) {
  const auto n = static_cast<std::size_t>(s.dimension);
  const std::size_t steps = s.dense.h.size();
  return s.states.size() == s.t.size() * n && s.start.size() == n && s.y_reached.size() == n &&
         s.resumable->y.size() == n && s.resumable->dydt.size() == n &&
         s.resumable_t <= s.t.size() && s.resumable_steps <= steps &&
         s.dense.start.size() == steps && s.dense.start_low.size() == steps &&
         s.dense.degree >= 0 && s.dense.degree <= 64 &&
         s.dense.coefficients.size() == steps * (static_cast<std::size_t>(s.dense.degree) + 1) * n;
}

/// Whether the polynomials lead from the start to the time reached, one after the other.
bool polynomials_fit(const Solution& s) {
  const std::vector<double>& start = s.dense.start;
  if (!std::isfinite(s.t0) || !std::isfinite(s.t_reached)) return false;
  if (s.options.store != Store::dense || s.t_reached == s.t0) return start.empty();
  if (start.empty() || start.front() != s.t0) return false;
  const double direction = s.t_reached < s.t0 ? -1.0 : 1.0;
  for (std::size_t i = 0; i < start.size(); ++i) {
    const double next = i + 1 < start.size() ? start[i + 1] : s.t_reached;
    const bool onward = (next - start[i]) * direction > 0.0;
    if (!(onward && s.dense.h[i] * direction > 0.0 && std::isfinite(s.dense.h[i]))) return false;
  }
  return true;
}

/// Whether a run could have these counts: they are far below where adding to them overflows.
bool counts_fit(const Statistics& s) {
  const long long counts[] = {s.nfev,
                              s.njev,
                              s.nlu,
                              s.accepted,
                              s.rejected,
                              s.limited_by_tolerance,
                              s.limited_by_max_step,
                              s.limited_by_break};
  return std::ranges::all_of(counts, [](long long n) { return n >= 0 && n < 1LL << 60; });
}

bool position_fits(const IntegratorState& p) {
  const auto few = [](int n) { return n >= 0 && n < 1'000'000; };
  // The logarithm of a double is below 1100 in magnitude. A NaN fails the comparison.
  return counts_fit(p.statistics) && few(p.stiff_hits) && few(p.stiff_misses) &&
         std::abs(p.control.log2_error_before) < 1100.0;
}

/// The effects as JSON, which keeps every number to the last bit.
std::string json_of_effects(const Scene& scene) {
  py::list effects;
  for (std::size_t i = 0; i < scene.effects.size(); ++i) {
    effects.append(kind_and_values(effect_name(scene, i) + ": ", scene.effects[i]));
  }
  return py::module_::import("json").attr("dumps")(effects).cast<std::string>();
}

std::vector<Effect> effects_of_json(const std::string& json) {
  std::vector<Effect> effects;
  const py::object listed = py::module_::import("json").attr("loads")(json);
  for (const py::handle effect : listed) {
    const auto kind = effect.cast<std::pair<std::string, py::object>>().first;
    // A file that could name an address could have anything called.
    if (kind == "user" || kind == CompiledUser::info.kind) {
      throw py::value_error("effects: " + kind + ": a function cannot come from a file");
    }
    effects.push_back(make_effect(effect));
  }
  return effects;
}

/// A damaged file must end in an error, never in memory that is not ours.
void check_parts(const Solution& s) {
  if (!arrays_fit(s) || !polynomials_fit(s) || !counts_fit(s.statistics) ||
      !position_fits(*s.resumable)) {
    throw py::value_error("the parts of this solution do not fit together");
  }
}

}  // namespace

py::dict statistics(const Statistics& statistics) {
  Writer io;
  visit_statistics(io, "", statistics);
  return io.fields;
}

py::dict get_state(const Run& run) {
  Writer io;
  std::vector<double> links;
  const Scene& scene = scene_of(run);
  for (const Link& link : scene.links) {
    links.insert(links.end(), {link.mass, link.length, link.center, link.inertia});
  }
  io("links", links);
  io("gravity", scene.gravity);
  io("effects", json_of_effects(scene));
  visit(io, run.solution);
  visit_position(io, *run.solution.resumable);
  put_events(io.fields, run.solution);
  return io.fields;
}

Run set_state(const py::dict& state) {
  const Reader io(state);
  Scene scene;
  std::vector<double> links;
  io("links", links);
  if (links.size() % 4 != 0) throw py::value_error("links: must have four numbers a link");
  for (std::size_t i = 0; i < links.size(); i += 4) {
    scene.links.push_back({links[i], links[i + 1], links[i + 2], links[i + 3]});
  }
  io("gravity", scene.gravity);
  std::string effects;
  io("effects", effects);
  scene.effects = effects_of_json(effects);
  check(scene);
  Solution s;
  visit(io, s);
  IntegratorState position;
  visit_position(io, position);
  s.resumable = std::make_shared<const IntegratorState>(std::move(position));
  // In runs kept before "auto" was a rule, "auto" is an alias of this pair.
  const std::string_view method = s.options.method;
  s.options.method = method == automatic ? dopri5_radau5.info.name : find_method(method).name;
  s.n = static_cast<int>(scene.links.size());
  if (s.options.ledger) s.accounts = accounts_of(scene);
  s.dimension = 2 * s.n + static_cast<int>(s.accounts.size());
  check_parts(s);
  take_events(state, s);
  return {.scene = py::cast(std::move(scene)), .solution = std::move(s)};
}

}  // namespace pendcore::bindings
