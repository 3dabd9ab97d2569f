/// \file
/// The methods, and what is known of each: the core, Python, figures and pages take all that they
/// say about a method from here.
#pragma once

#include <span>
#include <string_view>

namespace pendcore {

/// The family: explicit Runge-Kutta, implicit Runge-Kutta, Taylor series, or two methods of which
/// the second goes on where the first is limited by stability.
enum class MethodKind { explicit_one, implicit_one, taylor_one, pair };

/// How figures draw a method: a colour of their theme, and matplotlib's terms. A dash may be
/// lengths of ink and gap, "6 2".
struct LineStyle {
  std::string_view color = "quiet";
  std::string_view dash = "5 1 1 1 1 1";
  std::string_view marker = "*";
};

struct MethodInfo {
  std::string_view name;
  std::span<const std::string_view> aliases = {};
  std::string_view sentence = {};  ///< what it is, and what for
  std::string_view citation;
  MethodKind kind = MethodKind::explicit_one;
  int order;              ///< the order of y_new
  int error_order;        ///< the order of the error estimate; 0: none, fixed steps only
  int interpolant_order;  ///< the order of y(t + theta h), uniformly in theta
  double beta = 0.0;      ///< weight of the previous error in the PI control
  double log2_safety = -0.15200309344504997;  ///< log2(0.9): a step aims a tenth short
  double shrink = 0.2;                        ///< a step is at least this share of the step before
  double growth = 10.0;                       ///< and at most this multiple;
  double retry = 0.2;  ///< if a step could not be computed, this share is next
  /// The h |lambda| on the negative real axis from which a problem counts as stiff; for a series,
  /// this is divided by its order. 0: no test.
  double stability = 0.0;
  bool compensates = true;              ///< its steps can carry their rounding errors on
  bool dense_output_is_series = false;  ///< the Taylor series of the solution itself
  std::string_view first_of_pair = {};  ///< the method with which a pair begins; else empty
  std::string_view second_of_pair = {};
  /// The tolerance from which on steps end where the air's drag has a kink; 0: at none.
  double ends_at_kinks_from = 0.0;
  /// The typical largest position error of a run as a multiple of rtol, measured on the four
  /// hundred scenes of tests/models/regular_scenes.py (seeds 200 to 599). 0 for methods that take
  /// fixed steps only: `error=` never takes them.
  double error_over_rtol = 0.0;
  /// Its place among the methods that give second opinions and serve as references, counted from 1,
  /// the most accurate first; 0 if it is not one of them.
  int second_opinion = 0;
  LineStyle line = {};

  /// The method that a run begins with: the first of a pair, or the method itself.
  constexpr std::string_view first() const { return first_of_pair.empty() ? name : first_of_pair; }
};

/// All methods.
std::span<const MethodInfo* const> methods();

/// The method of a name or alias. Throws std::invalid_argument with a list of all methods, after
/// `or_else`, what else the caller takes. "auto" is a rule, not a method (options.hpp).
const MethodInfo& find_method(std::string_view name, std::string_view or_else = {});

}  // namespace pendcore
