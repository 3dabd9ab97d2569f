// An arm with a damper and a motor: accelerations, joint forces and energies at three times.
#include <cstdio>
#include <pendcore/pendcore.hpp>

int main() {
  const auto rod = pendcore::Link::uniform_rod(1.0, 1.0);  // kg, m
  const pendcore::Scene scene{.links = {rod, rod},
                              .gravity = 9.81,
                              .effects = {pendcore::ViscousJoint{.joint = 1, .damping = 0.1},
                                          pendcore::Motor{.joint = 2, .constant = 0.5}}};
  pendcore::Options options;
  options.method = "dop853";
  options.rtol = 1e-10;
  options.atol = 1e-12;
  options.ledger = true;
  const pendcore::Solution run =
      pendcore::simulate(scene, {0.8, 1.0}, {0.0, 0.0}, 0.0, 5.0, options);
  if (run.status != pendcore::Status::finished) {
    std::fprintf(stderr, "%s\n", run.message.c_str());
    return 1;
  }

  pendcore::Equations equations(scene);  // once, for any number of states
  for (const double t : {0.0, 2.5, 5.0}) {
    const auto [time, q, qd, accounts] = run.at(t);                  // accounts: viscous, motor
    const pendcore::Vector qdd = equations.accelerations(t, q, qd);  // rad/s^2
    const pendcore::Points forces = equations.reactions(t, q, qd);   // N; a row for each joint
    const double energy =
        pendcore::kinetic_energy(scene, t, q, qd) + pendcore::potential_energy(scene, t, q);
    std::printf("%.1f s: qdd %8.4f %8.4f, F_01 %8.4f %8.4f, T + V %9.5f J, motor %8.5f J\n", t,
                qdd(0), qdd(1), forces(0, 0), forces(0, 1), energy, accounts(1));
  }
}
