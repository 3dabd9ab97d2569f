/// \file
/// What the laws of effects see, and what they add to (effects/laws.hpp has the contract). A chain
/// of one or two links is a single row in registers; a longer chain is in arrays. In lanes, three
/// and four links are a row in registers, too (ensemble/few_links_in_lanes.hpp).
#pragma once

#include "arithmetic/dual.hpp"

namespace pendcore {

/// If each lane of a row is a trajectory of its own, the time is a pack, too.
template <class V, class Time = double>
struct RowAt {
  using Value = V;

  V q, qd, s, c, L;  // packs first, so that no padding parts them
  Time t;
  Time pivot_vx{}, pivot_vy{};  ///< m/s

  PENDCORE_INLINE V phi() const { return q - before(q); }
  PENDCORE_INLINE V phid() const { return qd - before(qd); }
  PENDCORE_INLINE V length() const { return L; }
  PENDCORE_INLINE V vx() const { return Constants<V>::of(pivot_vx) - before(L * qd * s); }
  PENDCORE_INLINE V vy() const { return Constants<V>::of(pivot_vy) + before(L * qd * c); }
};

/// Adds to `pull`, what gravity gives each link alone, what the motion of the pivot gives it:
/// a (xdd_0 sin q - ydd_0 cos q)/A, with moment = a/A.
template <class Effects, class V, class Time>
PENDCORE_INLINE void add_pivot(const Effects& effects, const V& moment, RowAt<V, Time>& at,
                               V& pull) {
  if (effects.pivots.empty()) return;
  Time x, y;
  effects.pivot_acceleration(at.t, x, y);
  pull = fma(moment, Constants<V>::of(x) * at.s - Constants<V>::of(y) * at.c, pull);
  if (effects.has_forces) effects.pivot_velocity(at.t, at.pivot_vx, at.pivot_vy);
}

/// What laws see of three and four links in lanes: the velocities of their joints are sums over all
/// links before.
template <class V, class Time>
struct RowOfLinksAt {
  using Value = V;

  V q, qd, s, c, L;
  Time t;
  V vx_of_joint, vy_of_joint;  ///< m/s

  PENDCORE_INLINE V phi() const { return q - before(q); }
  PENDCORE_INLINE V phid() const { return qd - before(qd); }
  PENDCORE_INLINE V length() const { return L; }
  PENDCORE_INLINE V vx() const { return vx_of_joint; }
  PENDCORE_INLINE V vy() const { return vy_of_joint; }
};

template <class V>
struct RowLoads {
  V couples = Constants<V>::of(0.0);
  V moments = Constants<V>::of(0.0);
  V fx = Constants<V>::of(0.0);
  V fy = Constants<V>::of(0.0);

  PENDCORE_INLINE void couple(const V& tau) { couples = couples + tau; }
  PENDCORE_INLINE void generalised(const V& Q) { moments = moments + Q; }
  PENDCORE_INLINE void force(const V& moment, const V& x, const V& y) {
    moments = moments + moment;
    fx = fx + x;
    fy = fy + y;
  }

  /// What the couples add to Q_i: tau_i - tau_{i+1}.
  PENDCORE_INLINE V torque_of_couples() const { return couples - after(couples); }
  /// What the forces on the link after this one add: L_i n_i . F.
  template <class At>
  PENDCORE_INLINE V torque_of_forces(const At& at) const {
    return at.L * fma(at.c, after(fy), -(at.s * after(fx)));
  }
};

/// Arrays over the links; q and qd have zeros before and after them.
template <class Number>
struct ArraysOver {
  const Number *q, *qd, *s, *c;
  const double* length;
  const Number *vx, *vy;
};
using LinkArrays = ArraysOver<double>;

template <class Row>
struct RowInArrays {
  using Value = Row;
  using Links = ArraysOver<typename Lanes<Row>::Number>;

  Row q, qd, s, c;
  double t;
  int i;  ///< the first link of the row, from 0
  Links links;

  PENDCORE_INLINE RowInArrays(const Links& arrays, double time, int row)
      : q(load<Row>(arrays.q + row * Lanes<Row>::width)),
        qd(load<Row>(arrays.qd + row * Lanes<Row>::width)),
        s(load<Row>(arrays.s + row * Lanes<Row>::width)),
        c(load<Row>(arrays.c + row * Lanes<Row>::width)),
        t(time),
        i(row * Lanes<Row>::width),
        links(arrays) {}

  PENDCORE_INLINE Row phi() const { return q - before_of(q, links.q); }
  PENDCORE_INLINE Row phid() const { return qd - before_of(qd, links.qd); }
  PENDCORE_INLINE Row length() const { return load<Row>(links.length + i); }
  PENDCORE_INLINE Row vx() const { return load<Row>(links.vx + i); }
  PENDCORE_INLINE Row vy() const { return load<Row>(links.vy + i); }

 private:
  template <class Number>
  PENDCORE_INLINE Row before_of(const Row& x, const Number* array) const {
    return i == 0 ? before(x) : load<Row>(array + i - 1);
  }
};

}  // namespace pendcore
