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
/// A trajectory alone takes its links in rows, as its effects do. With a trajectory in each lane
/// (ensemble/), a row is one link, and the same operations on it have the same bits.
///
/// The effects are those that have a Couple (effects/couples.hpp): polynomials of time, angle and
/// rate, and waves. The source is the one of double_pendulum_series.hpp. Cost: four sums of
/// products and some 40 operations for each link and order; a sine and cosine, a division and some
/// 60 operations for each link and series.
#pragma once

#include <memory>
#include <type_traits>
#include <vector>

#include "arithmetic/order_of_series.hpp"
#include "arithmetic/rows_in_memory.hpp"
#include "dynamics/chain/chain_link.hpp"
#include "dynamics/effects_in_rows.hpp"
#include "dynamics/mechanism.hpp"

namespace pendcore {

/// The constants of the links: those of chain_link.hpp, and the rotors between links.
template <class Number>
class ConstantsOfChain {
  static constexpr std::ptrdiff_t each = 9;

 public:
  explicit ConstantsOfChain(int links) : links_(links) { numbers_.assign(count()); }
  explicit ConstantsOfChain(const Scene& scene)
    requires(std::is_same_v<Number, double>)
      : ConstantsOfChain(static_cast<int>(scene.links.size())) {
    const Inertia inertia(scene);
    const std::vector<double> rotors = inertia.rotors_between_links();
    int i = 0;
    for (const ChainLink& k : chain_links(scene, inertia)) {
      set_link(i, k, rotors[i]);
      ++i;
    }
    numbers_.set(each * links_, scene.gravity);
    numbers_.set(each * links_ + 1, inertia.payload_mass);
  }
  explicit ConstantsOfChain(const Mechanism<Number>& of)
    requires(!std::is_same_v<Number, double>)
      : ConstantsOfChain(static_cast<int>(of.bodies.size())) {
    for (int i = 0; i < links_; ++i) {
      const auto& body = of.bodies[i];
      const Number I = i + 1 < links_ ? body.inertia : body.inertia + of.payload_inertia;
      ChainLinkOf<Number> k = chain_link(body.mass, body.length, body.center, I);
      if (i == 0) k.Io += body.armature;
      set_link(i, k, i == 0 ? Number{} : body.armature);
    }
    numbers_.set(each * links_, of.gravity);
    numbers_.set(each * links_ + 1, of.payload_mass);
  }
  /// Puts the constants of one trajectory into a lane.
  void put(int lane, const ConstantsOfChain<double>& one) {
    for (std::ptrdiff_t i = 0; i < count(); ++i) numbers_.put(i, lane, one.number(i));
  }

  int links() const { return links_; }
  PENDCORE_INLINE ChainLinkOf<Number> link(int i) const {
    const auto number = [this, i](int k)
                            __attribute__((always_inline)) { return numbers_[each * i + k]; };
    return {number(0), number(1), number(2), number(3), number(4), number(5), number(6), number(7)};
  }
  PENDCORE_INLINE Number rotor(int i) const { return numbers_[each * i + 8]; }
  PENDCORE_INLINE Number gravity() const { return numbers_[each * links_]; }
  PENDCORE_INLINE Number payload_mass() const { return numbers_[each * links_ + 1]; }
  PENDCORE_INLINE Number number(std::ptrdiff_t i) const { return numbers_[i]; }
  /// Whether there are rotors between links.
  bool has_rotors() const {
    for (int i = 0; i < links_; ++i) {
      if (!is_zero(rotor(i))) return true;
    }
    return false;
  }

 private:
  std::ptrdiff_t count() const { return each * links_ + 2; }
  void set_link(int i, const ChainLinkOf<Number>& k, const Number& rotor) {
    std::ptrdiff_t at = each * i;
    for (const Number& x : {k.m, k.L, k.mc, k.I, k.Io, k.LL, k.turn, k.across, rotor}) {
      numbers_.set(at++, x);
    }
  }
  int links_;
  RowsInMemory<Number, Number> numbers_;
};

/// Computes one series at a time, in one thread, in memory of its own. `Row` is the type of the
/// effects' rows; `Effects` are EffectsInRows, EffectsInLanes with a trajectory in each lane, or
/// EffectsWithSlopes.
template <class Row, class Effects = EffectsInRows<Row>>
class ChainSeries {
 public:
  using Number = typename Effects::Number;
  using Time = ConstantOf<Number>;
  using Block = Row;
  static constexpr int blocks = 0;  ///< known at run time only
  static constexpr bool is_short = false;
  static constexpr Sets sets = usual_sets;
  static constexpr int places = RowsInMemory<Row, Number>::places;

  /// All trajectories have rotors between their links, or none has. `effects` are null for a chain
  /// without effects.
  ChainSeries(ConstantsOfChain<Number> constants, std::shared_ptr<const Effects> effects);

  int links() const { return n_; }
  static constexpr bool depends_on_time() { return true; }
  int row() const { return row_; }
  void set_order(int order);

  ConstantsOfChain<Number>& constants() { return constants_; }

  /// Fills rows 1 .. order of `coefficients`, each (q, qd), both padded to whole rows, with time in
  /// units of sigma.
  PENDCORE_INLINE void expand(const Time& t, const Number* y, const Time& sigma, int order,
                              Number* coefficients) const;

 private:
  using Rows = RowsInMemory<Row, Number>;
  /// The factors of one link, which are the same for all orders of a series. The alignment is set
  /// for the same reason as that of Couples (effects/couples.hpp).
  struct alignas(sizeof(Number)) Factors {
    Number nx, ny;         ///< across the link
    Number Bxx, Bxy, Byy;  ///< B of the links beyond
    Number fx, fy;         ///< beta_F of the next joint
    Number wx, wy, r, s;
  };
  /// What the pass from the tip to the base keeps of one link, for one order.
  struct alignas(sizeof(Number)) Passing {
    Number bx, by, t, free;
  };

  PENDCORE_INLINE void factor() const;
  PENDCORE_INLINE void advance_waves(const Time& sigma, int k) const;
  PENDCORE_INLINE void pivot_acceleration(const Time& t, const Time& sigma, int k, Number& x,
                                          Number& y) const;
  PENDCORE_INLINE void add_couples(const Time& t, const Time& sigma, int k) const;
  PENDCORE_INLINE void solve(Number ax, Number ay) const;

  enum Quantity : int {
    cosine_of,
    sine_of,
    rate_of,
    hx_of,
    hy_of,
    relative_of,
    square_of,
    quantities
  };
  /// Where the series of a quantity for a group of links has its row for an order.
  PENDCORE_INLINE std::ptrdiff_t at(Quantity quantity, int group, int order) const {
    return (static_cast<std::ptrdiff_t>(group) * quantities + quantity) * room_ +
           static_cast<std::ptrdiff_t>(order) * places;
  }
  PENDCORE_INLINE Row order_of(Quantity quantity, int group, int order) const {
    return series_.row(at(quantity, group, order));
  }
  PENDCORE_INLINE void set_order_of(Quantity quantity, int group, int order, const Row& x) const {
    series_.set_row(at(quantity, group, order), x);
  }
  /// The number of link i in order 0.
  PENDCORE_INLINE Number order_zero_of(Quantity quantity, int i) const {
    return series_[at(quantity, i / places, 0) + i % places];
  }

  int n_;
  int row_;
  int groups_;
  ConstantsOfChain<Number> constants_;
  bool has_rotors_;
  std::shared_ptr<const Effects> effects_;
  // Memory for one series:
  std::ptrdiff_t room_ = 0;
  mutable Rows series_;
  mutable std::vector<Factors> factors_;
  mutable std::vector<Passing> passing_;
  mutable Rows beta_x_, beta_y_, torque_, alpha_, hx_, hy_;
  mutable Rows couple_, angle_, speed_;  ///< with a margin before and after
};

}  // namespace pendcore
