#include "simulate/switching_state.hpp"

#include <climits>
#include <stdexcept>
#include <type_traits>

namespace pendcore {
namespace {

/// Calls visit(number, least, most) for every number but the multiplicities, with its range.
template <class Visit>
void for_each_number(SwitchingState& s, const Visit& visit) {
  for (int& mode : s.modes) visit(mode, -1, INT_MAX);
  visit(s.changes.t, -never, never);
  visit(s.changes.further, 0, INT_MAX);
  visit(s.impacts.lost, -never, never);
  visit(s.impacts.last_impact, -never, never);
  for (int& struck : s.impacts.struck) visit(struck, 0, 1);
  for (int& direction : s.changes.release_direction) visit(direction, -1, 1);
  for (SavedHold& saved : s.holds) {
    visit(saved.hold.is_held, 0, 1);
    visit(saved.hold.angle, -never, never);
    visit(saved.hold.least, -never, never);
    visit(saved.hold.most, -never, never);
    visit(saved.torque_size, -never, never);
  }
  visit(s.has_failed, 0, 1);
}

}  // namespace

std::vector<double> numbers_of(SwitchingState state) {
  std::vector<double> numbers;
  for_each_number(state, [&](auto number, double, double) { numbers.push_back(number); });
  numbers.insert(numbers.end(), state.multiplicities.begin(), state.multiplicities.end());
  return numbers;
}

SwitchingState switching_state(const std::vector<double>& numbers, std::size_t m, std::size_t n) {
  SwitchingState state;
  state.modes.resize(m);
  state.impacts.struck.resize(n);
  state.changes.release_direction.resize(n);
  state.holds.resize(n);
  std::size_t at = 0;
  const auto read = [&]<class Number>(Number& number, double least, double most) {
    require_modes_fit(at < numbers.size());
    const double x = numbers[at++];
    if constexpr (!std::is_same_v<Number, double>) require_modes_fit(x >= least && x <= most);
    number = static_cast<Number>(x);
  };
  for_each_number(state, read);
  state.multiplicities.resize(numbers.size() - at);
  for (int& multiplicity : state.multiplicities) read(multiplicity, 0, 3);
  return state;
}

void require_modes_fit(bool fits) {
  if (!fits) throw std::invalid_argument("the modes of this solution are not those of its scene");
}

}  // namespace pendcore
