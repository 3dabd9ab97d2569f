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
  static constexpr std::size_t least = 5;
  static constexpr std::size_t most = 9;
  static constexpr std::size_t powers = 12;  ///< of a polynomial: filled with zeros to whole packs
  using Numbers = std::array<double, most>;
  using Polynomial = std::array<double, powers>;  ///< coefficients in theta, from theta^0 on

  /// The weights of the values at the points before a point in the integral up to it, and in the
  /// integral of that.
  struct Sums {
    double theta = 0.0;
    Numbers once{}, twice{};
  };

  std::size_t count;
  Numbers theta{};
  std::array<Sums, most + 1> sums{};  ///< up to each point, and then up to the end from them all
  /// For each point the double integral of the polynomial that is 1 there and 0 at all others.
  std::array<Polynomial, most> twice_at{};

  static_assert(most + 2 <= powers && powers % 4 == 0);

  explicit LobattoPoints(std::span<const double> points);

 private:
  void weigh_earlier(std::span<const double> earlier);
};

/// So many points, from 5 to 9. Throws std::invalid_argument for any other number.
const LobattoPoints& lobatto_points(int count);

}  // namespace pendcore
