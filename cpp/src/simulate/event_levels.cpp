#include "simulate/event_levels.hpp"

#include <algorithm>
#include <array>
#include <span>

#include "integrate/events/root.hpp"

namespace pendcore {

std::optional<Difference> difference_of(const EventFunction& function, int n) {
  const auto of_joint = [](int joint, int first) {
    return Difference{first + joint - 1, joint > 1 ? first + joint - 2 : -1};
  };
  const auto at_levels = [](Difference difference, const auto& angle) {
    difference.value = angle.value;
    difference.every_turn = angle.every_turn;
    return difference;
  };
  if (const auto* angle = std::get_if<events::JointAngle>(&function)) {
    return at_levels(of_joint(angle->joint, 0), *angle);
  }
  if (const auto* angle = std::get_if<events::LinkAngle>(&function)) {
    return at_levels({angle->link - 1, -1}, *angle);
  }
  const auto* rate = std::get_if<events::RateZero>(&function);
  if (rate == nullptr) return std::nullopt;
  if (rate->joint) return of_joint(*rate->joint, n);
  return Difference{n + rate->link.value_or(1) - 1, -1};
}

Levels levels_between(const Difference& difference, double low, double high) {
  const double value = difference.value;
  if (!difference.every_turn) return {value, 0.0, 1.0};
  const double from = (low - value) / Levels::turn;
  const double to = (high - value) / Levels::turn;
  const double margin = 1e-9 + last_bits_share * (std::abs(from) + std::abs(to));
  const double first = std::ceil(from - margin);
  return {value, first, std::floor(to + margin) - first + 1.0};
}

Levels levels_along(const Difference& difference, const std::vector<double>& polynomial, double end,
                    double noise) {
  if (!difference.every_turn) return levels_between(difference, 0.0, 0.0);
  std::array<double, highest_degree + 1> bounds;
  bernstein_form(polynomial.data(), static_cast<int>(polynomial.size()) - 1, bounds.data());
  const auto [least, most] = std::ranges::minmax(std::span(bounds).first(polynomial.size()));
  return levels_between(difference, std::min(least, end) - noise, std::max(most, end) + noise);
}

}  // namespace pendcore
