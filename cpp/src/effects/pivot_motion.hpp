/// \file
/// How the pivot of a scene moves at one time.
#pragma once

namespace pendcore {

/// Position (m), velocity (m/s) and acceleration (m/s^2) along x and y.
struct PivotMotion {
  double position[2] = {0.0, 0.0};
  double velocity[2] = {0.0, 0.0};
  double acceleration[2] = {0.0, 0.0};
};

}  // namespace pendcore
