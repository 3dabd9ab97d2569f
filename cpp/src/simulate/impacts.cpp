#include "simulate/impacts.hpp"

#include <algorithm>
#include <cmath>

#include "arithmetic/epsilon.hpp"
#include "dynamics/contact/impact_laws.hpp"
#include "dynamics/kinematics.hpp"
#include "text/message.hpp"

namespace pendcore {

Impacts::Impacts(const EquationsOfMotion& equations, Modes& modes,
                 const std::vector<Account>& accounts)
    : equations_(equations),
      modes_(modes),
      joints_(*equations_.held_joints),
      accounts_(accounts),
      n_(static_cast<int>(joints_.holds().size())) {
  order_.struck.resize(n_);
}

void Impacts::strike(double t, double* y, bool begins) {
  double* const qd = y + n_;
  const std::vector<double> before(qd, qd + n_);
  joints_.begin_impact(y);
  if (bounce_in_turn(t, y, begins) && std::isnan(order_.lost)) order_.lost = t;
  while (capture(t, y)) {
    joints_.stay_at_stops(y, qd);
    modes_.choose_all(t, y);
  }
  if (joints_.has_failed()) std::ranges::copy(before, qd);
  book(Account::impact, joints_.loss(before.data(), qd), y);
  book(Account::drive, joints_.work_of_drive(equations_, t, before, qd), y);
}

/// Computes impacts at one time until no joint moves into its stop. A joint at rest that nothing
/// pushes against its stop counts as leaving it, which more exact numbers might show. Returns
/// whether the order of the impacts is unknown and may matter. It may even where all of them have
/// brought the joints to rest: in another order, a joint may be thrown off after its impact.
bool Impacts::bounce_in_turn(double t, double* y, bool begins) {
  double* const qd = y + n_;
  const bool is_plastic = modes_.changes().may_be_rounding();
  const double rounding = epsilon * joints_.fastest_strike(y, qd);
  bool loses_order = false;
  if (!(std::abs(t - order_.last_impact) <= joints_.shortest_moment(t))) {
    std::ranges::fill(order_.struck, 0);
  }
  order_.last_impact = t;
  for (int i = 1; i <= most_impacts_at_once && !joints_.has_failed(); ++i) {
    const double speed = joints_.fastest_strike(y, qd);
    if (speed == 0.0) break;
    const bool is_last = i == most_impacts_at_once || speed <= rounding;
    const bool is_noticeable = speed > noticeable_rate * joints_.natural_speed();
    if (!begins && loses_order_of(y) && is_noticeable) loses_order = true;
    if (is_last) {
      joints_.stay_at_stops(y, qd);
    } else {
      joints_.bounce(y, qd, is_plastic, begins);
    }
    modes_.choose_all(t, y);
    if (is_last) break;
  }
  return loses_order;
}

/// Whether the order of the joints that strike now and have struck at this time is unknown. In a
/// corner of two stops each impact determines the next, whatever is left of the gaps. This does not
/// hold in a corner of three stops, nor if two joints move into their stops at once.
bool Impacts::loses_order_of(const double* y) {
  int at_once = 0;
  for (int j = 0; j < n_; ++j) {
    if (!(joints_.into(j, y, y + n_) > 0.0)) continue;
    ++at_once;
    order_.struck[j] = 1;
  }
  return at_once > 1 || std::ranges::count(order_.struck, 1) > 2;
}

std::string Impacts::remark() const {
  if (std::isnan(order_.lost)) return {};
  return "; at t = " + text(order_.lost) +
         " s stops were struck within the last bits of one time: rounding has decided their order, "
         "and perhaps with it what follows";
}

/// Captures joints that leave a stop and are pushed back to it, and that either return before time
/// can resolve it, or did not bounce and are slower than the capture speed. Returns whether there
/// are any.
bool Impacts::capture(double t, const double* y) {
  const double* const qd = y + n_;
  bool any = false;
  std::vector<double> qdd(n_);
  accelerations_in_force(equations_, t, y, qd, qdd.data());
  const double shortest = joints_.shortest_moment(t);
  for (int j = 0; j < n_; ++j) {
    const Side touched = joints_.contact(j, y);
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

void Impacts::book(Account account, double value, double* y) const {
  const auto found = std::ranges::find(accounts_, account);
  if (found != accounts_.end()) y[2 * n_ + (found - accounts_.begin())] += value;
}

}  // namespace pendcore
