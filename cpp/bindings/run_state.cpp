#include "run.hpp"

#include <cmath>
#include <limits>

#include "arguments.hpp"
#include "dynamics/energetics/ledger.hpp"
#include "integrate/loop/integrate.hpp"
#include "integrate/method_list.hpp"
#include "kind_and_values.hpp"
#include "pendcore/effects/user.hpp"
#include "pendcore/methods.hpp"
#include "pendcore/solution.hpp"
#include "scene/effects_of_scene.hpp"

namespace pendcore::bindings {
namespace {

/// Puts fields into a dictionary. A number that was not given is a NaN there.
class Writer {
 public:
  py::dict fields;

  template <class Value>
  void operator()(const std::string& key, const Value& value) {
    fields[py::str(key)] = [&] {
      if constexpr (std::convertible_to<const Value&, const std::vector<double>&>) {
        return copy(value);
      } else if constexpr (std::same_as<Value, std::optional<double>>) {
        return value.value_or(std::numeric_limits<double>::quiet_NaN());
      } else if constexpr (std::same_as<Value, std::optional<Store>>) {
        return store_name(value.value());
      } else if constexpr (std::same_as<Value, Status>) {
        return text(value).name;
      } else {
        return value;
      }
    }();
  }
};

/// Takes the same fields out of a dictionary.
class Reader {
 public:
  explicit Reader(const py::dict& fields) : fields_(fields) {}

  template <class Value>
  void operator()(const std::string& key, Value& value) const {
    if (!fields_.contains(key)) throw py::value_error(key + ": is missing from this solution");
    const py::object kept = fields_[py::str(key)];
    if constexpr (std::same_as<Value, std::optional<double>>) {
      const double x = number(key, kept);
      value = std::isnan(x) ? std::nullopt : std::optional(x);
    } else if constexpr (std::same_as<Value, std::optional<Store>>) {
      value = named(key, kept, find_store);
    } else if constexpr (std::same_as<Value, Status>) {
      value = named(key, kept, find_status);
    } else {
      take(key, kept, value);
    }
  }

 private:
  /// What `find` finds by the name that is kept.
  static auto named(const std::string& key, py::handle kept, const auto& find) {
    std::string name;
    take(key, kept, name);
    const auto found = find(name);
    if (!found) throw py::value_error(key + " = \"" + name + "\": is none");
    return *found;
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
      io(std::string(info.name), value);  // the events are kept as JSON
    }
  });
  io("t_start", s.t0);
  io("t_end", s.t_end);
  io("start", s.start);
  io("t_reached", s.t_reached);
  io("y_reached", s.y_reached);
  io("resumable_t", s.resumable_kept.t);
  io("resumable_steps", s.resumable_kept.steps);
  io("resumable_found", s.resumable_kept.found);
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
         s.resumable_kept.t <= s.t.size() && s.resumable_kept.steps <= steps &&
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
  bool fit = true;
  const auto look = [&]<class Number>(const std::string& /*key*/, const Number& n) {
    if constexpr (std::same_as<Number, long long>) fit = fit && n >= 0 && n < 1LL << 60;
  };
  visit_statistics(look, "", s);
  return fit;
}

bool position_fits(const IntegratorState& p) {
  const auto few = [](int n) { return n >= 0 && n < 1'000'000; };
  // The logarithm of a double is below 1100 in magnitude. A NaN fails the comparison.
  return counts_fit(p.statistics) && few(p.stiff_hits) && few(p.stiff_misses) &&
         std::abs(p.control.log2_error_before) < 1100.0;
}

/// Effects or events as JSON, which keeps every number to the last bit.
std::string json_of(const py::list& pairs) {
  return py::module_::import("json").attr("dumps")(pairs).cast<std::string>();
}

/// Calls visit(pair) for each effect or event. A file that could name a function, or an address,
/// could have anything called.
template <class Visit>
void for_each_in_json(const char* key, const std::string& json, const Visit& visit) {
  for (const py::handle pair : py::module_::import("json").attr("loads")(json)) {
    const auto kind = pair.cast<KindAndValues>().first;
    if (kind == "user" || kind == CompiledUser::info.kind || kind == events::Function::kind) {
      throw py::value_error(std::string(key) + ": " + kind +
                            ": a function cannot come from a file");
    }
    visit(pair);
  }
}

/// The effects that act in a scene. Raises TypeError for a function, which cannot be kept.
std::string json_of_effects(const Scene& scene) {
  py::list pairs;
  for (std::size_t i = 0; i < scene.effects.size(); ++i) {
    if (scene.effects[i].info().is_function) {
      throw py::type_error(effect_name(scene, i) +
                           ": is a function: a run with it cannot be pickled or saved");
    }
    pairs.append(kind_and_values(scene.effects[i]));
  }
  return json_of(pairs);
}

/// The events that a run looked for. Raises TypeError for a function, which cannot be kept.
std::string json_of_events(const std::vector<Event>& events) {
  py::list pairs;
  for (std::size_t i = 0; i < events.size(); ++i) {
    if (std::holds_alternative<events::Function>(events[i].function)) {
      throw py::type_error(event_name(events[i], i) +
                           ": is a function: a run that looks for it cannot be pickled or saved");
    }
    pairs.append(kind_and_values(events[i], py::none()));
  }
  return json_of(pairs);
}

struct FoundColumns {
  std::vector<double> event{}, t{}, direction{}, y{};
  std::vector<double> y_before{};  ///< NaN where the state does not jump
};

template <class Archive, class AnyColumns>
void visit_found(Archive& io, AnyColumns& found) {
  io("found_event", found.event);
  io("found_t", found.t);
  io("found_direction", found.direction);
  io("found_y", found.y);
  io("found_y_before", found.y_before);
}

FoundColumns columns_of(const std::vector<FoundEvent>& found) {
  FoundColumns columns;
  for (const FoundEvent& one : found) {
    columns.event.push_back(one.event);
    columns.t.push_back(one.t);
    columns.direction.push_back(one.direction);
    columns.y.insert(columns.y.end(), one.y.begin(), one.y.end());
    columns.y_before.insert(columns.y_before.end(), one.y_before.begin(), one.y_before.end());
    columns.y_before.resize(columns.y.size(), std::nan(""));
  }
  return columns;
}

/// Raises ValueError for what does not fit together, or to the events that were looked for.
std::vector<FoundEvent> found_events(const FoundColumns& columns, const Solution& solution) {
  const auto& [event, t, direction, y, y_before] = columns;
  const std::size_t count = event.size();
  const std::size_t n = 2 * static_cast<std::size_t>(solution.n);
  bool fits = t.size() == count && direction.size() == count && y.size() == count * n &&
              y_before.size() == count * n && solution.resumable_kept.found <= count;
  std::vector<FoundEvent> found;
  for (std::size_t i = 0; fits && i < count; ++i) {
    fits = event[i] >= 0.0 && event[i] < static_cast<double>(solution.options.events.size()) &&
           std::abs(direction[i]) <= 1.0;
    if (!fits) break;
    const double* const state = y.data() + i * n;
    const double* const before = y_before.data() + i * n;
    found.push_back({.event = static_cast<int>(event[i]),
                     .t = t[i],
                     .direction = static_cast<int>(direction[i]),
                     .y = {state, state + n},
                     .y_before = {}});
    if (!std::isnan(*before)) found.back().y_before.assign(before, before + n);
  }
  if (!fits) throw py::value_error("the events of this solution do not fit together");
  return found;
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
  const FoundColumns found = columns_of(run.solution.found);
  io("events", json_of_events(run.solution.options.events));
  visit_found(io, found);
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
  std::string json;
  io("effects", json);
  for_each_in_json("effects", json,
                   [&](py::handle pair) { scene.effects.push_back(make_effect(pair)); });
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
  io("events", json);
  for_each_in_json("events", json, [&](py::handle pair) {
    s.options.events.push_back(make_event(pair));
    check_event("events: ", s.options.events.back(), s.n);
  });
  FoundColumns found;
  visit_found(io, found);
  s.found = found_events(found, s);
  return {.scene = py::cast(std::move(scene)), .solution = std::move(s)};
}

}  // namespace pendcore::bindings
