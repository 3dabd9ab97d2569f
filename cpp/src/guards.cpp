#include "pendcore/integrate/guards.hpp"

#include "pendcore/integrate/root.hpp"

namespace pendcore {
Guards::Guards(const Stepper& stepper, const Breaks& breaks)
    : stepper_(stepper),
      breaks_(breaks),
      dimension_(stepper.dimension()),
      degree_(stepper.interpolant_degree()),
      rows_(static_cast<std::size_t>(degree_ + 1) * dimension_),
      state_(dimension_),
      polynomial_(degree_ + 1) {}

Crossing Guards::first(double h) {
  Crossing found;
  if (breaks_.guards() == 0) return found;
  stepper_.interpolant(h, rows_.data());
  for (int k = 0; k < breaks_.guards(); ++k) {
    breaks_.polynomial(k, rows_.data(), degree_, dimension_, polynomial_.data());
    const double theta = first_negative(polynomial_.data(), degree_);
    if (theta < found.theta) found = {k, theta};
  }
  return found;
}

double Guards::miss(int k, double h) {
  stepper_.interpolant(h, rows_.data());
  stepper_.get_new_state(state_.data());
  const double g = breaks_.guard(k, state_.data());
  breaks_.polynomial(k, rows_.data(), degree_, dimension_, polynomial_.data());
  double slope = 0.0;
  for (int p = degree_; p > 0; --p) slope += p * polynomial_[p];
  return slope != 0.0 ? g / slope : 0.0;
}

}  // namespace pendcore
