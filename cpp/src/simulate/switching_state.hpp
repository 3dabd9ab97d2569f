/// \file
/// What a continued run needs to know of the modes of its effects. It is saved as plain numbers,
/// which may come back from a damaged file.
#pragma once

#include <climits>
#include <stdexcept>
#include <vector>

#include "dynamics/contact/held_joints.hpp"

namespace pendcore {

/// The sizes are those of a scene with m effects and n links.
struct SwitchingState {
  std::vector<int> modes;              ///< (m)
  double time_of_change = 0.0;         ///< s, NaN before the first
  int changes_at_once = 0;             ///< at that time, after the first
  double order_lost = 0.0;             ///< s, NaN while the order of impacts is known
  double time_of_impact = 0.0;         ///< s, NaN before the first
  std::vector<int> struck;             ///< (n), whether the joint struck in the last impacts
  std::vector<int> release_direction;  ///< (n), 1, -1, or 0 where none was released
  std::vector<SavedHold> holds;        ///< (n)
  bool has_failed = false;             ///< whether a contact had no finite solution
  std::vector<int> multiplicities;     ///< of zeros at the start, one for each linear guard
};

/// Visits every field, for writing and for reading; whole numbers come with their range.
template <class Archive, class State>
void visit(Archive& io, State& s) {
  for (auto& mode : s.modes) io(mode, -1, INT_MAX);
  io(s.time_of_change);
  io(s.changes_at_once, 0, INT_MAX);
  io(s.order_lost);
  io(s.time_of_impact);
  for (auto& one : s.struck) io(one, 0, 1);
  for (auto& direction : s.release_direction) io(direction, -1, 1);
  for (auto& one : s.holds) {
    io(one.hold.is_held);
    io(one.hold.angle);
    io(one.hold.least);
    io(one.hold.most);
    io(one.torque_size);
  }
  io(s.has_failed);
  io.the_rest(s.multiplicities, 0, 3);
}

inline void require_modes_fit(bool fits) {
  if (!fits) throw std::invalid_argument("the modes of this solution are not those of its scene");
}

class NumbersWriter {
 public:
  std::vector<double> numbers;

  void operator()(double x) { numbers.push_back(x); }
  void operator()(bool x) { numbers.push_back(x ? 1.0 : 0.0); }
  void operator()(int x, int /*least*/, int /*most*/) { numbers.push_back(x); }
  void the_rest(const std::vector<int>& values, int /*least*/, int /*most*/) {
    numbers.insert(numbers.end(), values.begin(), values.end());
  }
};

/// Refuses lists that are too short, and whole numbers out of their range.
class NumbersReader {
 public:
  explicit NumbersReader(const std::vector<double>& numbers) : numbers_(numbers) {}

  void operator()(double& x) { x = next(); }
  void operator()(bool& x) { x = next() != 0.0; }
  void operator()(int& x, int least, int most) {
    const double number = next();
    require_modes_fit(number >= least && number <= most);
    x = static_cast<int>(number);
  }
  void the_rest(std::vector<int>& values, int least, int most) {
    values.resize(numbers_.size() - at_);
    for (int& value : values) (*this)(value, least, most);
  }

 private:
  double next() {
    require_modes_fit(at_ < numbers_.size());
    return numbers_[at_++];
  }

  const std::vector<double>& numbers_;
  std::size_t at_ = 0;
};

}  // namespace pendcore
