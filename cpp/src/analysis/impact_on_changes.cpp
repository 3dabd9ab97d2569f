#include "analysis/impact_on_changes.hpp"

#include <algorithm>
#include <cmath>
#include <Eigen/LU>
#include <limits>

#include "arithmetic/epsilon.hpp"
#include "dynamics/kinematics.hpp"
#include "scene/effects_of_scene.hpp"
#include "text/message.hpp"

namespace pendcore {

ImpactOnChanges::ImpactOnChanges(const VariationalEquations& equations)
    : equations_(equations),
      n_(equations.links()),
      k_(static_cast<Eigen::Index>(equations.names().size())),
      forces_(JointForces::on_free_joints(equations.scene(), locked_joints(equations.scene()))) {}

/// The torques in the joints that a change of the mass matrix calls for, -d(M) x, a column for each
/// name.
Matrix ImpactOnChanges::torques_of_changed_mass(const Numbers& q, const Vector& x,
                                                const Matrix& changes) {
  Matrix torques = Matrix::Zero(n_, k_);  // first on links, then in joints
  for (int i = 0; i < n_; ++i) {
    for (int j = 0; j < n_; ++j) {
      if (i == j) continue;
      const double sine = forces_.sine[i] * forces_.cosine[j] - forces_.cosine[i] * forces_.sine[j];
      torques.row(i) +=
          forces_.inertia.coupling(i, j) * sine * x[j] * (changes.row(i) - changes.row(j));
    }
  }
  for (int j = n_ - 1; j-- > 0;) torques.row(j) += torques.row(j + 1);
  const Vector rest = Vector::Zero(n_);
  for (std::size_t p = 0; p < equations_.parameters().size(); ++p) {
    const std::size_t lane_of_it = p % parameters_at_once;
    if (lane_of_it == 0) {
      Mechanism<AlongParameters> of_mass = equations_.mechanisms()[p / parameters_at_once];
      of_mass.effects.clear();
      of_mass.gravity = {};
      of_mass_.compute(of_mass, 0.0, q, rest, x);
    }
    for (int j = 0; j < n_; ++j) {
      torques(j, equations_.parameters()[p].column) -=
          lane(of_mass_.torques()[j].slope, static_cast<int>(lane_of_it));
    }
  }
  return torques;
}

void refuse_name(const std::string& name, double t, const std::string& why, Eigen::Index column,
                 Matrix& changes, std::string& told) {
  if (!changes.col(column).allFinite()) return;
  changes.col(column).setConstant(std::numeric_limits<double>::quiet_NaN());
  told.append(told.empty() ? "" : "; ")
      .append("sensitivities: none by \"" + name + "\" after t = " + text(t) + " s: " + why);
}

std::string ImpactOnChanges::strike(const WatchedChange& change, Matrix& changes,
                                    std::string& told) {
  const double* const q = change.after.data();
  const double* const before = change.before.data() + n_;
  const double* const after = change.after.data() + n_;
  const HeldJoints& joints = *equations_.equations().held_joints;
  const Vector x = View(after, n_) - View(before, n_);
  forces_.set_mass_matrix(q);
  forces_.set_up();
  Vector impulses = forces_.mass * x;
  for (int j = n_ - 1; j-- > 0;) impulses[j] += impulses[j + 1];
  const auto m = static_cast<Eigen::Index>(forces_.joints.size());
  double hardest = 0.0;
  for (const int j : forces_.joints) {
    if (joints.contact(j, q) != Side::none) hardest = std::max(hardest, std::abs(impulses[j]));
  }

  std::vector<Eigen::Index> acting;  // rows among the joints that no lock holds
  std::vector<double> restitution;
  std::string strikes;
  const double little =
      rounding_of_rates * largest(x) +
      16.0 * epsilon * std::max(largest(View(before, n_)), joints.natural_speed());
  for (Eigen::Index r = 0; r < m; ++r) {
    const int j = forces_.joints[r];
    if (joints.contact(j, q) == Side::none) continue;
    const double rate = relative(after, j + 1);
    if (std::abs(relative(before, j + 1)) > little && joints.into(j, q, before) > 0.0) {
      if (!strikes.empty()) return strikes + " and " + joint_name(j) + " reach their stops at once";
      strikes = joint_name(j);
    }
    if (std::abs(impulses[j]) > rounding_of_rates * hardest) {
      acting.push_back(r);
      const double e = joints.supports()[j].stop(joints.contact(j, q)).restitution;
      restitution.push_back(rate == 0.0 ? 0.0 : e);
    } else if (std::abs(rate) <= little) {
      return joint_name(j) + " is at its stop, which only just pushes";
    }
  }
  const auto count = static_cast<Eigen::Index>(acting.size());
  Matrix W(count, count);
  for (Eigen::Index a = 0; a < count; ++a) {
    for (Eigen::Index b = 0; b < count; ++b) W(a, b) = forces_.problem.W(acting[a], acting[b]);
  }
  const auto solver = W.partialPivLu();
  const auto with_impulses = [&](Vector torques, const Vector& wanted) {
    const Vector more = solver.solve(wanted);
    for (Eigen::Index a = 0; a < count; ++a) torques[acting[a]] += more[a];
    return forces_.response(torques);
  };
  Vector wanted(count);
  for (Eigen::Index a = 0; a < count; ++a) {
    wanted[a] = -(1.0 + restitution[a]) * relative(before, forces_.joints[acting[a]] + 1);
  }
  if (largest(with_impulses(Vector::Zero(m), wanted) - x) > little) {
    return "several impacts follow each other at once";
  }

  const Matrix torques = torques_of_changed_mass(View(q, n_), x, changes);
  std::vector<Vector> by_restitution(acting.size(), Vector::Zero(k_));
  for (Eigen::Index a = 0; a < count; ++a) {
    const int j = forces_.joints[acting[a]];
    const Side side = joints.contact(j, q);
    const Stop& stop = joints.supports()[j].stop(side);
    for (const auto& one : equations_.parameters()) {
      const double slope = one.supports[j].stop(side).restitution;
      if (slope == 0.0) continue;
      if (stop.restitution == 0.0) {
        refuse_name(equations_.names()[one.column], change.t,
                    "the restitution of " + joint_name(j) + " is 0, and can only grow", one.column,
                    changes, told);
      }
      if (restitution[a] != 0.0) by_restitution[a][one.column] = slope;
    }
  }
  for (Eigen::Index column = 0; column < k_; ++column) {
    const Vector rates = changes.col(column).tail(n_);
    Vector given(m);
    for (Eigen::Index r = 0; r < m; ++r) given[r] = torques(forces_.joints[r], column);
    const Vector meanwhile = forces_.response(given);
    for (Eigen::Index a = 0; a < count; ++a) {
      const int joint = forces_.joints[acting[a]] + 1;
      wanted[a] = -(1.0 + restitution[a]) * relative(rates.data(), joint) -
                  by_restitution[a][column] * relative(before, joint) -
                  relative(meanwhile.data(), joint);
    }
    changes.col(column).tail(n_) += with_impulses(given, wanted);
  }
  return {};
}

}  // namespace pendcore
