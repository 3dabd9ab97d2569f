// Compensated steppers: which components lose their low part, and which keep it.
#include <doctest/doctest.h>

#include "pendcore/pendcore.hpp"
#include "simulate/steppers.hpp"

using namespace pendcore;

namespace {

using Row = std::vector<double>;

/// A stepper with one step behind it, so that its low part is not zero.
std::unique_ptr<Stepper> after_a_step(const Scene& scene, bool ledger, bool is_accepted = true) {
  auto stepper = make_stepper(scene, equations_of_motion(scene), "dopri5", ledger, true);
  const Row tolerances(stepper->controlled(), 1e-9);
  stepper->set_tolerances(tolerances.data(), tolerances.data());
  Row y(stepper->dimension(), 0.7), dydt(stepper->dimension());
  stepper->evaluate(0.0, y.data(), dydt.data());
  stepper->start(y.data(), dydt.data());
  stepper->attempt({0.0}, 1e-3, 1.0);
  if (is_accepted) stepper->accept(1e-3);
  return stepper;
}

Row low_part(Stepper& stepper) { return stepper.saved_state().memory; }

/// Checks every kernel that a compensated step has.
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
    const Row low = low_part(*after_a_step(scene, ledger));
    for (std::size_t set = 0; set < low.size(); ++set) {
      auto stepper = after_a_step(scene, ledger, false);
      Row y(stepper->dimension()), expected = low;
      REQUIRE(y.size() == low.size());
      stepper->get_new_state(y.data());
      y[set] += 0.25;
      stepper->set_new_state(y.data());
      stepper->accept(1e-3);
      CHECK(expected[set] != 0.0);
      expected[set] = 0.0;
      CHECK(low_part(*stepper) == expected);
    }
  });
}

TEST_CASE("a start drops the low part of components that differ, and a restart drops none") {
  for_each_kernel([](const Scene& scene, bool ledger) {
    auto stepper = after_a_step(scene, ledger);
    Row expected = low_part(*stepper), y(stepper->dimension()), dydt(stepper->dimension());
    stepper->get_state(y.data());
    stepper->get_derivative(dydt.data());
    stepper->start(y.data(), dydt.data());
    CHECK(low_part(*stepper) == expected);
    y.back() = expected.back() = 0.0;
    stepper->start(y.data(), dydt.data());
    CHECK(low_part(*stepper) == expected);
  });
}

TEST_CASE("a low part is restored, and the low part of another state is refused") {
  for_each_kernel([](const Scene& scene, bool ledger) {
    const Row low = low_part(*after_a_step(scene, ledger));
    auto other = after_a_step(scene, ledger, false);
    other->restore({.memory = low});
    CHECK(low_part(*other) == low);
    other->restore({});
    CHECK(low_part(*other) == low);
    CHECK_THROWS_AS(other->restore({.memory = {1e-20}}), std::invalid_argument);
  });
}
