/// \file
/// The constants of the mass matrix of a chain of n links.
///
///     S_i = m_{i+1} + ... + m_n + m_p    mass beyond link i, kg
///     a_i = m_i c_i + L_i S_i            first moment about joint i, kg m
///     A_ii = I_i + m_i c_i^2 + L_i^2 S_i (+ I_p for i = n)   A_ij = L_min(i,j) a_max(i,j)   kg m^2
///
/// They give T = 1/2 sum_ij A_ij cos(q_i - q_j) qd_i qd_j and V = -g sum_i a_i sin q_i. A rotor J_j
/// in joint j adds J_j to M_jj and M_{j-1,j-1} and -J_j to M_{j,j-1}.
/// Cost: O(n). The scene must have passed check().
/// Every effect that only changes constants (a payload, a rotor's inertia) changes them here.
#pragma once

#include <vector>

#include "pendcore/scene.hpp"

namespace pendcore {

struct LinkInertia {
  double first_moment;  ///< a_i
  double diagonal;      ///< M_ii: A_ii and the rotors
  double length;        ///< L_i
  double rotor;         ///< J_i

  /// What the closed forms divide the equation of the link by: M_ii, or 1 for a link without any
  /// inertia, which a lock turns with another one.
  double divisor() const { return diagonal > 0.0 ? diagonal : 1.0; }
};

struct Inertia {
  std::vector<LinkInertia> links;  ///< (n)
  double payload_mass = 0.0;       ///< m_p
  double payload_inertia = 0.0;    ///< I_p

  explicit Inertia(const Scene& scene);
  double coupling(std::size_t i, std::size_t j) const;  ///< A_ij, i != j, counted from 0
  /// The rotors between two links, (n): 0 and J_2 .. J_n. In a chain, link 1 includes J_1.
  std::vector<double> rotors_between_links() const;
};

}  // namespace pendcore
