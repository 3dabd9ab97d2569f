/// \file
/// The points of Lobatto quadratures on [0, 1], and integrals of polynomials through values there.
///
/// Both ends are points. With so many points in all, polynomials of a degree up to twice that
/// number less 3 are integrated exactly over the whole interval.
///
/// Source: Abramowitz and Stegun, Handbook of Mathematical Functions (1964), 25.4.32.
#pragma once

#include <array>
#include <cstddef>
#include <span>

namespace pendcore {

struct LobattoPoints {
  static constexpr std::size_t most = 9;
  static constexpr std::size_t divisions = 6;
  using Numbers = std::array<double, most>;
  using Polynomial = std::array<double, most>;  ///< coefficients in theta, that of theta^0 first

  std::size_t count;
  Numbers theta{};
  /// For each point, the weights of the values at all points in the integral up to it.
  std::array<Numbers, most> of_all{};
  /// The same with the values at the points before it alone, and those of the double integral.
  std::array<Numbers, most> of_earlier{}, twice_of_earlier{};

  /// The weights of the values at all points in the integral up to theta, and in its integral.
  struct Within {
    double theta;
    Numbers once, twice;
  };
  Within at(double share) const;
  std::array<Within, divisions + 1> equal_parts{};  ///< at 0, 1/6, ... 1

  explicit LobattoPoints(std::span<const double> points);

 private:
  void weigh_earlier(std::span<const double> earlier, std::size_t i);

  /// For each point the integral of the polynomial that is 1 there and 0 at all others.
  std::array<Polynomial, most> once_{}, twice_{};
};

/// So many points, from 5 to 9. Throws std::invalid_argument for any other number.
const LobattoPoints& lobatto_points(int count);

}  // namespace pendcore
