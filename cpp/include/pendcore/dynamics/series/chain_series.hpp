/// \file
/// The equations of a chain of n links, with smooth effects, as recurrences of Taylor series.
///
/// As in double_pendulum_series.hpp, u_i lies along link i, n_i across it, and u_i' = qd_i n_i. Let
/// a_i be the acceleration of joint i minus gravity, and F_{i+1} the force at the next joint; both
/// are sums of u'':
///
///     a_{i+1} = a_i + L u_i'',    F_i = m a_i + m c u_i'' + F_{i+1},    F_{n+1} = m_p a_{n+1}
///     I_o qdd_i + n_i . H_i = tau_i,   H_i = m c a_i + L F_{i+1}
///
/// The only products are qd_i n_i and n_i . H_i. In order k of the last line, the newest unknown
/// alpha = (k + 1) qd_{k+1} appears along n_0 alone, u''_k = alpha n_0 + beta. So every order is
/// the same linear system, the one of a chain at rest at the angles q_0. It is solved by the
/// recursion of chain.hpp from the tip to the base and back, whose factors are computed once for
/// the whole series:
///
///     F = B a + b + beta_F alpha_before         (B, w, r, s: chain.hpp, here along x and y)
///     alpha = r (tau - L n . p - t - w . a) + s alpha_before,    p = b + L B beta
///
/// The effects are those that have a Couple (effects/law.hpp): polynomials of time, angle and rate,
/// and waves. The source is the one of double_pendulum_series.hpp. Cost: four sums of products and
/// some 40 operations for each link and order; a sine and cosine, a division and some 60 operations
/// for each link and series.
#pragma once

#include <memory>
#include <vector>

#include "pendcore/arithmetic/order_of_series.hpp"
#include "pendcore/dynamics/acting_effects.hpp"
#include "pendcore/dynamics/chain/chain_link.hpp"

namespace pendcore {

/// Computes one series at a time, in one thread, in memory of its own. `Row` is the type of its
/// effects' rows.
template <class Row>
class ChainSeries {
 public:
  using Block = Row;
  static constexpr int blocks = 0;  ///< known at run time only
  static constexpr bool is_short = false;
  static constexpr InstructionSet best = InstructionSet::x86_64_v3;
  static constexpr InstructionSet least = InstructionSet::baseline;
  static constexpr int width = Lanes<Row>::width;

  /// `effects` is null for a chain without effects.
  ChainSeries(const Scene& scene, std::shared_ptr<const ActingEffects<Row>> effects);

  int links() const { return n_; }
  static constexpr bool depends_on_time() { return true; }
  int row() const { return row_; }
  void set_order(int order);

  /// Fills rows 1 .. order of `coefficients`, each (q, qd), both padded to whole blocks, with time
  /// in units of sigma.
  PENDCORE_INLINE void expand(double t, const double* y, double sigma, int order,
                              double* coefficients) const;

 private:
  /// The factors of one link, which are the same for all orders of a series.
  struct Factors {
    double nx, ny;         ///< across the link
    double Bxx, Bxy, Byy;  ///< B of the links beyond
    double fx, fy;         ///< beta_F of the next joint
    double wx, wy, r, s;
  };
  /// What the pass from the tip to the base keeps of one link, for one order.
  struct Passing {
    double bx, by, t, free;
  };

  PENDCORE_INLINE void factor() const;
  PENDCORE_INLINE void start_waves(double t) const;
  PENDCORE_INLINE void advance_waves(double sigma, int k) const;
  PENDCORE_INLINE void pivot_acceleration(double t, double sigma, int k, double& x,
                                          double& y) const;
  PENDCORE_INLINE void add_couples(double t, double sigma, int k) const;
  PENDCORE_INLINE void solve(double ax, double ay) const;

  /// The series of a quantity for a group of links: a row for each order.
  PENDCORE_INLINE double* of(int quantity, int group) const {
    return series_.data() + (static_cast<std::size_t>(group) * quantities + quantity) * room_;
  }
  enum : int { cosine_of, sine_of, rate_of, hx_of, hy_of, relative_of, square_of, quantities };

  int n_;
  int row_;
  int groups_;
  double gravity_;
  double payload_mass_;
  bool has_rotors_ = false;
  std::shared_ptr<const ActingEffects<Row>> effects_;
  std::vector<ChainLink> links_;
  std::vector<double> rotor_;  ///< rotors in joints after the first; rotor_[0] is 0
  // Memory for one series:
  std::size_t room_ = 0;
  mutable std::vector<double> series_;
  mutable std::vector<Factors> factors_;
  mutable std::vector<Passing> passing_;
  mutable std::vector<double> beta_x_, beta_y_, torque_, alpha_, hx_, hy_;
  mutable std::vector<double> couple_, angle_, speed_;  ///< with a margin before and after
  mutable std::vector<double> wave_sine_, wave_cosine_;
};

}  // namespace pendcore
