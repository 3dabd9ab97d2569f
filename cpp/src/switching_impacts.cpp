// The impacts of Switching, and what the joints do after them.
#include <algorithm>
#include <cmath>

#include "pendcore/arithmetic/epsilon.hpp"
#include "pendcore/dynamics/kinematics.hpp"
#include "pendcore/switching.hpp"

namespace pendcore {

/// An impact, and what the joints do after it: rates have jumped, so that every law that has sides
/// may be on another one.
void Switching::strike(double t, double* y) {
  double* const qd = y + n_;
  const std::vector<double> before(qd, qd + n_);
  Impact impact = joints_.strike(equations_, t, y, qd, changes_at_once_ > many_at_once);
  set_out(t, y);
  while (capture(t, y, qd)) {
    const Impact last = joints_.stop_captured(equations_, t, y, qd);
    impact.loss += last.loss;
    impact.work_of_drive += last.work_of_drive;
    set_out(t, y);
  }
  if (joints_.has_failed()) std::ranges::copy(before, qd);
  book(Account::impact, impact.loss, y);
  book(Account::drive, impact.work_of_drive, y);
}

void Switching::set_out(double t, const double* y) {
  choose_modes_from(t, y, y + n_);
  joints_.choose(equations_, t, y, y + n_);
  choose_sides(t, y, y + n_);
}

/// Whether there are joints that leave a stop and are pushed back, and are there again before time
/// can resolve it, or did not bounce there and are slower than the capture speed.
bool Switching::capture(double t, const double* q, const double* qd) {
  bool any = false;
  std::vector<double> qdd(n_);
  accelerations_in_force(equations_, t, q, qd, qdd.data());
  const double shortest = 32.0 * epsilon * std::abs(t);
  for (int j = 0; j < n_; ++j) {
    const Side touched = joints_.contact(j, q);
    const auto side = static_cast<double>(touched);
    const double away = -side * relative(qd, j + 1);
    const double back = side * relative(qdd.data(), j + 1);
    if (!(away > 0.0 && back > 0.0) || joints_.is_captured(j)) continue;
    const bool is_slow =
        away < joints_.supports()[j].stop(touched).capture_speed && !joints_.has_bounced(j);
    if (!is_slow && 2.0 * away >= shortest * back) continue;
    joints_.capture(j);
    any = true;
  }
  return any;
}

void Switching::book(Account account, double value, double* y) const {
  const auto found = std::ranges::find(accounts_, account);
  if (found != accounts_.end()) y[2 * n_ + (found - accounts_.begin())] += value;
}

}  // namespace pendcore
