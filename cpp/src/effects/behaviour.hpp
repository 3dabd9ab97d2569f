/// \file
/// What an effect does: the base class of all behaviours. An effect overrides what it has.
///
/// **Modes.** A law that is only piecewise smooth is frozen to one of its pieces, the mode, during
/// a step, so that the integrator never sees a corner. A guard is positive as long as the mode
/// holds; the step that would cross its zero is cut to end there, and `next_mode` follows.
#pragma once

#include <concepts>
#include <functional>
#include <optional>
#include <vector>

#include "effects/laws.hpp"
#include "effects/pivot_motion.hpp"
#include "pendcore/effects/effect.hpp"
#include "pendcore/effects/function_of_time.hpp"
#include "text/check.hpp"

namespace pendcore {

/// g = offset + on_phi phi + on_phid phid: positive while the mode holds.
struct Guard {
  double offset = 0.0;
  double on_phi = 0.0;
  double on_phid = 0.0;

  /// Whether the zero of the guard is a zero of the rate.
  bool is_on_rate() const { return on_phi == 0.0 && offset == 0.0; }
};

/// Called with every number of an effect: the names of the parts that it belongs to, with a dot
/// after each, its descriptor, and which number of a pair it is, if it is one.
using NumberVisitor = std::function<void(const std::string& part, const ParameterInfo& info,
                                         std::string_view component, double& number)>;

/// The default of each function is an effect that does nothing. The functions are called once a
/// run, a step or a change of mode; what a right-hand side computes are the couples and laws that
/// they return. An effect with a couple acts on a joint, one with a law on a joint or a link.
class EffectBehaviour {
 public:
  virtual ~EffectBehaviour() = default;

  // What the parameters say; EffectOf answers.

  virtual const EffectInfo& info() const = 0;
  virtual const void* given() const = 0;  ///< the parameters
  virtual int joint() const = 0;          ///< at which it acts, counted from 1; 0 if at none
  virtual int link() const = 0;           ///< on which it acts, counted from 1; 0 if on none
  /// Throws std::invalid_argument for parameters out of their ranges or at odds with each other;
  /// `where` begins the message.
  virtual void check(const std::string& where) const = 0;
  /// The same effect, with the numbers as `visit` has changed them.
  virtual Effect with_numbers(const NumberVisitor& visit) const = 0;
  /// Values that are possible but hardly intended, a sentence each.
  virtual std::vector<std::string> warnings() const { return {}; }

  // Its torque or force.

  /// The torque on its joint in a mode, if that is a polynomial; where it is one, it is one in
  /// every mode.
  virtual std::optional<Couple> couple(int /*mode*/) const { return {}; }
  /// The sinusoids that drive its couple, or the axes of the pivot.
  virtual std::vector<Sinusoid> waves() const { return {}; }
  /// Any other law (laws.hpp), with its constants in a mode, for the link on which it acts or which
  /// begins at its joint. It is the same law, with the same shared constants, in every mode.
  virtual std::optional<AnyLaw> law(int /*mode*/, const LinkConstants& /*on*/) const { return {}; }
  /// Whether the law computes the part of its power that is lost; the rest is the wind's.
  virtual bool has_wind() const { return false; }
  /// The energy that it keeps in its joint, J.
  virtual double potential(double /*phi*/) const { return 0.0; }
  /// The torque with which it can hold its joint at rest, N m; none if it cannot.
  virtual std::optional<double> holding_torque() const { return {}; }

  // Its modes, where the law is only piecewise smooth.

  virtual bool has_modes() const { return false; }
  /// The mode that a state calls for. Where two modes meet, the direction of time decides.
  virtual int mode_at(double /*t*/, double /*phi*/, double /*phid*/, bool /*forward*/) const {
    return 0;
  }
  /// An effect whose mode depends on the state has guards in every mode.
  virtual std::vector<Guard> guards(int /*mode*/) const { return {}; }
  /// The mode on the other side of a guard.
  virtual int next_mode(int mode, std::size_t /*guard*/) const { return mode; }
  /// The next time at which the mode changes, whatever the state.
  virtual double next_time(double /*t*/, bool forward) const { return forward ? never : -never; }

  // The span of its table; the run ends where it leaves that.

  virtual double first_time() const { return -never; }
  virtual double last_time() const { return never; }

  // What only one kind does: it moves the pivot, or calls a function of the user's.

  virtual PivotMotion pivot_motion(double /*t*/) const { return {}; }
  /// The law of the pivot in a mode; its axes count the effect's own waves.
  virtual std::optional<PivotLaw> pivot_law(int /*mode*/) const { return {}; }
  virtual std::optional<UserLaw> user_law(int /*mode*/) const { return {}; }

  /// Whether the recurrences of the Taylor series of the equations support it.
  bool has_series() const { return info().has_series || couple(0).has_value(); }
};

/// Calls visit(part, info, component, number) for every number of a structure of parameters, or of
/// a part of one that is there.
template <class Struct>
void for_each_number(Struct& given, const std::string& part, const NumberVisitor& visit) {
  for_each_parameter(given, [&]<class Value>(const ParameterInfo& info, Value& value) {
    if constexpr (std::is_same_v<Value, double>) {
      visit(part, info, {}, value);
    } else if constexpr (std::is_same_v<Value, std::optional<double>>) {
      if (value) visit(part, info, {}, *value);
    } else if constexpr (std::is_same_v<Value, std::array<double, 2>>) {
      for (std::size_t k = 0; k < 2; ++k) visit(part, info, info.components[k], value[k]);
    } else if constexpr (OptionalPart<Value>) {
      if (value) for_each_number(*value, part + std::string(info.name) + ".", visit);
    }
  });
}

/// A part whose parameters must fit together: check(where) throws if they do not.
template <class Struct>
concept HasCheck = requires(const Struct& one, const std::string& where) {
  { one.check(where) } -> std::same_as<void>;
};

/// Throws std::invalid_argument for a parameter out of its range, naming it after `where`, as in
/// "effect 2 (viscous_joint): ".
template <class Struct>
void check_parameters(const std::string& where, const Struct& effect) {
  for_each_parameter(effect, [&]<class Value>(const ParameterInfo& info, const Value& value) {
    check_value(where, info, value);
    if constexpr (OptionalPart<Value>) {
      if (value) check_parameters(where + std::string(info.name) + ".", *value);
    }
  });
  if constexpr (HasCheck<Struct>) effect.check(where);
}

/// The behaviour of an effect with the given parameters: what they alone say.
template <class Kind>
class EffectOf : public EffectBehaviour {
  static_assert(!requires(Kind one) { one.joint, one.link; }, "it acts on a joint or on a link");

 public:
  explicit EffectOf(Kind given) : given_(std::move(given)) {}

  const EffectInfo& info() const final { return Kind::info; }
  const void* given() const final { return &given_; }
  int joint() const final {
    if constexpr (requires { given_.joint; }) return given_.joint;
    return 0;
  }
  int link() const final {
    if constexpr (requires { given_.link; }) return given_.link;
    return 0;
  }
  void check(const std::string& where) const final {
    check_parameters(where, given_);
    check_together(where);
  }
  Effect with_numbers(const NumberVisitor& visit) const final {
    Kind changed = given_;
    for_each_number(changed, "", visit);
    return changed;
  }

 protected:
  /// Throws std::invalid_argument for parameters that are at odds with each other.
  virtual void check_together(const std::string& /*where*/) const {}

  const Kind given_;
};

/// An effect whose law is another one on either side of rest: the sign of the rate of its joint, 1
/// or -1, is its mode.
template <class Kind>
class EffectWithSides : public EffectOf<Kind> {
 public:
  using EffectOf<Kind>::EffectOf;

  bool has_modes() const override { return true; }
  int mode_at(double /*t*/, double /*phi*/, double phid, bool /*forward*/) const final {
    return phid < 0.0 ? -1 : 1;
  }
  std::vector<Guard> guards(int mode) const final {
    return {{.on_phid = static_cast<double>(mode)}};
  }
  int next_mode(int mode, std::size_t /*guard*/) const final { return -mode; }
};

}  // namespace pendcore
