/// \file
/// A pivot that is moved along a given path (x_0(t), y_0(t)): the equations hold in its frame with
///
///     g -> (-xdd_0, g - ydd_0)
///
/// for gravity. The path is a sinusoid for each axis or a natural cubic spline through points; its
/// velocity and acceleration are the exact derivatives. Source: d'Alembert's principle. The drive
/// of the pivot has the power F_01 . v_0.
#pragma once

#include "pendcore/effects/hooks.hpp"

namespace pendcore {

/// Position (m), velocity (m/s) and acceleration (m/s^2) along x and y.
struct PivotMotion {
  double position[2] = {0.0, 0.0};
  double velocity[2] = {0.0, 0.0};
  double acceleration[2] = {0.0, 0.0};
};

struct DrivenPivot {
  std::optional<Sinusoid> x = {};
  std::optional<Sinusoid> y = {};
  std::optional<Spline> spline = {};

  static constexpr EffectInfo info{
      .name = "DrivenPivot",
      .kind = "driven_pivot",
      .sentence = "A pivot that is moved: a sinusoid for each axis, or a spline.",
      .law = "x_0 = A_x sin(omega_x t + phase_x),  y_0 likewise;  or natural cubic splines",
      .source = "d'Alembert's principle",
      .account = Account::drive,
      .depends_on_time = true,
      .moves_pivot = true,
      .has_series = true,
      .examples =
          "DrivenPivot(y=Sinusoid(amplitude=0.02, angular_frequency=90.0))\n"
          "DrivenPivot(spline=Spline(t=(0.0, 1.0, 2.0), x=(0.0, 0.3, 0.0), y=(0.0, 0.0, 0.1)))",
      .outcome = "drive: -0.484 J"};
  static constexpr Hooks hooks{
      .modes = true, .next_time = true, .span = true, .compiled = true, .check = true};
  static constexpr auto parameters = std::tuple{
      parameter(&DrivenPivot::x,
                {.name = "x", .symbol = "x_0", .unit = "m", .sentence = "motion to the right"}),
      parameter(&DrivenPivot::y,
                {.name = "y", .symbol = "y_0", .unit = "m", .sentence = "motion downward"}),
      parameter(&DrivenPivot::spline, {.name = "spline",
                                       .symbol = "",
                                       .unit = "m",
                                       .sentence = "motion along both axes, through given points"}),
  };
  void check(const std::string& where) const;  ///< sinusoids or a spline, not both

  PivotMotion at(double t) const;  ///< for energies, views and the ledger

  /// The acceleration of each axis, in one piece of a spline or for a sinusoid: x'' = held + slope
  /// (t - start) + gain sin(wave).
  struct Law {
    struct Axis {
      double held = 0.0, slope = 0.0;  // the acceleration in a piece
      double velocity = 0.0;           // the velocity at the start of the piece
      double gain = 0.0, swing = 0.0;  // -A omega^2 and A omega
      int wave = 0;
    };
    Axis x, y;
    double start = 0.0;

    template <class Real>
    PENDCORE_INLINE void add_acceleration(double t, const double* sines, Real& ax, Real& ay) const {
      const Real since = t - start;
      ax = ax + fma(Real(x.slope), since, fma(Real(x.gain), Real(sines[x.wave]), Real(x.held)));
      ay = ay + fma(Real(y.slope), since, fma(Real(y.gain), Real(sines[y.wave]), Real(y.held)));
    }
    PENDCORE_INLINE void add_velocity(double t, const double* cosines, double& vx,
                                      double& vy) const {
      const double since = t - start;
      vx += x.velocity + since * fma(0.5 * x.slope, since, x.held) + x.swing * cosines[x.wave];
      vy += y.velocity + since * fma(0.5 * y.slope, since, y.held) + y.swing * cosines[y.wave];
    }
  };

  bool has_modes() const { return spline.has_value(); }
  int mode_at(double t, double phi, double phid, bool forward) const;
  std::vector<Guard> guards(int /*mode*/) const { return {}; }
  int next_mode(int mode, std::size_t /*guard*/) const { return mode; }
  void put_mode(Law& law, int lane, int mode) const;
  DrivenPivot compiled() const;  ///< with the second derivatives of its spline

  double next_time(double t, bool forward) const {
    if (!spline) return forward ? never : -never;
    return next_of(spline->t, t, forward);
  }
  double last_time() const { return spline ? spline->t.back() : never; }
  double first_time() const { return spline ? spline->t.front() : -never; }
};

}  // namespace pendcore
