// The scenes of the comparison of effects: what each name means in pendcore's terms. There are two
// rods; an effect at a joint is at joint 2 unless said otherwise, so that it reaches both links.
#pragma once

namespace contenders {

inline constexpr double moment = 0.5;                          // s, for laws that depend on time
inline constexpr double damping = 0.1;                         // viscous_joint: N m s/rad
inline constexpr double damping2 = 0.02, damping3 = 0.005;     // viscous_joint_3 has all three
inline constexpr double coulomb = 0.05;                        // dry_joint_friction: N m
inline constexpr double drag_coefficient = 1.2;                // rod_drag, on both links
inline constexpr double diameter = 0.05, air_density = 1.225;  // m, kg/m^3
inline constexpr double stiffness = 5.0, rest_angle = 0.2;     // torsional_spring
inline constexpr double torque = 0.5;                          // motor_constant: N m
inline constexpr double angular_frequency = 3.0, phase = 0.4;  // motor_sinusoid, with this torque
inline constexpr double kp = 5.0, kd = 0.5, reference = 0.3;   // motor_pd,
inline constexpr double limit = 100.0;                         // never reached
inline constexpr double armature = 0.05;                       // rotor_inertia: kg m^2
inline constexpr double payload_mass = 0.5, payload_inertia = 0.0;  // payload
inline constexpr double drive = 0.01, drive_frequency = 20.0;       // driven_pivot: m, rad/s
inline constexpr double bound = 50.0;                               // joint_limit: rad, not reached
inline constexpr double user_damping = 0.1;                         // user: on the rate of link 2

}  // namespace contenders
