#include "simulate/switching_state.hpp"

#include <climits>
#include <stdexcept>

namespace pendcore {
namespace {

/// Writes numbers to a list, or reads them from it.
class NumberList {
 public:
  NumberList(std::vector<double>& list, bool is_read) : list_(list), is_read_(is_read) {}

  std::size_t left() const { return list_.size() - at_; }

  void operator()(double& x) {
    if (!is_read_) return list_.push_back(x);
    require_modes_fit(left() > 0);
    x = list_[at_++];
  }
  void operator()(bool& x) { whole(x, 0, 1); }
  void operator()(int& x, int least, int most) { whole(x, least, most); }

 private:
  template <class Whole>
  void whole(Whole& x, int least, int most) {
    double number = x;
    (*this)(number);
    require_modes_fit(number >= least && number <= most);
    x = static_cast<Whole>(number);
  }

  std::vector<double>& list_;
  bool is_read_;
  std::size_t at_ = 0;
};

void visit(NumberList& io, SwitchingState& s) {
  for (int& mode : s.modes) io(mode, -1, INT_MAX);
  io(s.changes.t);
  io(s.changes.further, 0, INT_MAX);
  io(s.impacts.lost);
  io(s.impacts.last_impact);
  for (int& struck : s.impacts.struck) io(struck, 0, 1);
  for (int& direction : s.changes.release_direction) io(direction, -1, 1);
  for (SavedHold& saved : s.holds) {
    io(saved.hold.is_held);
    io(saved.hold.angle);
    io(saved.hold.least);
    io(saved.hold.most);
    io(saved.torque_size);
  }
  io(s.has_failed);
}

}  // namespace

std::vector<double> numbers_of(SwitchingState state) {
  std::vector<double> numbers;
  NumberList io(numbers, false);
  visit(io, state);
  numbers.insert(numbers.end(), state.multiplicities.begin(), state.multiplicities.end());
  return numbers;
}

SwitchingState switching_state(std::vector<double> numbers, std::size_t m, std::size_t n) {
  SwitchingState state;
  state.modes.resize(m);
  state.impacts.struck.resize(n);
  state.changes.release_direction.resize(n);
  state.holds.resize(n);
  NumberList io(numbers, true);
  visit(io, state);
  state.multiplicities.resize(io.left());
  for (int& multiplicity : state.multiplicities) io(multiplicity, 0, 3);
  return state;
}

void require_modes_fit(bool fits) {
  if (!fits) throw std::invalid_argument("the modes of this solution are not those of its scene");
}

}  // namespace pendcore
