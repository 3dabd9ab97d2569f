#include "pendcore/effects/user.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "effects/behaviour.hpp"
#include "effects/times.hpp"

namespace pendcore {
namespace {

class CompiledUserBehaviour final : public EffectOf<CompiledUser> {
 public:
  using EffectOf::EffectOf;

  /// At a break itself the function may have either value, so the piece ends one double before it,
  /// and begins one after it.
  std::optional<UserLaw> user_law(int mode) const override {
    const std::vector<double>& breaks = given_.breaks;
    const std::size_t piece = std::clamp(mode, 0, static_cast<int>(breaks.size()));
    // NOLINTBEGIN(performance-no-int-to-ptr): that is what the user gave
    return UserLaw{.function = reinterpret_cast<UserFunction>(given_.address),
                   .data = reinterpret_cast<void*>(given_.data),
                   .earliest = piece > 0 ? std::nextafter(breaks[piece - 1], never) : -never,
                   .latest = piece < breaks.size() ? std::nextafter(breaks[piece], -never) : never};
    // NOLINTEND(performance-no-int-to-ptr)
  }

  bool has_modes() const override { return !given_.breaks.empty(); }
  /// The piece number k follows break number k - 1, counted from 0.
  int mode_at(double t, double /*phi*/, double /*phid*/, bool forward) const override {
    const auto next = forward ? std::ranges::upper_bound(given_.breaks, t)
                              : std::ranges::lower_bound(given_.breaks, t);
    return static_cast<int>(next - given_.breaks.begin());
  }
  double next_time(double t, bool forward) const override {
    return next_of(given_.breaks, t, forward);
  }

 private:
  void check_together(const std::string& where) const override {
    if (given_.address == 0) {
      throw std::invalid_argument(where + "address = 0: must be the address of a function");
    }
    check_increasing(where + "breaks", given_.breaks);
  }
};

}  // namespace

std::shared_ptr<const EffectBehaviour> behaviour(CompiledUser given) {
  return std::make_shared<CompiledUserBehaviour>(std::move(given));
}

}  // namespace pendcore
