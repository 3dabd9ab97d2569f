// What C++ users give and get: vectors of any kind, tolerances, states of a run, its continuation,
// effects of their own.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "pendcore/pendcore.hpp"

using namespace pendcore;

namespace {

double first_of(const Numbers& numbers) { return numbers(0); }

Solution run_of(double t_end, Options options = {}) {
  return simulate(Scene::textbook(), {0.7, 1.1}, {0.0, 0.3}, 0.0, t_end, std::move(options));
}

}  // namespace

TEST_CASE(
    "a vector of any kind is seen where it stands, and only gaps and expressions are copied") {
  const std::vector<double> numbers = {3.0, 4.0};
  const Eigen::Vector2d fixed(3.0, 4.0);
  const Eigen::MatrixXd columns = Eigen::MatrixXd::Constant(2, 2, 3.0);
  const std::array<double, 2> pair = {3.0, 4.0};
  CHECK(Numbers(numbers).data() == numbers.data());
  CHECK(Numbers(pair).data() == pair.data());
  CHECK(Numbers(fixed).data() == fixed.data());
  CHECK(Numbers(columns.col(1)).data() == columns.data() + 2);
  CHECK(first_of({3.0, 4.0}) == 3.0);
  CHECK(first_of(std::span(numbers).last(1)) == 4.0);
  CHECK(first_of(2.0 * fixed) == 6.0);
  CHECK(first_of(columns.row(0).transpose()) == 3.0);
}

TEST_CASE("tolerances and times are given as a number or a vector of any kind") {
  const Solution one = run_of(1.0, {.rtol = 1e-6});
  CHECK(one.options.rtol == Tolerance{1e-6});
  CHECK(fingerprint(run_of(1.0, {.rtol = {1e-6, 1e-6, 1e-6, 1e-6}})) == fingerprint(one));
  CHECK_THROWS_WITH(run_of(1.0, {.rtol = {1e-6, 1e-6, 1e-6}}),
                    "rtol: has 3 numbers: must have 1, or 4 (q_1 .. q_n, qd_1 .. qd_n)");
  const Eigen::Vector4d each(1e-6, 1e-7, 1e-8, 1e-9);
  const Tolerance listed = {1e-6, 1e-7, 1e-8, 1e-9};
  CHECK(Tolerance(each) == listed);
  CHECK(Tolerance(2.0 * each).back() == 2e-9);
  CHECK(Tolerance(std::array{1e-6, 1e-7, 1e-8, 1e-9}) == listed);
  const Solution run = run_of(1.0, {.rtol = each, .t_eval = Eigen::Vector3d::LinSpaced(0.0, 1.0)});
  CHECK(run.options.rtol == listed);
  CHECK(run.t == std::vector{0.0, 0.5, 1.0});
  CHECK(run.t == run_of(1.0, {.t_eval = std::array{0.0, 0.5, 1.0}}).t);
  const Solution longer = resume(Scene::textbook(), run, 3.0, Eigen::Vector2d(2.0, 3.0));
  CHECK(longer.t == std::vector{0.0, 0.5, 1.0, 2.0, 3.0});
}

TEST_CASE("a kind of event is an event that ends no run") {
  const events::LinkAngle down{.link = 1, .value = 1.5};
  const Solution run = run_of(2.0, {.events = {down, {.function = down, .terminal = 2}}});
  REQUIRE(run.found.size() == 4);
  CHECK(run.status == Status::event);
  CHECK(run.found[2].t == run.t.back());
  CHECK(std::abs(run.found[2].y[0] - 1.5) < 1e-12);
}

TEST_CASE("what is read of a solution that nobody keeps is a copy") {
  const Solution run = run_of(1.0);
  const auto end = run_of(1.0).back();
  const auto begin = run_of(1.0)[0];
  const auto q = run_of(1.0).q();
  static_assert(std::is_same_v<decltype(end), const State>);
  static_assert(std::is_same_v<decltype(begin), const State>);
  static_assert(std::is_same_v<decltype(q), const Matrix>);
  static_assert(std::is_same_v<decltype(run_of(1.0).qd()), Matrix>);
  static_assert(!std::is_convertible_v<State, StateView>);
  CHECK(end.q == run.back().q);
  CHECK(begin.qd == run[0].qd);
  CHECK(q == run.q());
}

TEST_CASE("every way to read a run reads the same states") {
  Scene scene = Scene::textbook();
  scene.effects = {ViscousJoint{.joint = 2, .damping = 0.1}};
  const Solution run = simulate(scene, {0.7, 1.1}, {0.0, 0.3}, 0.0, 2.0, {.ledger = true});
  REQUIRE(run.t.size() > 5);
  const Matrix sampled = run.sample(run.t);
  for (std::size_t i = 0; i < run.t.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    const State at = run.at(run.t[i]);
    CHECK(run[i].t == run.t[i]);
    for (const Vector& q :
         {Vector(run[i].q), Vector(run.q().row(row)), Vector(sampled.row(row).head(2))}) {
      CHECK(q == at.q);
    }
    CHECK(run[i].qd == at.qd);
    CHECK(run.qd().row(row).transpose() == at.qd);
    CHECK(run[i].accounts == at.accounts);
    CHECK(sampled(row, 4) == at.accounts(0));
  }
  CHECK(run.back().q == run[run.t.size() - 1].q);
  CHECK_THROWS_WITH(run[run.t.size()], doctest::Contains("this solution keeps "));
  CHECK_THROWS_AS(Solution().back(), std::out_of_range);
}

TEST_CASE("equations at a state are those of a run, and of each other") {
  const Scene scene = Scene::textbook();
  Equations equations(scene);
  const Vector q = Eigen::Vector2d(0.7, 1.1);
  const Vector qd = Eigen::Vector2d(0.4, -0.3);
  const Vector qdd = equations.accelerations(0.0, q, qd);
  CHECK(accelerations(scene, 0.0, q, qd) == qdd);
  const double across = std::sin(q(0) - q(1));  // Eqs. (2.9)-(2.11): A_12 = m_2 L_1 c_2 = 0.5
  const Eigen::Vector2d h(0.5 * across * qd(1) * qd(1), -0.5 * across * qd(0) * qd(0));
  const Eigen::Vector2d weight(1.5 * scene.gravity * std::cos(q(0)),
                               0.5 * scene.gravity * std::cos(q(1)));
  const Matrix M = equations.mass_matrix(q);
  CHECK((M.lazyProduct(qdd) + h - weight).cwiseAbs().maxCoeff() < 1e-14);
  const double step = 1e-6;
  const Derivatives exact = equations.jacobian(0.0, q, qd);
  for (Eigen::Index j = 0; j < 2; ++j) {
    const Vector along = step * Eigen::Vector2d::Unit(j);
    const Vector by_q = (equations.accelerations(0.0, q + along, qd) -
                         equations.accelerations(0.0, q - along, qd)) /
                        (2.0 * step);
    CHECK((exact.by_q.col(j) - by_q).cwiseAbs().maxCoeff() < 1e-8);
  }
  const Linearization close =
      equations.linearize(0.0, q, qd, {{.joint = 2}, {.kind = Input::Kind::pivot_y}});
  CHECK(close.drift.tail(2) == qdd);
  CHECK(close.A.bottomLeftCorner(2, 2) == exact.by_q);
  CHECK((M.lazyProduct(close.B.col(0).tail(2)) - Eigen::Vector2d(-1.0, 1.0)).norm() < 1e-14);
  // The pivot's acceleration is less gravity.
  CHECK((M.lazyProduct(close.B.col(1).tail(2)) + weight / scene.gravity).norm() < 1e-14);
  const Vector torques = equations.inverse_dynamics(0.0, q, qd, qdd + close.B.col(0).tail(2));
  CHECK((torques - Eigen::Vector2d(0.0, 1.0)).norm() < 1e-13);
  CHECK_THROWS_WITH(equations.linearize(0.0, q, qd, {{.joint = 3}}),
                    doctest::Contains("must be one of the joints 1 to 2"));
  CHECK_THROWS_WITH(equations.accelerations(0.0, {1.0}, qd), "q: has 1 numbers: must have 2");
  Scene heavier = scene;
  heavier.links[1].mass = -1.0;
  CHECK_THROWS_WITH(Equations{heavier}, doctest::Contains("link 2: mass = -1.0"));
}

TEST_CASE("mass centres accelerate with the pivot, along their links and across them") {
  Scene scene = Scene::textbook();
  const Sinusoid wave{.amplitude = 0.5, .angular_frequency = 2.0, .phase = 0.5 * M_PI};
  scene.effects = {DrivenPivot{.x = wave}};  // accelerates by -2 m/s^2 at t = 0
  // u_1 = (1, 0), n_1 = (0, 1), u_2 = (0, 1), n_2 = (-1, 0)
  const Points found =
      mass_center_accelerations(scene, 0.0, {0.0, 0.5 * M_PI}, {2.0, 3.0}, {5.0, 7.0});
  Points wanted(2, 2);
  wanted << -2.0 - 0.5 * 4.0, 0.5 * 5.0,        // a_P0 + c_1 (qdd_1 n_1 - qd_1^2 u_1)
      -2.0 - 4.0 - 0.5 * 7.0, 5.0 - 0.5 * 9.0;  // a_P1 + c_2 (qdd_2 n_2 - qd_2^2 u_2)
  CHECK((found - wanted).cwiseAbs().maxCoeff() < 1e-14);
}

TEST_CASE("a refused start is told in no language's words") {
  const double inf = std::numeric_limits<double>::infinity();
  CHECK_THROWS_WITH(run_of(inf), "end of the run = inf: must be finite (s)");
  CHECK_THROWS_WITH(run_of(1.0, {.t_eval = {2.0}}),
                    "t_eval[0] = 2.0: must be within the run, 0.0 to 1.0 s");
  CHECK_THROWS_WITH(simulate(Scene::textbook(), {0.1}, {0.0, 0.0}, 0.0, 1.0),
                    "q0: has 1 numbers: must have 2, one for each link");
  Scene stopped = Scene::textbook();
  stopped.effects = {DryJointFriction{.joint = 1, .coulomb = 0.1}};
  CHECK_THROWS_WITH(simulate(stopped, {0.1, 0.2}, {0.0, 0.0}, 1.0, 0.0),
                    doctest::Contains("the run goes backward: effect 1 (dry_joint_friction): "));
}

TEST_CASE("a number that is left out and has no default is refused by its name") {
  Scene scene = Scene::textbook();
  const auto check_refused = [&](const Effect& effect, const std::string& message) {
    scene.effects = {effect};
    CHECK_THROWS_WITH(check(scene), doctest::Contains(("effect 1 (" + message).c_str()));
  };
  check_refused(ViscousJoint{.joint = 2},
                "viscous_joint): damping = nan: must be finite (N m s/rad)");
  check_refused(ViscousJoint{.damping = 0.1},
                "viscous_joint): joint = 0: must be a whole number, 1 or more");
  check_refused(JointStop{.joint = 1},
                "joint_stop): range[0] = nan: must be a number; -inf or inf for none (rad)");
  check_refused(Motor{.joint = 1, .sinusoid = Sinusoid{.amplitude = 2.0}},
                "motor): sinusoid.angular_frequency = nan: must be finite (rad/s)");
  for_each_kind([&](const auto& nothing) { check_refused(nothing, ""); });
  scene.effects.clear();
  scene.links[0] = {.mass = 1.0, .length = 1.0, .inertia = 0.1};
  CHECK_THROWS_WITH(check(scene), doctest::Contains("link 1: center = nan: must be finite (m, "));
}

TEST_CASE("a run goes on with its own scene, and with no other") {
  const Solution run = run_of(1.0);
  const Scene scene = Scene::textbook();
  CHECK(fingerprint(resume(scene, run, 2.0)) == fingerprint(run_of(2.0)));
  Scene longer = scene, heavier = scene, damped = scene;
  longer.links.push_back(Link::uniform_rod(1.0, 1.0));
  heavier.links[1].mass = 1.5;
  damped.effects = {ViscousJoint{.joint = 1, .damping = 0.1}};
  for (const auto& [other, what] : {std::pair(longer, "has 3 links, and the solution has 2: must"),
                                    {heavier, "link[2].mass = 1.5, and the solution has 1.0: must"},
                                    {damped, "has other effects than the solution: must"}}) {
    const std::string message = std::string("scene: ") + what + " be the scene of the solution";
    CHECK_THROWS_WITH(resume(other, run, 2.0), message.c_str());
  }
  CHECK_THROWS_WITH(resume(scene, Solution(), 2.0),
                    "solution: is empty: must be what simulate() or resume() returned");
}

namespace {

using Row = std::span<const double>;

Solution run_with(std::size_t n, std::vector<Effect> effects) {
  const Scene scene{.links = std::vector<Link>(n, Link::uniform_rod(1.0, 1.0)),
                    .effects = std::move(effects)};
  return simulate(scene, std::vector<double>(n, 0.4), std::vector<double>(n, 1.0), 0.0, 2.0,
                  {.rtol = 1e-12, .atol = 1e-13});
}

}  // namespace

TEST_CASE("a callable acts as the effect that it computes, whatever the number of links") {
  const double damping = 0.3;
  auto damp = [&](double, Row, Row qd, std::span<double> Q) { Q[0] -= damping * qd[0]; };
  for (const std::size_t n : {1, 2, 3, 5}) {
    const Solution own = run_with(n, {CompiledUser::of(damp)});
    const Solution built_in = run_with(n, {ViscousJoint{.joint = 1, .damping = damping}});
    REQUIRE(own.status == Status::finished);
    for (std::size_t i = 0; i < 2 * n; ++i) {
      CHECK(own.y_reached[i] == doctest::Approx(built_in.y_reached[i]).epsilon(1e-10));
    }
    CHECK(run_with(n, {}).y_reached[0] != doctest::Approx(own.y_reached[0]).epsilon(1e-3));
  }
}

TEST_CASE("an exception in a callable ends the run and is kept with what was computed") {
  for (const double limit : {1.0, -1.0}) {
    auto fail = [&](double t, Row, Row, std::span<double>) {
      if (t > limit) throw std::runtime_error("out of reach");
    };
    const Solution solution = run_with(2, {CompiledUser::of(fail)});
    CHECK(solution.status == Status::callback_error);
    CHECK(solution.t_reached >= (limit > 0.0 ? 0.5 : 0.0));
    CHECK(solution.t_reached <= std::max(limit, 0.0));
    CHECK_THROWS_WITH(std::rethrow_exception(solution.error), "out of reach");
  }
}
