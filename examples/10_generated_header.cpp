// The equations of an arm as C++ of its own. 10_generated_header.hpp was written by
//
//     pendcore derive 10_generated_header.toml --to cpp -o 10_generated_header.hpp
//
// and needs nothing but the standard library: `g++ -std=c++17` compiles this. It swings
// the arm in fixed steps, as a controller would, and books the energy. Prints the same
// as its Python twin.
#include "10_generated_header.hpp"

#include <cstdio>

using Arm = pendulum::Chain;

// What is integrated: the state, and the energy that the effects brought in.
struct Point {
  Arm::State y;
  double work;
};

Point moved(const Point& from, const Point& rate, double h) {
  Point to = from;
  for (std::size_t i = 0; i < to.y.size(); ++i) to.y[i] += h * rate.y[i];
  to.work += h * rate.work;
  return to;
}

Point rate(const Arm& arm, double t, const Point& p) {
  const Arm::Angles q{p.y[0], p.y[1]}, qd{p.y[2], p.y[3]};
  return {arm.right_hand_side(t, p.y), arm.powers(t, q, qd).total()};
}

// A step of the classical Runge-Kutta method.
Point stepped(const Arm& arm, double t, const Point& p, double h) {
  const Point a = rate(arm, t, p);
  const Point b = rate(arm, t + h / 2, moved(p, a, h / 2));
  const Point c = rate(arm, t + h / 2, moved(p, b, h / 2));
  const Point d = rate(arm, t + h, moved(p, c, h));
  return moved(moved(moved(moved(p, a, h / 6), b, h / 3), c, h / 3), d, h / 6);
}

int main() {
  const Arm arm;
  const double h = 5e-4;
  const int steps = 10000;
  Point p{{1.2, 1.7, 0.0, 0.0}, 0.0};
  const double before = arm.energy(0.0, {p.y[0], p.y[1]}, {p.y[2], p.y[3]}).total();
  for (int k = 0; k < steps; ++k) p = stepped(arm, k * h, p, h);

  const Arm::Angles q{p.y[0], p.y[1]}, qd{p.y[2], p.y[3]};
  const auto force = arm.reactions(steps * h, q, qd);
  std::printf("q(5) = %.7f, %.7f rad\n", q[0], q[1]);
  std::printf("F_01 = (%.6f, %.6f) N, ", force[0].x, force[0].y);
  std::printf("F_12 = (%.6f, %.6f) N\n", force[1].x, force[1].y);
  const double gained = arm.energy(steps * h, q, qd).total() - before;
  std::printf("energy gained %.6f J, ", gained);
  std::printf("brought in by motor and damper %.6f J\n", p.work);
}
