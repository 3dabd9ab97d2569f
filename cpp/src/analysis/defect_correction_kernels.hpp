/// \file
/// The kernels of defect_correction.hpp: what is summed at every point of every step.
#pragma once

#include <array>
#include <span>

#include "analysis/curve_of_step.hpp"
#include "analysis/lobatto_points.hpp"

namespace pendcore {

/// A neighbour in a step.
struct CorrectionState {
  std::size_t n, width;
  std::vector<double> e_q, e_qd;   ///< the errors of the curve where the step begins, (width)
  std::vector<double> y;           ///< the curve at the points but the first one, (., 2 width)
  std::vector<double> r;           ///< (points, 2 width); only the second half of a row is used
  std::vector<double> q, qd, qdd;  ///< at a point, (width)
  std::vector<double> e_q_at_end, e_qd_at_end;  ///< the errors where the step ends, (width)

  CorrectionState(std::size_t links, std::size_t points) : n(links), width(padded(links)) {
    for (auto* one : {&e_q, &e_qd, &q, &qd, &qdd, &e_q_at_end, &e_qd_at_end}) one->resize(width);
    y.resize((points - 1) * 2 * width);
    r.resize(points * 2 * width);
  }
  double* r_at(std::size_t point) { return &r[(2 * point + 1) * width]; }
  const double* r_at(std::size_t point) const { return &r[(2 * point + 1) * width]; }
};

/// Begins a step, which spans `size` in theta and h in seconds, with all that needs no new
/// right-hand side. The one at the first point, in qdd, is the last one of the step before; the
/// state there lacked only what the last point itself added to the error.
template <std::size_t count>
PENDCORE_INLINE void begin_step(const LobattoPoints& points, const CurveOfStep& curve, double size,
                                double h, CorrectionState& state) {
  const std::size_t width = curve.width;
  for (std::size_t k = 0; k < width; ++k) {
    state.r_at(0)[k] = h * state.qdd[k] - size * curve.powers[3 * width + k];
  }
  std::array<double, count - 1> theta;
  for (std::size_t i = 1; i < count; ++i) theta[i - 1] = points.theta[i] * size;
  evaluate_curve(curve, theta, -size, state.y.data(), &state.r[2 * width]);
}

/// Goes on with the right-hand side in qdd, at the point before i: sets q and qd at point i, or the
/// errors at the end, if i is the number of points.
PENDCORE_INLINE void advance_to_point(const LobattoPoints& points, std::size_t i, double h,
                                      CorrectionState& state) {
  with_row_for(state.n, [&, i, h]<class Row>() __attribute__((always_inline)) {
    const std::size_t width = state.width;
    const LobattoPoints::Sums& to = points.sums[i];
    for (std::size_t k = 0; k < width; k += Lanes<Row>::width) {
      const Row e_qd = load<Row>(&state.e_qd[k]);
      Row rate = e_qd;
      Row angle = to.theta * e_qd;
      for (std::size_t j = 0; j + 1 < i; ++j) {
        const Row r = load<Row>(state.r_at(j) + k);
        rate = fma(to.once[j], r, rate);
        angle = fma(to.twice[j], r, angle);
      }
      double* const last = state.r_at(i - 1) + k;
      Row r = load<Row>(last);
      if (i > 1) {
        r = fma(h, load<Row>(&state.qdd[k]), r);
        store(last, r);
      }
      rate = fma(to.once[i - 1], r, rate);
      angle = fma(to.twice[i - 1], r, angle);
      angle = fma(h, angle, load<Row>(&state.e_q[k]));
      if (i < points.count) {
        const double* const curve = &state.y[2 * (i - 1) * width + k];
        store(&state.q[k], Row(load<Row>(curve) + angle));
        store(&state.qd[k], Row(load<Row>(curve + width) + rate));
      } else {
        store(&state.e_q_at_end[k], angle);
        store(&state.e_qd_at_end[k], rate);
      }
    }
  });
}

/// The polynomials of the errors of the curve's angles in the step, (n), of length h, s.
PENDCORE_INLINE void error_polynomials(const LobattoPoints& points, double h,
                                       const CorrectionState& state,
                                       LobattoPoints::Polynomial* polynomials) {
  constexpr int packs = LobattoPoints::powers / 4;
  for (std::size_t link = 0; link < state.n; ++link) {
    Pack<4> sum[packs]{};
    set_lane(sum[0], 0, state.e_q[link]);
    set_lane(sum[0], 1, h * state.e_qd[link]);
    for (std::size_t j = 0; j < points.count; ++j) {
      const double r = h * state.r_at(j)[link];
      for (int p = 0; p < packs; ++p) {
        sum[p] = fma(r, load<Pack<4>>(&points.twice_at[j][4 * p]), sum[p]);
      }
    }
    for (int p = 0; p < packs; ++p) store(&polynomials[link][4 * p], sum[p]);
  }
}

/// Errors of the run's angles within a step.
struct ErrorsWithin {
  const CurveOfStep* curve;
  double size;  ///< in theta, 1 unless an event ends the step
  std::span<const LobattoPoints::Polynomial* const> polynomials;  ///< of each neighbour, (n)
  std::span<const double> theta;                                  ///< as shares of the size
  double* errors;                                                 ///< (theta, neighbours, n)
};

/// Computes them for four theta at a time.
PENDCORE_INLINE void errors_within(const ErrorsWithin& wanted) {
  const CurveOfStep& curve = *wanted.curve;
  const std::size_t n = curve.n;
  const std::size_t neighbours = wanted.polynomials.size();
  for (std::size_t first = 0; first < wanted.theta.size(); first += 4) {
    const Pack<4> theta = load_links<Pack<4>>(wanted.theta.data(), first, wanted.theta.size());
    const Pack<4> of_step = wanted.size * theta;
    const std::size_t some = std::min<std::size_t>(4, wanted.theta.size() - first);
    for (std::size_t link = 0; link < n; ++link) {
      Pack<4> offset{};
      for (std::size_t p = curve.degree + 1; p-- > 0;) {
        offset =
            fma(of_step, offset, broadcast<Pack<4>>(curve.angle_offset[p * curve.width + link]));
      }
      for (std::size_t k = 0; k < neighbours; ++k) {
        const LobattoPoints::Polynomial& polynomial = wanted.polynomials[k][link];
        Pack<4> error{};
        for (std::size_t p = LobattoPoints::most + 2; p-- > 0;) {
          error = fma(theta, error, broadcast<Pack<4>>(polynomial[p]));
        }
        error = error + offset;
        double* const to = wanted.errors + (first * neighbours + k) * n + link;
        for (std::size_t i = 0; i < some; ++i) {
          to[i * neighbours * n] = lane(error, static_cast<int>(i));
        }
      }
    }
  }
}

/// The beginning of a step with so many points, on this processor.
inline auto begin_step_with(std::size_t points) {
  const std::array all = {fastest<&begin_step<5>>(), fastest<&begin_step<6>>(),
                          fastest<&begin_step<7>>(), fastest<&begin_step<8>>(),
                          fastest<&begin_step<9>>()};
  return all.at(points - LobattoPoints::least);
}

}  // namespace pendcore
