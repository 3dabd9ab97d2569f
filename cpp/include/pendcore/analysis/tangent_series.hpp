/// \file
/// The Taylor series of a motion and of small changes of its state: the variational equations of
/// lyapunov.hpp, to any order.
///
/// The coefficients of a change are the derivatives of the coefficients of the motion along it. So
/// the recurrences of the motion, on dual numbers, give both.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "pendcore/arithmetic/dual.hpp"

namespace pendcore {

/// The rows of a state are (q, dq_1 .. dq_k) and (qd, dqd_1 .. dqd_k), padded to whole blocks.
/// `Equations` is a series of a motion whose expand() takes dual numbers.
template <class Equations>
class TangentSeries {
 public:
  using Block = Pack<4>;
  static constexpr int blocks = 0;  ///< known at run time only
  static constexpr bool is_short = false;
  static constexpr InstructionSet best = InstructionSet::x86_64_v3;
  static constexpr InstructionSet least = InstructionSet::baseline;

  TangentSeries(Equations equations, int count)
      : equations_(std::move(equations)),
        n_(equations_.links()),
        count_(count),
        row_((links() + width - 1) / width * width),
        state_(2 * static_cast<std::size_t>(equations_.row())) {}

  int links() const { return n_ * (1 + count_); }
  int row() const { return row_; }
  bool depends_on_time() const { return equations_.depends_on_time(); }
  void set_order(int order) {
    equations_.set_order(order);
    series_.resize((static_cast<std::size_t>(order) + 1) * state_.size());
  }

  /// Fills rows 1 .. order of `coefficients`, with time in units of sigma.
  PENDCORE_INLINE void expand(double t, const double* y, double sigma, int order,
                              double* coefficients) const {
    const int room = equations_.row();
    for (int change = n_; change < links(); change += n_) {
      for (int i = 0; i < n_; ++i) {
        state_[i] = {y[i], y[change + i]};
        state_[room + i] = {y[row_ + i], y[row_ + change + i]};
      }
      equations_.expand(t, state_.data(), sigma, order, series_.data());
      for (int k = 1; k <= order; ++k) {
        const Dual<double>* const from = &series_[static_cast<std::size_t>(k) * state_.size()];
        double* const to = coefficients + static_cast<std::ptrdiff_t>(k) * 2 * row_;
        for (int i = 0; i < n_; ++i) {
          to[i] = from[i].value;
          to[row_ + i] = from[room + i].value;
          to[change + i] = from[i].slope;
          to[row_ + change + i] = from[room + i].slope;
        }
      }
    }
  }

 private:
  static constexpr int width = Lanes<Block>::width;

  Equations equations_;
  int n_;
  int count_;
  int row_;
  mutable std::vector<Dual<double>> state_, series_;  ///< of the motion and one change
};

}  // namespace pendcore
