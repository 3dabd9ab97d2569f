// Every method in the list, and one that is not, on rates of which the answers are known: the rate
// y of a rod of inertia 1 follows dy/dt = f(t, y), a torque.
#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "integrate/loop/integrate.hpp"
#include "integrate/method_list.hpp"
#include "integrate/runge_kutta/runge_kutta_fixed.hpp"
#include "pendcore/pendcore.hpp"

using namespace pendcore;

namespace {

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

struct Request {
  double t0 = 0.0;
  double t_end = 1.0;
  double y0 = 1.0;
  double tolerance = 1e-9;
  double step = 0.0;
  long long max_steps = 1'000'000;
};

struct Result {
  Status status;
  double t;
  double y;
  Statistics statistics;
  std::string message;
};

Result solve(const MethodInfo& method, double (*f)(double, double), const Request& request) {
  const auto torque = [f](double t, std::span<const double>, std::span<const double> qd,
                          std::span<double> Q) { Q[0] += f(t, qd[0]); };
  const Scene scene{.links = {Link::uniform_rod(3.0, 1.0)},
                    .gravity = 0.0,
                    .effects = {CompiledUser::of(torque)}};
  Options options{.rtol = request.tolerance, .atol = request.tolerance, .store = Store::end};
  options.method = method.name;
  options.max_steps = request.max_steps;
  if (request.step > 0.0) options.step = request.step;
  const Solution run = simulate(scene, {0.0}, {request.y0}, request.t0, request.t_end, options);
  return {run.status, run.t_reached, run.y_reached[1], run.statistics, run.message};
}

/// Calls a check with each method but the series, which only the core's own effects have.
void for_each_method(const std::function<void(const MethodInfo&)>& check) {
  for (const MethodInfo* const method : Methods::infos) {
    if (method->name.starts_with("taylor")) continue;
    CAPTURE(method->name);
    check(*method);
  }
}
/// Those that choose their own steps.
void for_each_adaptive_method(const std::function<void(const MethodInfo&)>& check) {
  for_each_method([&](const MethodInfo& method) {
    if (method.error_order > 0) check(method);
  });
}

/// Kutta's classical method. Unlike rk4 in the list it is not first-same-as-last: it has no stage
/// at the end.
constexpr Tableau<4, 3> classical_4 = {
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

/// dy/dt = f(t, y) in one component.
template <double (*f)(double, double)>
struct Scalar {
  using Block = double;
  static constexpr int blocks = 1;
  PENDCORE_INLINE void operator()(double t, const double* y, double* dydt) const {
    dydt[0] = f(t, y[0]);
  }
};

class Nothing final : public Observer {
 public:
  StepEnd step_accepted(StepOutput&, const TwoDouble&, double, double) override { return {}; }
  void state_jumped(double, const double*, const double*) override {}
  void restarts_here() override {}
};

template <double (*f)(double, double)>
Result by_classical_4(const Request& request) {
  RungeKuttaFixed<classical_4, Scalar<f>> stepper{Scalar<f>{}};
  IntegratorState integrator, resumable;
  integrator.t = {request.t0, 0.0};
  integrator.h = request.step;
  integrator.y = {request.y0};
  integrator.dydt = {f(request.t0, request.y0)};
  stepper.start(integrator.y.data(), integrator.dydt.data());
  const Limits limits{.t_end = request.t_end, .fixed_step = true, .monitor = {}};
  Nothing nothing;
  const Ending ending = integrate(stepper, integrator, resumable, limits, nothing);
  CHECK(ending.bad == (ending.status == Status::non_finite ? 0 : -1));  // the only component
  return {ending.status, integrator.t.high, integrator.y[0], integrator.statistics, ""};
}

void check_order(int order, const std::function<double(double)>& error) {
  // In short steps of a high order only rounding errors are left.
  const double coarse = order > 5 ? 1.0 : 0.2;
  const int halvings = order > 5 ? 2 : 3;
  const double found = std::log2(error(coarse) / error(std::ldexp(coarse, -halvings))) / halvings;
  CHECK(found > order - 0.25);
  CHECK(found < order + 0.6);
}

}  // namespace

TEST_CASE("the error falls with the order of the method, time-dependent rates included") {
  const double exact = std::exp(std::sin(2.0));
  for_each_method([&](const MethodInfo& method) {
    check_order(method.order, [&](double h) {
      const Request request{.t_end = 2.0, .tolerance = 1e-13, .step = h};
      return std::abs(solve(method, growing, request).y - exact);
    });
  });
  check_order(4, [&](double h) {
    return std::abs(by_classical_4<growing>({.t_end = 2.0, .step = h}).y - exact);
  });
}

TEST_CASE("class A of DETEST ends within ten tolerances of its closed forms, or thirty") {
  for_each_adaptive_method([](const MethodInfo& method) {
    // SciPy's DOP853, another program with that table, is off by 21 times the finest tolerance.
    const double most = method.order > 5 ? 30 : 10;
    for (const double tolerance : {1e-3, 1e-6, 1e-9, 1e-12}) {
      CAPTURE(tolerance);
      auto check = [&](double (*f)(double, double), double exact) {
        const Result found = solve(method, f, {.t_end = 20.0, .tolerance = tolerance});
        CHECK(std::abs(found.y - exact) <= most * tolerance * std::max(1.0, exact));
      };
      check(detest_a1, std::exp(-20.0));
      check(detest_a2, 1 / std::sqrt(21.0));
      check(growing, std::exp(std::sin(20.0)));
      check(detest_a4, 20 / (1 + 19 * std::exp(-5.0)));
    }
  });
}

TEST_CASE("a step limited by stability is flagged as stiff in bounded work") {
  for_each_method([](const MethodInfo& method) {
    if (method.stability == 0.0 || method.kind == MethodKind::pair) return;
    const Result stiff = solve(method, decaying, {.tolerance = 1e-3, .max_steps = 10'000});
    CHECK(stiff.status == Status::max_steps);
    CHECK(stiff.statistics.stiff);
    const Result mild = solve(method, growing, {.t_end = 1e4, .tolerance = 1e-6});
    CHECK(mild.statistics.accepted > 5000);
    CHECK_FALSE(mild.statistics.stiff);
  });
}

TEST_CASE("a motion that blows up ends as step_too_small or non_finite, near the pole") {
  for_each_adaptive_method([](const MethodInfo& method) {
    const Result result = solve(method, exploding, {.t_end = 2.0, .tolerance = 1e-6});
    CHECK((result.status == Status::step_too_small || result.status == Status::non_finite));
    CHECK(result.t == doctest::Approx(1.0).epsilon(1e-5));
    CHECK(std::isfinite(result.y));
  });
}

TEST_CASE("a rate that is not a number is never accepted") {
  for_each_adaptive_method([](const MethodInfo& method) {
    const Result from_one = solve(method, undefined_from_one, {.t_end = 2.0});
    CHECK(from_one.status == Status::non_finite);
    CHECK(from_one.t <= 1.0);
    CHECK(from_one.t == doctest::Approx(1.0).epsilon(1e-9));
    CHECK(from_one.y == doctest::Approx(2.0).epsilon(1e-9));
    CHECK(from_one.message.find(", qd_1, by effect 1 (user)") != std::string::npos);
    const Result infinite = solve(method, infinite_from_one, {.t_end = 2.0});
    CHECK(infinite.status == Status::non_finite);
    CHECK(infinite.t == doctest::Approx(1.0).epsilon(1e-9));
    CHECK(std::isfinite(infinite.y));
    const Result from_the_start = solve(method, undefined, {});
    CHECK(from_the_start.status == Status::non_finite);
    CHECK(from_the_start.statistics.accepted == 0);
    // A step of which only a trial stage is beyond the border becomes shorter; the run goes on.
    const Result border = solve(method, undefined_over_half, {.t_end = -1.0, .y0 = 0.49});
    CHECK(border.status == Status::finished);
    const Result beyond = solve(method, undefined_over_half, {.t_end = 1.0, .y0 = 0.4});
    CHECK(beyond.status == Status::non_finite);
    CHECK(beyond.y == doctest::Approx(0.5).epsilon(1e-6));
  });
}

TEST_CASE("a fixed step that is not finite, or too short for its time, ends the run") {
  const auto check = [](const Result& result, const Result& infinite, const Result& late) {
    CHECK(result.status == Status::non_finite);
    CHECK(result.t < 1.0);
    CHECK(infinite.status == Status::non_finite);
    CHECK(std::isfinite(infinite.y));
    CHECK(late.status == Status::step_too_small);
    CHECK(late.t == 1e17);
  };
  const Request request{.t_end = 2.0, .step = 0.125};
  const Request late{.t0 = 1e17, .t_end = 1e17 + 1e6, .step = 0.01};
  for_each_method([&](const MethodInfo& method) {
    check(solve(method, undefined_from_one, request), solve(method, infinite_from_one, request),
          solve(method, growing, late));
  });
  check(by_classical_4<undefined_from_one>(request), by_classical_4<infinite_from_one>(request),
        by_classical_4<growing>(late));
}

TEST_CASE("the cap on steps is exact") {
  for_each_adaptive_method([](const MethodInfo& method) {
    const Request request{.t_end = 100.0, .tolerance = 1e-10, .max_steps = 37};
    const Result capped = solve(method, growing, request);
    CHECK(capped.status == Status::max_steps);
    CHECK(capped.statistics.accepted + capped.statistics.rejected == 37);
  });
}
