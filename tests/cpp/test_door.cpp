// What C++ users give and get: vectors of any kind, tolerances, states of a run, its continuation.
#include <doctest/doctest.h>
#include <array>
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
  CHECK(Numbers(numbers).data() == numbers.data());
  CHECK(Numbers(fixed).data() == fixed.data());
  CHECK(Numbers(columns.col(1)).data() == columns.data() + 2);
  CHECK(first_of({3.0, 4.0}) == 3.0);
  CHECK(first_of(std::span(numbers).last(1)) == 4.0);
  CHECK(first_of(2.0 * fixed) == 6.0);
  CHECK(first_of(columns.row(0).transpose()) == 3.0);
}

TEST_CASE("one tolerance stands for all components") {
  Options options;
  options.rtol = 1e-6;
  CHECK(options.rtol == Tolerance{1e-6});
  const Solution one = run_of(1.0, options);
  options.rtol = {1e-6, 1e-6, 1e-6, 1e-6};
  CHECK(fingerprint(run_of(1.0, options)) == fingerprint(one));
  options.rtol = {1e-6, 1e-6, 1e-6};
  CHECK_THROWS_WITH(run_of(1.0, options),
                    "rtol: has 3 numbers: must have 1, or 4 (q_1 .. q_n, qd_1 .. qd_n)");
}

TEST_CASE("every way to read a run reads the same states") {
  Options options;
  options.ledger = true;
  Scene scene = Scene::textbook();
  scene.effects = {ViscousJoint{.joint = 2, .damping = 0.1}};
  const Solution run = simulate(scene, {0.7, 1.1}, {0.0, 0.3}, 0.0, 2.0, options);
  REQUIRE(run.t.size() > 5);
  const Matrix sampled = run.sample(run.t);
  for (std::size_t i = 0; i < run.t.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    const State at = run.at(run.t[i]);
    CHECK(run[i].t == run.t[i]);
    CHECK(run[i].q == run.q().row(row).transpose());
    CHECK(run[i].qd == run.qd().row(row).transpose());
    CHECK(run[i].q == at.q);
    CHECK(run[i].qd == at.qd);
    CHECK(run[i].accounts == at.accounts);
    CHECK(sampled.row(row).head(2).transpose() == at.q);
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
  CHECK_THROWS_WITH(equations.accelerations(0.0, {1.0}, qd), "q: has 1 numbers: must have 2");
  Scene heavier = scene;
  heavier.links[1].mass = -1.0;
  CHECK_THROWS_WITH(Equations{heavier}, doctest::Contains("link 2: mass = -1.0"));
}

TEST_CASE("a run goes on with its own scene, and with no other number of links") {
  const Solution run = run_of(1.0);
  const Scene scene = Scene::textbook();
  CHECK(fingerprint(resume(scene, run, 2.0)) == fingerprint(run_of(2.0)));
  Scene longer = scene;
  longer.links.push_back(Link::uniform_rod(1.0, 1.0));
  CHECK_THROWS_WITH(
      resume(longer, run, 2.0),
      "scene: has 3 links, and the solution has 2: must be the scene of the solution");
  CHECK_THROWS_WITH(resume(scene, Solution(), 2.0),
                    "solution: is empty: must be what simulate() or resume() returned");
}
