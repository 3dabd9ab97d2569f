// Events at a jump of the state, and at the start and the end of a step, seen from inside.
#include <doctest/doctest.h>

#include <vector>

#include "pendcore/simulate.hpp"
#include "simulate/event_finder.hpp"
#include "simulate/steppers.hpp"

using namespace pendcore;

namespace {

/// One step of 1 s of a rod that turns at 1 rad/s from q = 0, without gravity.
struct Turning {
  Scene scene{.links = {Link::uniform_rod(3.0, 1.0)}, .gravity = 0.0};
  std::unique_ptr<Stepper> stepper = make_stepper(scene, "dopri5");
  std::vector<double> rows;
  double end[2] = {};

  Turning() {
    const double tolerance[] = {1e-6, 1e-6}, y[] = {0.0, 1.0}, dydt[] = {1.0, 0.0};
    stepper->set_tolerances(tolerance, tolerance);
    stepper->start(y, dydt);
    stepper->attempt({0.0}, 1.0, 1.0);
    rows.resize(static_cast<std::size_t>(stepper->interpolant_degree() + 1) * 2);
    stepper->interpolant(1.0, rows.data());
    stepper->get_new_state(end);
  }
  StepEnd look(EventFinder& finder, double t = 0.0) {
    return finder.look(*stepper, rows.data(), {t, 0.0}, 1.0, t + 1.0);
  }
};

using Times = std::vector<double>;

}  // namespace

TEST_CASE("a jump through zero is an event with the states on both sides") {
  Turning turning;
  const std::vector<Event> events = {
      {.function = events::RateZero{.joint = {}, .link = 1}},
      {.function = events::RateZero{.joint = 1, .link = {}}, .direction = 1},
      {.function = events::LinkAngle{.link = 1, .value = turning.end[0]}},
      {.function = events::LinkAngle{.link = 1, .value = 0.5}},
      {.function = events::Function{.f = [](double, auto,
                                            std::span<const double> qd) { return qd[0] - 0.25; }}},
  };
  std::vector<FoundEvent> found;
  EventFinder finder(turning.scene, events, found, {}, 0.0);
  CHECK(turning.look(finder).kind == StepEnd::Kind::whole);
  REQUIRE(found.size() == 2);  // angle 0.5 within the step, angle 1 at its end
  CHECK(found[0].event == 3);
  CHECK(found[1].event == 2);
  CHECK(found[1].t == 1.0);
  CHECK(found[1].y_before.empty());
  const double before[] = {1.0, 1.0}, after[] = {1.0, -0.5};
  finder.jump(1.0, before, after);
  REQUIRE(found.size() == 4);
  CHECK(found[0].y_before.empty());
  for (const int i : {1, 2, 3}) {
    CHECK(found[i].t == 1.0);
    CHECK(found[i].y == Times{1.0, -0.5});
    CHECK(found[i].y_before == Times{1.0, 1.0});
  }
  CHECK(found[2].event == 0);  // the rate falls, so this is not event 1
  CHECK(found[3].event == 4);
  CHECK(found[2].direction == -1);
}

TEST_CASE("a jump into zero is an event, and a jump from zero is not") {
  Turning turning;
  const std::vector<Event> events = {{.function = events::RateZero{.joint = 1, .link = {}}}};
  std::vector<FoundEvent> found;
  EventFinder finder(turning.scene, events, found, {}, 0.0);
  turning.look(finder);
  CHECK(found.empty());
  const double moves[] = {1.0, 1.0}, rests[] = {1.0, 0.0};
  finder.jump(1.0, moves, rests);
  CHECK(found.size() == 1);
  finder.jump(1.0, rests, moves);
  CHECK(found.size() == 1);
}

TEST_CASE("a jump may end the run, once") {
  Turning turning;
  const std::vector<Event> events = {
      {.function = events::RateZero{.joint = 1, .link = {}}, .terminal = 1}};
  const double before[] = {1.0, 1.0}, after[] = {1.0, -1.0};
  for (const long long passed : {0, 1}) {
    std::vector<FoundEvent> found;
    EventFinder finder(turning.scene, events, found, {passed}, 0.0);
    CHECK(finder.may_end());
    turning.look(finder);
    finder.jump(1.0, before, after);
    CHECK(finder.ended_by() == (passed == 0 ? 0 : -1));
    CHECK(found.size() == 1);
  }
}

TEST_CASE(
    "a step begins with the value at the end of the one before, and calls no function there") {
  Turning turning;
  int calls = 0;
  const auto clock = [&calls](double t, auto, auto) {
    ++calls;
    return t - 0.5;
  };
  const std::vector<Event> events = {{.function = events::Function{.f = clock, .samples = 1}}};
  std::vector<FoundEvent> found;
  EventFinder finder(turning.scene, events, found, {}, -2.0);
  turning.look(finder, -1.0);
  CHECK(calls == 2);
  turning.look(finder);
  REQUIRE(found.size() == 1);
  CHECK(found[0].t == 0.5);
}

TEST_CASE("an event within rounding of the start of a run is not armed, and elsewhere it is") {
  Turning turning;
  for (const double off : {1e-16, 1e-12}) {
    const std::vector<Event> events = {
        {.function = events::LinkAngle{.link = 1, .value = off}},
        {.function = events::JointAngle{.joint = 1, .value = off + 4e-13, .every_turn = true}},
        {.function = events::TipLine{.point = {0.0, off}, .normal = {0.0, 2.0}}},
        {.function = events::Function{.f = [off](double, std::span<const double> q,
                                                 auto) { return q[0] - off; }}},
    };
    for (const double t0 : {0.0, -2.0}) {
      std::vector<FoundEvent> found;
      EventFinder finder(turning.scene, events, found, {}, t0);
      turning.look(finder);
      const bool is_on_it = off == 1e-16 && t0 == 0.0;
      CHECK(found.size() == (is_on_it ? 1 : 4));
      for (const FoundEvent& one : found) CHECK(one.t < 1e-11);
    }
  }
}
