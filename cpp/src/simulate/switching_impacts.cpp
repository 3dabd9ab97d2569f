// The impacts of Switching, and what the joints do after them.
#include <algorithm>
#include <cmath>

#include "arithmetic/epsilon.hpp"
#include "dynamics/contact/impact.hpp"
#include "dynamics/kinematics.hpp"
#include "simulate/switching.hpp"
#include "text/message.hpp"

namespace pendcore {
/// Computes an impact and what the joints do after it. Rates have jumped, so that every law with
/// modes may be in another mode.
void Switching::strike(double t, double* y, bool begins) {
  double* const qd = y + n_;
  const std::vector<double> before(qd, qd + n_);
  joints_.begin_impact(y);
  bounce_in_turn(t, y, begins);
  while (capture(t, y, qd)) {
    joints_.stay_at_stops(y, qd);
    choose_all_modes(t, y);
  }
  if (loses_order_ && any_struck_leaves(y) && std::isnan(order_lost_)) order_lost_ = t;
  if (joints_.has_failed()) std::ranges::copy(before, qd);
  book(Account::impact, joints_.loss(before.data(), qd), y);
  book(Account::drive, joints_.work_of_drive(equations_, t, before, qd), y);
}

/// Computes impacts at one time until no joint moves into its stop. A joint at rest that nothing
/// pushes against its stop counts as leaving it, which more exact numbers might show. At the
/// beginning of a run, all joints that touch their stops take part in the first impacts.
void Switching::bounce_in_turn(double t, double* y, bool begins) {
  double* const qd = y + n_;
  const bool is_plastic = may_be_rounding();
  const double rounding = epsilon * joints_.fastest_strike(y, qd);
  loses_order_ = false;
  if (!(std::abs(t - time_of_impact_) <= shortest_moment(t))) std::ranges::fill(struck_, 0);
  time_of_impact_ = t;
  for (int i = 1; i <= most_impacts_at_once && !joints_.has_failed(); ++i) {
    const double speed = joints_.fastest_strike(y, qd);
    if (speed == 0.0) break;
    const bool is_last = i == most_impacts_at_once || speed <= rounding;
    if (!begins) loses_order_ |= loses_order_of(y);
    if (is_last) {
      joints_.stay_at_stops(y, qd);
    } else {
      joints_.bounce(y, qd, is_plastic, begins);
    }
    choose_all_modes(t, y);
    if (is_last) break;
  }
}

/// Whether the order of the joints that strike now and have struck at this time is unknown. In a
/// corner of two stops each impact determines the next, whatever is left of the gaps. This does not
/// hold in a corner of three stops, nor if two joints move into their stops at once.
bool Switching::loses_order_of(const double* y) {
  int at_once = 0;
  for (int j = 0; j < n_; ++j) {
    if (!(joints_.into(j, y, y + n_) > 0.0)) continue;
    ++at_once;
    struck_[j] = 1;
  }
  return at_once > 1 || std::ranges::count(struck_, 1) > 2;
}

/// Whether some of the joints that struck go on moving. If the impacts have brought all of them to
/// rest, another order would do the same.
bool Switching::any_struck_leaves(const double* y) const {
  for (int j = 0; j < n_; ++j) {
    const double away = std::abs(relative(y + n_, j + 1));
    if (struck_[j] != 0 && away > noticeable_rate * joints_.natural_speed()) return true;
  }
  return false;
}

std::string Switching::remark_on_impacts() const {
  if (std::isnan(order_lost_)) return {};
  return "; at t = " + text(order_lost_) +
         " s stops were struck within the last bits of one time: rounding has decided their order, "
         "and with it what follows";
}

void Switching::choose_all_modes(double t, const double* y) {
  choose_modes_from(t, y, y + n_);
  joints_.choose(equations_, t, y, y + n_);
  choose_sides(t, y, y + n_);
}

/// Captures joints that leave a stop and are pushed back to it, and that either return before time
/// can resolve it, or did not bounce and are slower than the capture speed. Returns whether there
/// are any.
bool Switching::capture(double t, const double* q, const double* qd) {
  bool any = false;
  std::vector<double> qdd(n_);
  accelerations_in_force(equations_, t, q, qd, qdd.data());
  const double shortest = shortest_moment(t);
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
