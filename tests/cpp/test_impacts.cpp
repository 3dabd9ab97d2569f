// Impacts at several stops at once, by the hundred thousand: the properties that each must have.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include "dynamics/kinematics.hpp"
#include "pendcore/effects/joint_stop.hpp"
#include "simulate/switching.hpp"

using namespace pendcore;

namespace {

using Row = std::vector<double>;

/// Rods whose joints are all at a stop and have any rates.
struct Drawn {
  Scene scene{.links = {}, .gravity = 9.81};
  Row q, phid;
  std::vector<int> sides;  ///< -1 at the lower stop, 1 at the upper one

  int n() const { return static_cast<int>(sides.size()); }
  const JointStop& stop(int j) const { return *scene.effects[j].get_if<JointStop>(); }
};

Drawn draw(int n, std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  auto between = [&](double low, double high) { return low + (high - low) * unit(random); };
  Drawn drawn;
  double capture = 0.0;
  for (int j = 0; j < n; ++j) {
    drawn.scene.links.push_back(Link::uniform_rod(between(0.05, 3.0), between(0.1, 1.5)));
    drawn.q.push_back((j > 0 ? drawn.q[j - 1] : 0.0) + between(-2.0, 2.0));
    const double phi = relative(drawn.q.data(), j + 1);
    drawn.sides.push_back(unit(random) < 0.5 ? -1 : 1);
    drawn.phid.push_back(unit(random) < 0.2 ? 0.0 : between(-5.0, 5.0));
    const double rather = between(-0.3, 1.3);  // clamped to 0 or 1 in three of eight draws
    if (j == 0 || unit(random) < 0.7) capture = std::pow(10.0, between(-6.0, 2.0));
    const bool is_lower = drawn.sides[j] < 0;
    drawn.scene.effects.emplace_back(
        JointStop{.joint = j + 1,
                  .range = {is_lower ? phi : phi - 1.0, is_lower ? phi + 1.0 : phi},
                  .restitution = std::clamp(rather, 0.0, 1.0),
                  .capture_speed = unit(random) < 0.2 ? 0.0 : capture});
  }
  return drawn;
}

Row links(const Row& of_joints) {
  Row sum(of_joints.size());
  std::partial_sum(of_joints.begin(), of_joints.end(), sum.begin());
  return sum;
}

/// Uniform rods: A_ij = L_i a_j for i < j, A_ii = m L^2/3 + L^2 (all the mass beyond).
double kinetic_energy(const Drawn& drawn, const Row& phid) {
  const std::vector<Link>& rods = drawn.scene.links;
  const Row qd = links(phid);
  long double sum = 0.0;
  for (std::size_t i = 0; i < rods.size(); ++i) {
    long double beyond = 0.0;
    for (std::size_t k = i + 1; k < rods.size(); ++k) beyond += rods[k].mass;
    const long double L = rods[i].length;
    sum += (rods[i].mass / 3.0L + beyond) * L * L * qd[i] * qd[i];
    const long double a = (rods[i].mass / 2.0L + beyond) * L;
    for (std::size_t k = 0; k < i; ++k) {
      sum += 2.0L * rods[k].length * a * std::cos(drawn.q[i] - drawn.q[k]) * qd[i] * qd[k];
    }
  }
  return static_cast<double>(sum / 2.0L);
}

struct Struck {
  Row phid;     ///< after the impact
  double loss;  ///< the ledger's entry
  bool jumped;
};

Struck strike(const Drawn& drawn) {
  const int n = drawn.n();
  const EquationsOfMotion equations = equations_of_motion(drawn.scene);
  Switching switching(drawn.scene, equations, {Account::impact});
  Row y(drawn.q);
  const Row qd = links(drawn.phid);
  y.insert(y.end(), qd.begin(), qd.end());
  y.push_back(0.0);
  const bool jumped = switching.begin(0.0, y.data(), true);
  REQUIRE_FALSE(switching.is_over());
  Struck struck{.phid = Row(n), .loss = y.back(), .jumped = jumped};
  for (int j = 0; j < n; ++j) struck.phid[j] = relative(y.data() + n, j + 1);
  return struck;
}

}  // namespace

TEST_CASE("no impact adds energy or leads out of a stop, whatever restitutions and captures") {
  std::mt19937_64 random(20240607);
  int jumps = 0, captures = 0;
  for (int i = 0; i < 100'000; ++i) {
    Drawn drawn = draw(1 + i % 6, random);
    const Struck struck = strike(drawn);
    const double before = kinetic_energy(drawn, drawn.phid);
    const double lost = before - kinetic_energy(drawn, struck.phid);
    const double rounding = 1e-11 * before;  // for ill-conditioned mass matrices
    jumps += struck.jumped ? 1 : 0;
    bool was_captured = false;
    bool is_right = struck.loss >= 0.0 && std::abs(struck.loss - lost) <= rounding;
    for (int j = 0; j < drawn.n(); ++j) {
      is_right = is_right && -drawn.sides[j] * struck.phid[j] >= 0.0;
      was_captured |= struck.phid[j] == 0.0 && drawn.stop(j).restitution > 0.0;
    }
    captures += was_captured ? 1 : 0;
    CAPTURE(i);
    if (!is_right) CHECK(is_right);
  }
  CHECK(jumps > 70'000);
  CHECK(captures > 10'000);
}
