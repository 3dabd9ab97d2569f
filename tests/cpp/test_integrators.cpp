// Every method in the list on equations that have nothing to do with pendulums.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "integrate/loop/first_step.hpp"
#include "integrate/loop/integrate.hpp"
#include "integrate/method_list.hpp"
#include "integrate/radau/implicit_runge_kutta.hpp"
#include "integrate/runge_kutta/runge_kutta_fixed.hpp"
#include "integrate/runge_kutta/runge_kutta_in_memory.hpp"

using namespace pendcore;

namespace tested {

/// Kutta's classical method. Unlike rk4 in the list it is not first-same-as-last: it has no stage
/// at the end.
inline constexpr Tableau<4, 3> classical_4 = {
    .info = {.name = "classical",
             .citation = "Kutta 1901; interpolant: Hairer, Norsett & Wanner 1993, II.6",
             .order = 4,
             .error_order = 0,
             .interpolant_order = 3},
    .first_same_as_last = false,
    .c = {{{0}, {1, 2}, {1, 2}, {1}}},
    .a = {{{}, {{{1, 2}}}, {{{0}, {1, 2}}}, {{{0}, {0}, {1}}}}},
    .b = {{{1, 6}, {1, 3}, {1, 3}, {1, 6}}},
    .e = {},
    .interpolant = {{{{{1}}},
                     {{{-3, 2}, {1}, {1}, {-1, 2}}},
                     {{{2, 3}, {-2, 3}, {-2, 3}, {2, 3}}}}},
};

}  // namespace tested

namespace {

using Function = double (*)(double, double);

/// dy/dt = f(t, y) in one component.
template <Function f>
struct Scalar {
  using Block = double;
  static constexpr int blocks = 1;
  PENDCORE_INLINE void operator()(double t, const double* y, double* dydt) const {
    dydt[0] = f(t, y[0]);
  }
};

/// The same for the rate: q'' = f(t, q'), for methods that need angles and rates.
template <Function f>
class OfTheRate final : public DifferentiableSystem {
 public:
  OfTheRate() : DifferentiableSystem(1, 0) {}
  void operator()(double t, const double* y, double* dydt) const override {
    dydt[0] = y[1];
    dydt[1] = f(t, y[1]);
  }
  void jacobian(double t, const double* y, Eigen::Ref<Matrix> by_q,
                Eigen::Ref<Matrix> by_qd) const override {
    const double step = 1e-6 * std::max(1.0, std::abs(y[1]));
    by_q(0, 0) = 0.0;
    by_qd(0, 0) = (f(t, y[1] + step) - f(t, y[1] - step)) / (2 * step);
  }
};

template <const auto& method, Function f>
std::unique_ptr<Stepper> make_stepper() {
  auto implicit = [](const Collocation& one) {
    return implicit_runge_kutta(one, std::make_unique<OfTheRate<f>>());
  };
  if constexpr (method.info.kind == MethodKind::implicit_one) {
    return implicit(method);
  } else if constexpr (method.info.kind == MethodKind::pair) {
    return std::make_unique<StiffSwitchingStepper>(
        runge_kutta_in_memory(method.first.info.name, std::make_unique<OfTheRate<f>>(), 1),
        [=] { return implicit(method.second); });
  } else {
    return std::make_unique<RungeKuttaFixed<method, Scalar<f>>>(Scalar<f>{});
  }
}

double growing(double t, double y) { return y * std::cos(t); }  // y = y0 exp(sin t)
double decaying(double t, double y) { return -1e6 * (y - std::sin(t)) + std::cos(t); }
double exploding(double, double y) { return y * y; }  // y = 1/(1 - t)
double undefined_from_one(double t, double) { return t < 1.0 ? 1.0 : std::nan(""); }
double infinite_from_one(double t, double) { return t < 1.0 ? 1.0 : HUGE_VAL; }
double undefined(double, double) { return std::nan(""); }
double undefined_over_half(double, double y) { return y + 0.0 * std::sqrt(0.5 - y); }

// Class A of Hull, Enright, Fellen & Sedgwick 1972, from t = 0 to 20; `growing` is A3.
double detest_a1(double, double y) { return -y; }                    // y = exp(-t)
double detest_a2(double, double y) { return -0.5 * y * y * y; }      // y = 1/sqrt(1 + t)
double detest_a4(double, double y) { return y / 4 * (1 - y / 20); }  // y = 20/(1 + 19 exp(-t/4))

class Nothing final : public Observer {
 public:
  StepEnd step_accepted(StepOutput&, const TwoDouble&, double, double) override { return {}; }
  void state_jumped(double, const double*, const double*) override {}
  void restarts_here() override {}
};

struct Result {
  Status status;
  double t;
  double y;
  Statistics statistics;
  int bad;  // component that was not finite
};

struct Request {
  double t0 = 0.0;
  double t_end = 1.0;
  double y0 = 1.0;
  double tolerance = 1e-9;
  double step = 0.0;
  long long max_steps = 1'000'000;
};

template <const auto& method, Function f>
Result solve(const Request& request) {
  const std::unique_ptr<Stepper> stepper = make_stepper<method, f>();
  const std::vector<double> tolerances(stepper->dimension(), request.tolerance);
  stepper->set_tolerances(tolerances.data(), tolerances.data());
  IntegratorState state;
  state.t = {request.t0, 0.0};
  state.y.resize(stepper->dimension());
  state.y.back() = request.y0;
  state.dydt.resize(stepper->dimension());
  stepper->evaluate(request.t0, state.y.data(), state.dydt.data());
  stepper->start(state.y.data(), state.dydt.data());
  const bool is_fixed = request.step > 0.0;
  const double h = is_fixed ? request.step
                            : first_step(*stepper, request.t0, request.t_end, HUGE_VAL,
                                         tolerances.data(), tolerances.data())
                                  .h;
  state.h = request.t_end < request.t0 ? -h : h;
  Nothing nothing;
  IntegratorState resumable;
  const Limits limits{.t_end = request.t_end,
                      .fixed_step = is_fixed,
                      .max_steps = request.max_steps,
                      .monitor = {}};
  const Ending ending = integrate(*stepper, state, resumable, limits, nothing);
  return {ending.status, state.t.high, state.y.back(), state.statistics, ending.bad};
}

template <const auto&... tables>
constexpr auto and_one_without_error_estimate(MethodList<tables...>) {
  return MethodList<tables..., tested::classical_4>{};
}

/// Whether a method is a series, which only pendulums have.
template <const auto& method>
constexpr bool is_of_series = method.info.kind == MethodKind::taylor_one;
template <>
constexpr bool is_of_series<taylor_radau5> = true;

template <class Check, const auto&... tables>
void for_each_of(MethodList<tables...>, Check check) {
  const auto with_method = [&]<const auto & method>() {
    if constexpr (!is_of_series<method>) {
      CAPTURE(method.info.name);
      check.template operator()<method>();
    }
  };
  (with_method.template operator()<tables>(), ...);
}
template <class Check>
void for_each_method(Check check) {
  for_each_of(and_one_without_error_estimate(Methods{}), check);
}
/// Of those that choose their own steps.
template <class Check>
void for_each_adaptive_method(Check check) {
  for_each_method([&]<const auto & method>() {
    if constexpr (method.info.error_order > 0) check.template operator()<method>();
  });
}

}  // namespace

TEST_CASE("the error falls with the order of the method, time-dependent rates included") {
  for_each_method([]<const auto & method>() {
    const double exact = std::exp(std::sin(2.0));
    auto error = [&](double h) {
      const Request request{.t_end = 2.0, .tolerance = 1e-13, .step = h};
      return std::abs(solve<method, growing>(request).y - exact);
    };
    // In short steps of a high order only rounding errors are left.
    const double coarse = method.info.order > 5 ? 1.0 : 0.2;
    const int halvings = method.info.order > 5 ? 2 : 3;
    const double order = std::log2(error(coarse) / error(std::ldexp(coarse, -halvings))) / halvings;
    CHECK(order > method.info.order - 0.25);
    CHECK(order < method.info.order + 0.6);
  });
}

TEST_CASE("class A of DETEST ends within ten tolerances of its closed forms, or thirty") {
  for_each_adaptive_method([]<const auto & method>() {
    // SciPy's DOP853, another program with that table, is off by 21 times the finest tolerance.
    const double most = method.info.order > 5 ? 30 : 10;
    for (const double tolerance : {1e-3, 1e-6, 1e-9, 1e-12}) {
      CAPTURE(tolerance);
      const Request request{.t_end = 20.0, .tolerance = tolerance};
      auto check = [&](double found, double exact) {
        CHECK(std::abs(found - exact) <= most * tolerance * std::max(1.0, exact));
      };
      check(solve<method, detest_a1>(request).y, std::exp(-20.0));
      check(solve<method, detest_a2>(request).y, 1 / std::sqrt(21.0));
      check(solve<method, growing>(request).y, std::exp(std::sin(20.0)));
      check(solve<method, detest_a4>(request).y, 20 / (1 + 19 * std::exp(-5.0)));
    }
  });
}

TEST_CASE("a step limited by stability is flagged as stiff in bounded work") {
  for_each_method([]<const auto & method>() {
    if (method.info.stability == 0.0 || method.info.kind == MethodKind::pair) return;
    const Result stiff = solve<method, decaying>({.tolerance = 1e-3, .max_steps = 10'000});
    CHECK(stiff.status == Status::max_steps);
    CHECK(stiff.statistics.stiff);
    const Result mild = solve<method, growing>({.t_end = 1e4, .tolerance = 1e-6});
    CHECK(mild.statistics.accepted > 5000);
    CHECK_FALSE(mild.statistics.stiff);
  });
}

TEST_CASE("a motion that blows up ends as step_too_small or non_finite, near the pole") {
  for_each_adaptive_method([]<const auto & method>() {
    const Result result = solve<method, exploding>({.t_end = 2.0, .tolerance = 1e-6});
    CHECK((result.status == Status::step_too_small || result.status == Status::non_finite));
    CHECK(result.t == doctest::Approx(1.0).epsilon(1e-5));
    CHECK(std::isfinite(result.y));
  });
}

TEST_CASE("a rate that is not a number is never accepted") {
  for_each_adaptive_method([]<const auto & method>() {
    const Result from_one = solve<method, undefined_from_one>({.t_end = 2.0});
    CHECK(from_one.status == Status::non_finite);
    CHECK(from_one.t <= 1.0);
    CHECK(from_one.t == doctest::Approx(1.0).epsilon(1e-9));
    CHECK(from_one.y == doctest::Approx(2.0).epsilon(1e-9));
    // The state of a pair is (q, qd). The rate is not finite, and neither is the angle, which comes
    // first. dop853 is the exception: only stages beyond t = 1 are not finite there, and no later
    // stage uses them.
    const bool is_pair = method.info.kind == MethodKind::pair;
    CHECK(from_one.bad == (is_pair && method.info.first() == "dop853" ? 1 : 0));
    const Result infinite = solve<method, infinite_from_one>({.t_end = 2.0});
    CHECK(infinite.status == Status::non_finite);
    CHECK(infinite.t == doctest::Approx(1.0).epsilon(1e-9));
    CHECK(std::isfinite(infinite.y));
    const Result from_the_start = solve<method, undefined>({});
    CHECK(from_the_start.status == Status::non_finite);
    CHECK(from_the_start.statistics.accepted == 0);
    // A step of which only a trial stage is beyond the border becomes shorter; the run goes on.
    const Result border = solve<method, undefined_over_half>({.t_end = -1.0, .y0 = 0.49});
    CHECK(border.status == Status::finished);
    const Result beyond = solve<method, undefined_over_half>({.t_end = 1.0, .y0 = 0.4});
    CHECK(beyond.status == Status::non_finite);
    CHECK(beyond.y == doctest::Approx(0.5).epsilon(1e-6));
  });
}

TEST_CASE("a fixed step that is not finite, or too short for its time, ends the run") {
  for_each_method([]<const auto & method>() {
    const Result result = solve<method, undefined_from_one>({.t_end = 2.0, .step = 0.125});
    CHECK(result.status == Status::non_finite);
    CHECK(result.t < 1.0);
    const Result infinite = solve<method, infinite_from_one>({.t_end = 2.0, .step = 0.125});
    CHECK(infinite.status == Status::non_finite);
    CHECK(std::isfinite(infinite.y));
    const Result late = solve<method, growing>({.t0 = 1e17, .t_end = 1e17 + 1e6, .step = 0.01});
    CHECK(late.status == Status::step_too_small);
    CHECK(late.t == 1e17);
  });
}

TEST_CASE("the cap on steps is exact") {
  for_each_adaptive_method([]<const auto & method>() {
    const Result capped =
        solve<method, growing>({.t_end = 100.0, .tolerance = 1e-10, .max_steps = 37});
    CHECK(capped.status == Status::max_steps);
    CHECK(capped.statistics.accepted + capped.statistics.rejected == 37);
  });
}
