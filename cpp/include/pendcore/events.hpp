/// \file
/// Events: zeros of a function of time and state. They are looked for along a run and never change
/// it.
///
///     JointAngle    phi_j - value                  phi_j = q_j - q_{j-1}
///     LinkAngle     q_i - value
///     RateZero      phid_j, or qd_i
///     TipLine       normal . (tip(t) - point)      m, in units of the normal
///     Function      f(t, q, qd)
///
/// For angles and rates, every sign change on the dense output is found, because it is a
/// polynomial. For the line of the tip, every sign change is found by bounds on the second
/// derivative. A Function is only sampled.
///
/// A zero at the start is not an event: an event is armed when its function leaves zero, and at the
/// start of a run zero is whatever rounding makes of it. A zero at the end of a step, or of the
/// run, is an event. After an event, its function must leave zero again. The sign at the end of a
/// step is the sign at the state there; the time of an event comes from its share of the step.
#pragma once

#include <array>
#include <concepts>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <variant>
#include <vector>

#include "pendcore/descriptor.hpp"

namespace pendcore {

struct Event;

// Each kind converts to an event with the defaults: {.events = {events::LinkAngle{.link = 2}}}.
namespace events {

struct JointAngle {
  int joint = 1;
  double value = 0.0;       ///< rad
  bool every_turn = false;  ///< whether value + 2 pi k counts for every k
  static constexpr std::string_view kind = "joint_angle";
  static constexpr auto parameters =
      std::tuple{parameter(&JointAngle::joint, {.name = "joint", .required = true}),
                 parameter(&JointAngle::value, {.name = "value", .unit = "rad", .required = true}),
                 parameter(&JointAngle::every_turn, {.name = "every_turn"})};

  operator Event() const;
};

struct LinkAngle {
  int link = 1;
  double value = 0.0;
  bool every_turn = false;
  static constexpr std::string_view kind = "link_angle";
  static constexpr auto parameters =
      std::tuple{parameter(&LinkAngle::link, {.name = "link", .required = true}),
                 parameter(&LinkAngle::value, {.name = "value", .unit = "rad", .required = true}),
                 parameter(&LinkAngle::every_turn, {.name = "every_turn"})};

  operator Event() const;
};

/// The rate of a joint or of a link becomes zero: one of the two is given.
struct RateZero {
  std::optional<int> joint;
  std::optional<int> link;
  static constexpr std::string_view kind = "rate_zero";
  static constexpr auto parameters = std::tuple{parameter(&RateZero::joint, {.name = "joint"}),
                                                parameter(&RateZero::link, {.name = "link"})};

  operator Event() const;
};

struct TipLine {
  std::array<double, 2> point = {};   ///< a point of the line, m; x right, y down
  std::array<double, 2> normal = {};  ///< across the line
  static constexpr std::string_view kind = "tip_line";
  static constexpr auto parameters =
      std::tuple{parameter(&TipLine::point, {.name = "point", .unit = "m", .required = true}),
                 parameter(&TipLine::normal, {.name = "normal", .unit = "1", .required = true})};

  operator Event() const;
};

/// Sign changes between samples are found. A step has `samples` of them, and there is one at least
/// every `max_step`, which is a distance of samples only, never of steps.
struct Function {
  std::function<double(double t, std::span<const double> q, std::span<const double> qd)> f;
  int samples = 8;
  double max_step = std::numeric_limits<double>::infinity();  ///< s
  static constexpr std::string_view kind = "function";
  static constexpr auto parameters = std::tuple{
      parameter(&Function::samples, {.name = "samples"}),
      parameter(&Function::max_step,
                {.name = "max_step", .unit = "s", .range = Range::positive_or_infinite})};

  operator Event() const;
};

/// Whether a kind of event can be asked for at every turn.
template <class Kind>
concept CountsTurns = requires(const Kind& one) {
  { one.every_turn } -> std::same_as<const bool&>;
};

}  // namespace events

using EventFunction = std::variant<events::JointAngle, events::LinkAngle, events::RateZero,
                                   events::TipLine, events::Function>;

struct Event {
  EventFunction function;
  int direction = 0;       ///< 1: where it rises; -1: where it falls; 0: both, and where it touches
  long long terminal = 0;  ///< the run ends whenever so many have occurred; 0: never
  std::string name = {};

  static constexpr auto parameters = std::tuple{parameter(&Event::direction, {.name = "direction"}),
                                                parameter(&Event::terminal, {.name = "terminal"}),
                                                parameter(&Event::name, {.name = "name"})};

  /// "joint_angle".
  std::string_view kind() const {
    return std::visit([](const auto& one) { return one.kind; }, function);
  }
};

inline events::JointAngle::operator Event() const { return {.function = *this}; }
inline events::LinkAngle::operator Event() const { return {.function = *this}; }
inline events::RateZero::operator Event() const { return {.function = *this}; }
inline events::TipLine::operator Event() const { return {.function = *this}; }
inline events::Function::operator Event() const { return {.function = *this}; }

/// An event that was found.
struct FoundEvent {
  int event = 0;                 ///< its number in the order asked for, from 0
  double t = 0.0;                ///< s
  int direction = 0;             ///< 1: rises; -1: falls; 0: touches zero and turns back
  std::vector<double> y;         ///< (2n); after the jump, if the state jumps
  std::vector<double> y_before;  ///< (2n) where the state jumps, else empty
};

/// "event 2 (link_angle, 'bottom')"
std::string event_name(const Event& event, std::size_t i);

/// Throws std::invalid_argument for what is out of its range in a chain of n links. The message
/// begins with `where`.
void check_event(const std::string& where, const Event& event, int n);

}  // namespace pendcore
