// What JavaScript calls, through cpp/wasm/pendcore.mjs.
//
// A scene and the options of a run are drafted by name, one call for each value; the draft then
// becomes a scene or a run, which is an address until it is freed. Text and numbers come in through
// two buffers: the text is a name, and the value either the word after a zero in it, or the
// numbers. Numbers go out as addresses, which hold until the next call.
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "arithmetic/bits.hpp"
#include "pendcore/pendcore.hpp"
#include "scene/effects_of_scene.hpp"
#include "text/message.hpp"

#define EXPORTED(name) [[clang::export_name(#name)]]

namespace {

using namespace pendcore;

std::string text_in;
std::string text_out;
std::vector<double> numbers_in;
std::optional<std::string> word_in;
std::vector<double> numbers_out;
Scene draft;
Options options;

struct Run {
  std::shared_ptr<const Scene> scene;
  Solution solution;
};

[[noreturn]] void refuse_name(const std::string& where, std::string_view name) {
  throw std::invalid_argument(where + std::string(name) + ": there is no such name");
}

[[noreturn]] void refuse_value(const std::string& name_and_value, const char* wanted) {
  throw std::invalid_argument(name_and_value + ": must be " + wanted);
}

/// Takes the value of an option or of a parameter: the word, if one is given, or else the numbers.
template <class Value>
void take(const std::string& name, Value& x) {
  if constexpr (std::same_as<Value, std::vector<Event>>) {
    throw std::invalid_argument(name + ": not offered to JavaScript");
  } else if constexpr (std::same_as<Value, std::string>) {
    if (!word_in) refuse_value(name, "a word");
    x = *word_in;
  } else if constexpr (std::same_as<Value, std::optional<Store>>) {
    if (!word_in) refuse_value(name, "a word");
    x = find_store(*word_in);
    if (!x) throw std::invalid_argument((name + " = \"" + *word_in + "\": ").append(must_be_store));
  } else if (word_in) {
    refuse_value(name + " = " + *word_in, "a number");
  } else if constexpr (std::convertible_to<Value&, std::vector<double>&>) {
    x = numbers_in;
  } else if constexpr (std::same_as<Value, std::array<double, 2>>) {
    if (numbers_in.size() != 2) refuse_value(name, "two numbers");
    x = {numbers_in[0], numbers_in[1]};
  } else {
    if (numbers_in.size() != 1) refuse_value(name, "a number");
    const double given = numbers_in[0];
    if constexpr (std::integral<Value> && !std::same_as<Value, bool>) {
      constexpr double most = std::same_as<Value, int> ? 1e9 : 0x1p53;
      if (!(std::abs(given) <= most) || std::floor(given) != given) {
        refuse(name, given, "a whole number, at most " + text(most));
      }
    }
    x = static_cast<Value>(given);
  }
}

/// Sets the parameter or option called `name`; that of a part is called "sinusoid.amplitude", say.
/// Returns whether there is one.
template <class Struct>
bool set(Struct& changed, std::string_view name, const std::string& where) {
  bool found = false;
  for_each_parameter(changed, [&]<class Value>(const ParameterInfo& info, Value& value) {
    if constexpr (OptionalPart<Value>) {
      const std::string part = std::string(info.name) + '.';
      if (!name.starts_with(part)) return;
      if (!value) value.emplace();
      found = set(*value, name.substr(part.size()), where);
    } else if (name == info.name) {
      take(where + std::string(name), value);
      found = true;
    }
  });
  return found;
}

/// The name in the text, without the word that may follow it after a zero.
std::string take_name() {
  const std::size_t end = text_in.find('\0');
  word_in.reset();
  if (end != std::string::npos) word_in = text_in.substr(end + 1);
  return text_in.substr(0, end);
}

/// n angles and n rates.
struct StateIn {
  std::span<const double> q, qd;
};
StateIn state_in(const Scene& scene) {
  const std::size_t n = scene.links.size();
  if (numbers_in.size() != 2 * n) {
    throw std::invalid_argument("a state: must be " + std::to_string(2 * n) + " numbers");
  }
  for (std::size_t i = 0; i < 2 * n; ++i) {
    if (std::isfinite(numbers_in[i])) continue;
    refuse((i < n ? "q[" : "qd[") + std::to_string(i % n) + "]", numbers_in[i],
           i < n ? "finite (rad)" : "finite (rad/s)");
  }
  return {{numbers_in.data(), n}, {numbers_in.data() + n, n}};
}

/// Numbers in their order: of a matrix, row by row.
template <class Result>
const double* out(const Result& numbers) {
  numbers_out.assign(numbers.data(), numbers.data() + numbers.size());
  give_nan_one_sign(numbers_out);
  return numbers_out.data();
}

}  // namespace

extern "C" {

// JavaScript writes text and numbers into these two buffers.

EXPORTED(text_buffer) char* text_buffer(std::size_t size) {
  text_in.resize(size);
  return text_in.data();
}
EXPORTED(number_buffer) double* number_buffer(std::size_t count) {
  numbers_in.resize(count);
  return numbers_in.data();
}

// These make a scene.

EXPORTED(begin_scene) void begin_scene(double gravity) {
  draft = {.links = {}, .gravity = gravity};
}
EXPORTED(add_link) void add_link(double mass, double length, double center, double inertia) {
  draft.links.push_back({mass, length, center, inertia});
}
/// The text is its kind.
EXPORTED(add_effect) void add_effect() {
  if (text_in == "user") refuse_name("kind = ", text_in);
  draft.effects.push_back(effect_of_kind(text_in, [](auto& /*given*/) {}));
}
/// Sets a parameter of the effect added last.
EXPORTED(set_parameter) void set_parameter() {
  const std::string name = take_name();
  const std::string where = effect_name(draft, draft.effects.size() - 1) + ": ";
  bool found = false;
  visit_parameters(draft.effects.back(), [&](auto changed) {
    found = set(changed, name, where);
    if (found) draft.effects.back() = std::move(changed);
  });
  if (!found) refuse_name(where, name);
}
EXPORTED(end_scene) const Scene* end_scene() {
  constexpr std::size_t most_links = 10'000;  // their matrices would not fit into 32 bits
  if (draft.links.size() > most_links) {
    throw std::invalid_argument(std::to_string(draft.links.size()) + " links: must be at most " +
                                std::to_string(most_links));
  }
  check(draft);
  return new Scene(std::move(draft));
}
EXPORTED(free_scene) void free_scene(const Scene* scene) { delete scene; }

// These make a run.

EXPORTED(begin_options) void begin_options() { options = Options(); }
EXPORTED(set_option) void set_option() {
  const std::string name = take_name();
  if (!set(options, name, "")) refuse_name("option ", name);
}
/// The numbers are the state at t0.
EXPORTED(simulate) const Run* simulate_run(const Scene* scene, double t0, double t_end) {
  const StateIn start = state_in(*scene);
  auto own = std::make_shared<const Scene>(*scene);
  Solution solution = simulate(*own, start.q, start.qd, t0, t_end, options);
  return new Run{std::move(own), std::move(solution)};
}
/// The same run, continued to t_end, as if it had never stopped.
EXPORTED(resume) const Run* resume_run(const Run* run, double t_end) {
  const Options& given = run->solution.options;
  return new Run{run->scene, resume(*run->scene, run->solution, t_end, {}, given.max_steps,
                                    given.time_limit, Monitor())};
}
EXPORTED(free_run) void free_run(const Run* run) { delete run; }

// These tell the results of a run.

EXPORTED(count) std::size_t count(const Run* run) { return run->solution.t.size(); }
EXPORTED(dimension) std::size_t dimension(const Run* run) {
  return static_cast<std::size_t>(run->solution.dimension);
}
EXPORTED(times) const double* times(const Run* run) { return run->solution.t.data(); }
EXPORTED(states) const double* states(const Run* run) { return run->solution.states.data(); }
EXPORTED(reached) double reached(const Run* run) { return run->solution.t_reached; }
EXPORTED(success) bool success(const Run* run) { return text(run->solution.status).success; }
/// Three lines: status, method, message.
EXPORTED(words) const char* words(const Run* run) {
  text_out = std::string(text(run->solution.status).name) + '\n' + run->solution.last_method +
             '\n' + run->solution.message;
  return text_out.c_str();
}
/// Right-hand sides, Jacobians, factorisations, accepted steps, rejected ones.
EXPORTED(statistics) const double* statistics(const Run* run) {
  const Statistics& one = run->solution.statistics;
  return out(std::array{static_cast<double>(one.nfev), static_cast<double>(one.njev),
                        static_cast<double>(one.nlu), static_cast<double>(one.accepted),
                        static_cast<double>(one.rejected)});
}
/// States at the times given as numbers, from the dense output: (times, dimension).
EXPORTED(at) const double* at(const Run* run) { return out(run->solution.sample(numbers_in)); }

/// The entries of the ledger after angles and rates, a line each; those of losses begin with -.
EXPORTED(accounts) const char* accounts(const Run* run) {
  text_out.clear();
  for (const Account account : run->solution.accounts) {
    if (!text_out.empty()) text_out += '\n';
    if (is_loss(account)) text_out += '-';
    text_out += account_name(account);
  }
  return text_out.c_str();
}

/// A hash of every bit of times, states and dense output.
EXPORTED(hash) std::uint64_t hash(const Run* run) { return fingerprint(run->solution); }

// These evaluate a scene in a state, which JavaScript has put into the numbers.

EXPORTED(accelerations) const double* accelerations_of(const Scene* scene, double t) {
  const StateIn state = state_in(*scene);
  return out(accelerations(*scene, t, state.q, state.qd));
}
/// The force on link i from link i - 1, (n, 2).
EXPORTED(reactions) const double* reactions_of(const Scene* scene, double t) {
  const StateIn state = state_in(*scene);
  return out(reactions(*scene, t, state.q, state.qd));
}
/// Kinetic and potential energy.
EXPORTED(energies) const double* energies(const Scene* scene, double t) {
  const StateIn state = state_in(*scene);
  return out(std::vector{kinetic_energy(*scene, t, state.q, state.qd),
                         potential_energy(*scene, t, state.q)});
}
/// The pivot, the joints and the tip, (n + 1, 2).
EXPORTED(positions) const double* positions_of(const Scene* scene, double t) {
  return out(positions(*scene, t, state_in(*scene).q));
}

}  // extern "C"
