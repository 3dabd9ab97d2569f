/// \file
/// A double pendulum: right-hand side, joint reactions, energies. Needs nothing but C++17.
///
/// Written by pendcore 0.1.0 (pendcore.derive, SymPy 1.14.0) from
///
///     Scene(links=(Link(mass=2.0, length=0.4), Link(mass=1.2, length=0.35, center=0.15,
///     inertia=0.014)), gravity=9.81, effects=(ViscousJoint(joint=1, damping=0.15),
///     TorsionalSpring(joint=2, stiffness=4.0, rest_angle=0.5), Motor(joint=1,
///     sinusoid=Sinusoid(amplitude=6.0, angular_frequency=3.0)), Payload(mass=0.5)))
///
/// The textbook's section 2.1, for any chain: Newton's and Euler's equations of every link,
/// its joint forces eliminated, solved for the angular accelerations.
///
/// x points right, y points DOWN, the origin is the pivot. q_i is the absolute angle of
/// link i, from +x towards +y: 0 is horizontal, pi/2 hangs straight down. Units are SI: kg,
/// m, s, rad, N, J.
///
/// M qdd = f are the equations of motion, M11 and f1 entries of both; D1, l21, h1, a2 come
/// from elimination, M = L D L^T. cos_q1_q2 is the cosine of q1 - q2; e1, e2, ... are what
/// several lines share.
///
///     M(q) qdd = f(t, q, qd)          M the mass matrix (2 x 2), kg m^2; f in N m
///     y = (q_1 .. q_n, qd_1 .. qd_n)  the state, 2n numbers: dy/dt = (qd, qdd)
///
/// Cost: 5 sines and cosines, 68 other operations a right-hand side.
/// Nothing is allocated and nothing thrown; angles and rates that are not finite give NaN.
///
///     pendulum::Chain chain;
///     auto dydt = chain.right_hand_side(t, y);   // with the scene's numbers
///     chain.m1 = 2.0;
///     chain(y, dydt, t);                         // with others; as Boost.odeint calls a system
#pragma once

// clang-format off: written by a program, and again when the scene changes

#include <array>
#include <cmath>
#include <cstddef>

namespace pendulum {

struct Chain {
  double m1 = 2.0;       ///< mass of link 1, kg
  double m2 = 1.2;       ///< mass of link 2, kg
  double L1 = 0.4;       ///< length of link 1, m
  double L2 = 0.35;      ///< length of link 2, m
  /// distance of the mass centre of link 2 from the joint where it begins, m
  double c2 = 0.15;
  double I_C2 = 0.014;   ///< moment of inertia of link 2 about its mass centre, kg m^2
  double g = 9.81;       ///< acceleration of gravity, m/s^2
  double b_1 = 0.15;     ///< linear damping of joint 1, N m s/rad
  double k_2 = 4.0;      ///< stiffness at joint 2, N m/rad
  double phi0_2 = 0.5;   ///< angle of joint 2 at which its spring is at rest, rad
  double tauM_1 = 6.0;   ///< amplitude of torque of the motor at joint 1, N m
  double Omega_1 = 3.0;  ///< angular frequency of torque of the motor at joint 1, rad/s
  double m_p = 0.5;      ///< mass of the payload, kg

  static constexpr std::size_t links = 2;
  using Angles = std::array<double, links>;     ///< a number for each link
  using State = std::array<double, 2 * links>;  ///< q_1 .. q_n, rad; qd_1 .. qd_n, rad/s

  struct Force {
    double x, y;  ///< N; x right, y down
  };
  struct Energy {
    double kinetic;    ///< J
    double potential;  ///< J; 0 at the height of the origin
    double total() const { return kinetic + potential; }
  };

  /// Power that each effect brings into the chain, W; negative where it takes energy.
  struct Powers {
    /// ViscousJoint(joint=1, damping=0.15)
    double viscous_joint_1;
    /// Motor(joint=1, sinusoid=Sinusoid(amplitude=6.0, angular_frequency=3.0))
    double motor_1;
    /// The rate at which kinetic + potential energy grows.
    double total() const {
      return viscous_joint_1 + motor_1;
    }
  };

  /// dy/dt of the state y.
  State right_hand_side(double t, const State& y) const {
    Angles q{}, qd{};
    for (std::size_t i = 0; i < links; ++i) {
      q[i] = y[i];
      qd[i] = y[links + i];
    }
    const Angles qdd = accelerations(t, q, qd);
    State dydt{};
    for (std::size_t i = 0; i < links; ++i) {
      dydt[i] = qd[i];
      dydt[links + i] = qdd[i];
    }
    return dydt;
  }

  /// The same as Boost.odeint and others call it.
  void operator()(const State& y, State& dydt, double t) const { dydt = right_hand_side(t, y); }

  /// Angular accelerations of the links, rad/s^2.
  Angles accelerations(double t, const Angles& q, const Angles& qd) const {
    const double q1 = q[0], q2 = q[1];
    const double qd1 = qd[0], qd2 = qd[1];
    const double sin_Omega_1_t = std::sin(Omega_1*t);
    // torque at joint 1, N m
    const double tau1 = -b_1*qd1 + sin_Omega_1_t*tauM_1;
    // torque at joint 2, N m
    const double tau2 = -k_2*(-phi0_2 - q1 + q2);
    const double e0 = square(L1);
    const double M11 = (1.0/3.0)*e0*m1 + e0*m2 + e0*m_p;
    const double cos_q1_q2 = std::cos(q1 - q2);
    const double e1 = L1*cos_q1_q2;
    const double e2 = L2*m_p;
    const double e3 = c2*m2;
    const double M12 = e1*e2 + e1*e3;
    const double M22 = I_C2 + square(L2)*m_p + square(c2)*m2;
    const double cos_q1 = std::cos(q1);
    const double e4 = L1*cos_q1*g;
    const double sin_q1_q2 = std::sin(q1 - q2);
    const double e5 = L1*sin_q1_q2;
    const double e6 = e5*square(qd2);
    const double f1 = -e2*e6 - e3*e6 + (1.0/2.0)*e4*m1 + e4*m2 + e4*m_p + tau1 - tau2;
    const double cos_q2 = std::cos(q2);
    const double e7 = cos_q2*g;
    const double e8 = e5*square(qd1);
    const double f2 = e2*e7 + e2*e8 + e3*e7 + e3*e8 + tau2;
    const double e9 = std::pow(M11, -1);
    const double l21 = M12*e9;
    const double D2 = -M11*square(l21) + M22;
    const double h2 = -f1*l21 + f2;
    const double a2 = h2/D2;
    return Angles{{
        -a2*l21 + e9*f1,
        a2,
    }};
  }

  /// Force on each link where it begins: F_01, of the ground on link 1, then F_12, of link 1
  /// on link 2, and so on.
  std::array<Force, links> reactions(double t, const Angles& q, const Angles& qd) const {
    const Angles qdd = accelerations(t, q, qd);
    const double q1 = q[0], q2 = q[1];
    const double qd1 = qd[0], qd2 = qd[1];
    const double qdd1 = qdd[0], qdd2 = qdd[1];
    const double e0 = square(qd1);
    const double cos_q1 = std::cos(q1);
    const double e1 = cos_q1*e0;
    const double e2 = square(qd2);
    const double cos_q2 = std::cos(q2);
    const double e3 = cos_q2*e2;
    const double sin_q1 = std::sin(q1);
    const double e4 = qdd1*sin_q1;
    const double e5 = L1*m2;
    const double e6 = L1*m_p;
    const double e7 = L2*m_p;
    const double sin_q2 = std::sin(q2);
    const double e8 = qdd2*sin_q2;
    const double e9 = c2*m2;
    const double e10 = e1*e5 + e1*e6 + e3*e7 + e3*e9 + e4*e5 + e4*e6 + e7*e8 + e8*e9;
    const double e11 = (1.0/2.0)*L1*m1;
    const double e12 = e0*sin_q1;
    const double e13 = e2*sin_q2;
    const double e14 = -L1*cos_q1*m2*qdd1 - L1*cos_q1*m_p*qdd1 - L2*cos_q2*m_p*qdd2 -
        c2*cos_q2*m2*qdd2 + e12*e5 + e12*e6 + e13*e7 + e13*e9 + g*m2 + g*m_p;
    return std::array<Force, links>{{
        Force{-e1*e11 - e10 - e11*e4, (1.0/2.0)*L1*cos_q1*m1*qdd1 - e11*e12 - e14 - g*m1},
        Force{-e10, -e14},
    }};
  }

  /// Kinetic and potential energy of the chain.
  Energy energy(double /*t*/, const Angles& q, const Angles& qd) const {
    const double q1 = q[0], q2 = q[1];
    const double qd1 = qd[0], qd2 = qd[1];
    const double e0 = (1.0/2.0)*square(qd2);
    const double cos_q1_q2 = std::cos(q1 - q2);
    const double e1 = L1*cos_q1_q2*qd1*qd2;
    const double e2 = square(L1)*square(qd1);
    const double e3 = (1.0/2.0)*e2;
    const double e4 = g*m2;
    const double sin_q1 = std::sin(q1);
    const double e5 = L1*sin_q1;
    const double e6 = g*m_p;
    const double sin_q2 = std::sin(q2);
    return Energy{
        I_C2*e0 + square(L2)*e0*m_p + L2*e1*m_p + square(c2)*e0*m2 + c2*e1*m2 + (1.0/6.0)*e2*m1 +
            e3*m2 + e3*m_p,
        -L2*e6*sin_q2 - c2*e4*sin_q2 - e4*e5 - e5*e6 - 1.0/2.0*e5*g*m1 +
            (1.0/2.0)*k_2*square(-phi0_2 - q1 + q2),
    };
  }

  /// Power of each effect.
  Powers powers(double t, const Angles& /*q*/, const Angles& qd) const {
    const double qd1 = qd[0];
    const double sin_Omega_1_t = std::sin(Omega_1*t);
    return Powers{
        -b_1*square(qd1),
        qd1*sin_Omega_1_t*tauM_1,
    };
  }
 private:
  static double square(double x) { return x * x; }
  static double cube(double x) { return x * x * x; }
};

}  // namespace pendulum
