#include "effects/times.hpp"

#include <algorithm>

#include "pendcore/effects/effect.hpp"
#include "text/message.hpp"

namespace pendcore {

void check_two_or_more(const std::string& where, const std::vector<double>& times) {
  if (times.size() >= 2) return;
  throw std::invalid_argument(where + "t: has " + std::to_string(times.size()) +
                              " times: must have two or more (s)");
}

void check_increasing(const std::string& name, const std::vector<double>& times) {
  for (std::size_t i = 1; i < times.size(); ++i) {
    if (!(times[i] > times[i - 1])) {
      refuse(name + "[" + std::to_string(i) + "]", times[i],
             "above the time before, " + text(times[i - 1]) + " (s)");
    }
  }
}

int piece_at(const std::vector<double>& times, double t, bool forward) {
  const int last = static_cast<int>(times.size()) - 2;
  if (forward && t == times.back()) return last;
  if (!forward && t == times.front()) return 0;
  const auto after =
      forward ? std::ranges::upper_bound(times, t) : std::ranges::lower_bound(times, t);
  return static_cast<int>(after - times.begin()) - 1;
}

double next_of(const std::vector<double>& times, double t, bool forward) {
  if (forward) {
    const auto next = std::ranges::upper_bound(times, t);
    return next == times.end() ? never : *next;
  }
  const auto next = std::ranges::lower_bound(times, t);
  return next == times.begin() ? -never : *(next - 1);
}

}  // namespace pendcore
