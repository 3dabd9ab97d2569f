#include "pendcore/effects/user.hpp"

#include <cmath>

namespace pendcore {

/// The piece number k follows break number k - 1, counted from 0.
int CompiledUser::mode_at(double t, double /*phi*/, double /*phid*/, bool forward) const {
  const auto next =
      forward ? std::ranges::upper_bound(breaks, t) : std::ranges::lower_bound(breaks, t);
  return static_cast<int>(next - breaks.begin());
}

/// At a break itself the function may have either value, so the piece ends one double before it,
/// and begins one after it.
void CompiledUser::enter(int mode) {
  const auto piece = static_cast<std::size_t>(mode);
  earliest = piece > 0 ? std::nextafter(breaks[piece - 1], never) : -never;
  latest = piece < breaks.size() ? std::nextafter(breaks[piece], -never) : never;
}

}  // namespace pendcore
