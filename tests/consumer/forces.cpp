// An arm with a damper and a motor: accelerations, joint forces and energies at three times.
#include <cstdio>
#include <pendcore/pendcore.hpp>
#include <span>
#include <vector>

int main() {
  const auto rod = pendcore::Link::uniform_rod(1.0, 1.0);  // kg, m
  const pendcore::Scene scene{.links = {rod, rod},
                              .gravity = 9.81,
                              .effects = {pendcore::ViscousJoint{.joint = 1, .damping = 0.1},
                                          pendcore::Motor{.joint = 2, .constant = 0.5}}};
  pendcore::Options options;
  options.method = "dop853";
  options.rtol = {1e-10};  // in braces: one number, or one for each angle and each rate
  options.atol = {1e-12};
  options.ledger = true;
  const pendcore::Solution run =
      pendcore::simulate(scene, {0.8, 1.0}, {0.0, 0.0}, 0.0, 5.0, options);
  if (run.status != pendcore::Status::finished) {
    std::fprintf(stderr, "%s\n", run.message.c_str());
    return 1;
  }

  const auto equations = pendcore::equations_of_motion(scene);  // once, for any number of states
  const std::vector<double> times = {0.0, 2.5, 5.0};
  const std::vector<double> rows = run.at(times);
  for (std::size_t k = 0; k < times.size(); ++k) {
    const double t = times[k];
    const double* row = rows.data() + k * run.dimension;  // q_1, q_2, qd_1, qd_2, viscous, motor
    const std::span q(row, 2), qd(row + 2, 2);
    double qdd[2], forces[4];  // rad/s^2; F_01 and F_12, x and y (down), N
    pendcore::accelerations(equations, t, q.data(), qd.data(), qdd);
    pendcore::reactions(scene, t, q, qd, qdd, forces);
    const double energy =
        pendcore::kinetic_energy(scene, t, q, qd) + pendcore::potential_energy(scene, t, q);
    std::printf("%.1f s: qdd %8.4f %8.4f, F_01 %8.4f %8.4f, T + V %9.5f J, motor %8.5f J\n", t,
                qdd[0], qdd[1], forces[0], forces[1], energy, row[5]);
  }
}
