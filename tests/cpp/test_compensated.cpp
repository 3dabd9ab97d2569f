// Compensated steppers: which components lose their low part, and which keep it.
#include <doctest/doctest.h>

#include "pendcore/pendcore.hpp"
#include "simulate/steppers.hpp"

using namespace pendcore;

namespace {

/// A stepper with one step behind it, so that its low part is not zero.
std::unique_ptr<Stepper> after_a_step(const Scene& scene, bool ledger) {
  auto stepper = make_stepper(scene, equations_of_motion(scene), "dopri5", ledger, true);
  const std::vector<double> tolerances(stepper->controlled(), 1e-9);
  stepper->set_tolerances(tolerances.data(), tolerances.data());
  std::vector<double> y(stepper->dimension(), 0.7);
  std::vector<double> dydt(stepper->dimension());
  stepper->evaluate(0.0, y.data(), dydt.data());
  stepper->start(y.data(), dydt.data());
  stepper->attempt({0.0}, 1e-3, 1.0);
  return stepper;
}

/// Steppers with every kernel that a compensated step has.
template <class Check>
void for_each_kernel(Check check) {
  for (const std::size_t n : {1, 2, 3, 5}) {
    const Scene bare{.links = std::vector<Link>(n, Link::uniform_rod(1.1, 0.9))};
    Scene damped = bare;
    damped.effects = {ViscousJoint{.joint = 1, .damping = 0.1}};
    check(bare, false);
    check(damped, false);
    check(damped, true);
  }
}

}  // namespace

TEST_CASE("a component that is set at the end of a step has no low part, the others keep theirs") {
  for_each_kernel([](const Scene& scene, bool ledger) {
    auto untouched = after_a_step(scene, ledger);
    untouched->accept(1e-3);
    const std::vector<double> low = untouched->saved_state().memory;
    CHECK(low.size() == static_cast<std::size_t>(untouched->dimension()));
    for (int set = 0; set < untouched->dimension(); ++set) {
      auto stepper = after_a_step(scene, ledger);
      std::vector<double> y(stepper->dimension());
      stepper->get_new_state(y.data());
      y[set] += 0.25;
      stepper->set_new_state(y.data());
      stepper->accept(1e-3);
      std::vector<double> expected = low;
      CHECK(expected[set] != 0.0);
      expected[set] = 0.0;
      CHECK(stepper->saved_state().memory == expected);
    }
  });
}

TEST_CASE("a start drops the low part of components that differ, and a restart drops none") {
  for_each_kernel([](const Scene& scene, bool ledger) {
    auto stepper = after_a_step(scene, ledger);
    stepper->accept(1e-3);
    std::vector<double> expected = stepper->saved_state().memory;
    std::vector<double> y(stepper->dimension());
    std::vector<double> dydt(stepper->dimension());
    stepper->get_state(y.data());
    stepper->get_derivative(dydt.data());
    stepper->start(y.data(), dydt.data());
    CHECK(stepper->saved_state().memory == expected);
    const std::size_t last = y.size() - 1;
    y[last] = 0.0;
    expected[last] = 0.0;
    stepper->start(y.data(), dydt.data());
    CHECK(stepper->saved_state().memory == expected);
  });
}

TEST_CASE("a low part is restored, and the low part of another state is refused") {
  for_each_kernel([](const Scene& scene, bool ledger) {
    auto stepper = after_a_step(scene, ledger);
    stepper->accept(1e-3);
    const std::vector<double> low = stepper->saved_state().memory;
    auto other = after_a_step(scene, ledger);
    other->restore({.memory = low});
    CHECK(other->saved_state().memory == low);
    other->restore({});
    CHECK(other->saved_state().memory == low);
    CHECK_THROWS_AS(other->restore({.memory = {1e-20}}), std::invalid_argument);
  });
}
