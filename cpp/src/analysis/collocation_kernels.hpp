/// \file
/// The kernels of sensitivities.hpp: the linear system of a step, and its solution.
#pragma once

#include <cmath>
#include <utility>

#include "analysis/gauss_collocation.hpp"
#include "arithmetic/pack.hpp"

namespace pendcore {

/// A part of a step, h seconds long, of n angles. A row of names is padded with zeros
/// to whole packs, `width` numbers; a row of the system has its n s coefficients and such a row
/// for the right side, `row` numbers.
struct CollocationStep {
  const GaussCollocation* points;
  int n, width, row;
  double h;
  const double *by_q, *by_qd;  ///< at the points, (s, n, n)
  const double* by_name;       ///< at the points, (s, n, width)
  double* now;                 ///< where the part begins, then where it ends, (2n, width)
  double* system;              ///< (n s, row); then d(dqd)/dt at the points, on its right side
  double* decay;               ///< for each name, (3, width): see decay_of()

  double* right(int i) const {
    return system + static_cast<std::ptrdiff_t>(i) * row + (row - width);
  }
};

/// to += x from, for a row that is whole packs long.
PENDCORE_INLINE void add_row(double x, const double* from, double* to, int length) {
  for (int j = 0; j < length; j += 4) {
    store(to + j, fma(x, load<Pack<4>>(from + j), load<Pack<4>>(to + j)));
  }
}

/// d(dqd)/dt at the points: (1 - h^2 by_q twice - h by_qd once) x = by_q (dq + theta h dqd)
/// + by_qd dqd + by_name.
PENDCORE_INLINE void set_up_system(const CollocationStep& step) {
  const GaussCollocation& points = *step.points;
  const int n = step.n;
  const double* const angles = step.now;
  const double* const rates = step.now + static_cast<std::ptrdiff_t>(n) * step.width;
  for (int i = 0; i < points.s; ++i) {
    const GaussCollocation::Integrals& integrals = points.to_point[i];
    for (int r = 0; r < n; ++r) {
      const double* const of_q = step.by_q + (i * n + r) * n;
      const double* const of_qd = step.by_qd + (i * n + r) * n;
      double* const coefficients = step.system + static_cast<std::ptrdiff_t>(i * n + r) * step.row;
      double* const right = step.right(i * n + r);
      const double* const by_name =
          step.by_name + static_cast<std::ptrdiff_t>(i * n + r) * step.width;
      for (int j = 0; j < step.row - step.width; ++j) coefficients[j] = 0.0;
      for (int j = 0; j < step.width; ++j) right[j] = by_name[j];
      for (int c = 0; c < n; ++c) {
        for (int j = 0; j < points.s; ++j) {
          coefficients[j * n + c] = -(step.h * step.h * integrals.twice[j] * of_q[c] +
                                      step.h * integrals.once[j] * of_qd[c]);
        }
        add_row(of_q[c], angles + c * step.width, right, step.width);
        add_row(points.theta[i] * step.h * of_q[c] + of_qd[c], rates + c * step.width, right,
                step.width);
      }
      coefficients[i * n + r] += 1.0;
    }
  }
}

/// Gauss's elimination with a choice of rows, of the coefficients and the right side together.
PENDCORE_INLINE void solve_system(const CollocationStep& step) {
  const int size = step.n * step.points->s;
  const auto at = [&](int i) __attribute__((always_inline)) {
    return step.system + static_cast<std::ptrdiff_t>(i) * step.row;
  };
  for (int k = 0; k < size; ++k) {
    int pivot = k;
    for (int i = k + 1; i < size; ++i) {
      if (std::abs(at(i)[k]) > std::abs(at(pivot)[k])) pivot = i;
    }
    const int first = k / 4 * 4;
    if (pivot != k) {
      for (int j = first; j < step.row; ++j) std::swap(at(k)[j], at(pivot)[j]);
    }
    const double inverse = 1.0 / at(k)[k];
    for (int i = k + 1; i < size; ++i) {
      const double share = at(i)[k] * inverse;
      if (share != 0.0) add_row(-share, at(k) + first, at(i) + first, step.row - first);
    }
  }
  for (int k = size - 1; k >= 0; --k) {
    double* const solution = step.right(k);
    const double inverse = 1.0 / at(k)[k];
    for (int first = 0; first < step.width; first += 4) {
      Pack<4> x = load<Pack<4>>(solution + first);  // not in memory: each sum waits for the last
      for (int j = k + 1; j < size; ++j) {
        x = fma(-at(k)[j], load<Pack<4>>(step.right(j) + first), x);
      }
      store(solution + first, inverse * x);
    }
  }
}

/// For each name, the largest value of x = d(dqd)/dt at the points, its largest coefficient among
/// Legendre's last two, and among two in the middle.
PENDCORE_INLINE void decay_of(const CollocationStep& step) {
  const GaussCollocation& points = *step.points;
  const int s = points.s;
  const int width = step.width;
  for (int j = 0; j < 3 * width; ++j) step.decay[j] = 0.0;
  for (int r = 0; r < step.n; ++r) {
    for (int first = 0; first < width; first += 4) {
      Pack<4> largest = load<Pack<4>>(step.decay + first);
      Pack<4> coefficients[4]{};
      const int orders[4] = {s - 1, s - 2, s / 2, s / 2 - 1};
      for (int i = 0; i < s; ++i) {
        const Pack<4> x = load<Pack<4>>(step.right(i * step.n + r) + first);
        largest = larger(largest, absolute(x));
        for (int p = 0; p < 4; ++p) {
          coefficients[p] = fma(points.to_legendre(orders[p], i), x, coefficients[p]);
        }
      }
      store(step.decay + first, largest);
      for (int p = 0; p < 4; ++p) {
        double* const to = step.decay + (p < 2 ? 1 : 2) * width + first;
        store(to, larger(load<Pack<4>>(to), absolute(coefficients[p])));
      }
    }
  }
}

PENDCORE_INLINE void solve_step(const CollocationStep* step) {
  set_up_system(*step);
  solve_system(*step);
  decay_of(*step);
}

/// Brings the changes to the end of the part.
PENDCORE_INLINE void end_step(const CollocationStep* step) {
  const GaussCollocation& points = *step->points;
  for (int r = 0; r < step->n; ++r) {
    double* const angle = step->now + static_cast<std::ptrdiff_t>(r) * step->width;
    double* const rate = step->now + static_cast<std::ptrdiff_t>(step->n + r) * step->width;
    for (int first = 0; first < step->width; first += 4) {
      Pack<4> of_rate = load<Pack<4>>(rate + first);
      Pack<4> of_angle = fma(step->h, of_rate, load<Pack<4>>(angle + first));
      for (int i = 0; i < points.s; ++i) {
        const Pack<4> x = load<Pack<4>>(step->right(i * step->n + r) + first);
        of_angle = fma(step->h * step->h * points.to_end.twice[i], x, of_angle);
        of_rate = fma(step->h * points.to_end.once[i], x, of_rate);
      }
      store(angle + first, of_angle);
      store(rate + first, of_rate);
    }
  }
}

}  // namespace pendcore
