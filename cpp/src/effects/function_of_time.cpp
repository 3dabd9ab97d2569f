#include "pendcore/effects/function_of_time.hpp"

#include "effects/times.hpp"
#include "text/message.hpp"

namespace pendcore {

void Table::check(const std::string& where) const {
  check_two_or_more(where, t);
  const std::size_t last = t.size() - 1;
  for (std::size_t i = 1; i <= last; ++i) {
    if (t[i] > t[i - 1]) continue;
    const bool may_step = !hold && i > 1 && i < last && t[i - 1] > t[i - 2];
    if (t[i] == t[i - 1] && may_step) continue;
    std::string range = "above the time before, " + text(t[i - 1]) + " (s)";
    if (t[i] == t[i - 1] && hold)
      range += ": with hold = true each torque needs its time only once";
    if (t[i] == t[i - 1] && !hold) {
      range += ": a time may stand twice, for a step of the torque, between the first and the last";
    }
    refuse(where + "t[" + std::to_string(i) + "]", t[i], range);
  }
  require_size(where + "torque", torque, t.size(), ", one for each time");
}

void Spline::check(const std::string& where) const {
  check_two_or_more(where, t);
  check_increasing(where + "t", t);
  require_size(where + "x", x, t.size(), ", one for each time");
  require_size(where + "y", y, t.size(), ", one for each time");
}

/// Solves the tridiagonal system of the natural spline by elimination.
std::vector<double> Spline::second_derivatives(const std::vector<double>& values) const {
  const std::size_t n = t.size();
  if (n < 2 || values.size() != n) return {};
  std::vector<double> second(n, 0.0);
  std::vector<double> ratio(n, 0.0);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double before = t[i] - t[i - 1];
    const double behind = t[i + 1] - t[i];
    const double change =
        (values[i + 1] - values[i]) / behind - (values[i] - values[i - 1]) / before;
    const double pivot = 2.0 * (before + behind) - before * ratio[i - 1];
    ratio[i] = behind / pivot;
    second[i] = (6.0 * change - before * second[i - 1]) / pivot;
  }
  for (std::size_t i = n - 1; i-- > 1;) second[i] -= ratio[i] * second[i + 1];
  return second;
}

}  // namespace pendcore
