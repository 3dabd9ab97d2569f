#include "pendcore/integrate/guards.hpp"

#include "pendcore/integrate/root.hpp"

namespace pendcore {
namespace {

constexpr int samples_of_a_guard = 8;  // where it is no polynomial

}  // namespace

Guards::Guards(const Stepper& stepper, const Breaks& breaks)
    : stepper_(stepper),
      breaks_(breaks),
      dimension_(stepper.dimension()),
      degree_(stepper.interpolant_degree()),
      rows_(static_cast<std::size_t>(degree_ + 1) * dimension_),
      state_(dimension_) {}

Crossing Guards::first(const TwoDouble& t, double h) {
  Crossing found;
  if (breaks_.guards() == 0) return found;
  stepper_.interpolant(h, rows_.data());
  double polynomial[16];
  for (int k = 0; k < breaks_.guards(); ++k) {
    const double theta =
        breaks_.polynomial(k, rows_.data(), degree_, dimension_, polynomial)
            ? first_negative(polynomial, degree_)
            : first_negative([&](double x) { return value(k, t, h, x); }, samples_of_a_guard);
    if (theta < found.theta) found = {k, theta};
  }
  return found;
}

double Guards::miss(int k, const TwoDouble& t, double h) {
  stepper_.interpolant(h, rows_.data());
  stepper_.get_new_state(state_.data());
  const double g = breaks_.guard(k, (t + h).high, state_.data());
  const double before = value(k, t, h, 1.0 - 1e-3);
  const double slope = (value(k, t, h, 1.0) - before) / 1e-3;
  return slope != 0.0 ? g / slope : 0.0;
}

double Guards::value(int k, const TwoDouble& t, double h, double theta) {
  for (int i = 0; i < dimension_; ++i) {
    double sum = rows_[static_cast<std::size_t>(degree_) * dimension_ + i];
    for (int p = degree_ - 1; p >= 0; --p) {
      sum = sum * theta + rows_[static_cast<std::size_t>(p) * dimension_ + i];
    }
    state_[i] = sum;
  }
  return breaks_.guard(k, (t + theta * h).high, state_.data());
}

}  // namespace pendcore
