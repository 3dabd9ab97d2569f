/// \file
/// The Taylor series of a motion and of small changes of its state: the variational equations of
/// lyapunov.hpp, to any order.
///
/// The coefficients of a change are the derivatives of the coefficients of the motion along it. So
/// the recurrences of the motion, on dual numbers, give both. Cost: k times that of the motion's
/// series on dual numbers, which has the motion each time.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "arithmetic/dual.hpp"

namespace pendcore {

/// A series as integrate/taylor/taylor_step.hpp takes it, whose links are those of the motion and,
/// for each change, as many more. The rows of a state are (q, dq_1 .. dq_k) and (qd, dqd_1 ..
/// dqd_k), padded to whole blocks with zeros that nothing writes. The expand() of a `Motion` takes
/// dual numbers.
template <class Motion>
class TangentSeries {
 public:
  using Block = Pack<4>;
  static constexpr int blocks = 0;  ///< known at run time only
  static constexpr bool is_short = false;
  static constexpr InstructionSet best = InstructionSet::x86_64_v3;
  static constexpr InstructionSet least = InstructionSet::baseline;

  TangentSeries(Motion motion, int count)
      : motion_(std::move(motion)),
        n_(motion_.links()),
        count_(count),
        row_((links() + width - 1) / width * width),
        state_(2 * static_cast<std::size_t>(motion_.row())) {}

  int links() const { return n_ * (1 + count_); }
  int row() const { return row_; }
  bool depends_on_time() const { return motion_.depends_on_time(); }
  void set_order(int order) {
    motion_.set_order(order);
    series_.resize((static_cast<std::size_t>(order) + 1) * state_.size());
  }

  /// Fills rows 1 .. order of `coefficients`, with time in units of sigma.
  PENDCORE_INLINE void expand(double t, const double* y, double sigma, int order,
                              double* coefficients) const {
    const int own_row = motion_.row();
    for (int change = n_; change < links(); change += n_) {
      for (int i = 0; i < n_; ++i) {
        state_[i] = {y[i], y[change + i]};
        state_[own_row + i] = {y[row_ + i], y[row_ + change + i]};
      }
      motion_.expand(t, state_.data(), sigma, order, series_.data());
      for (int k = 1; k <= order; ++k) {
        const Dual<double>* const from = &series_[static_cast<std::size_t>(k) * state_.size()];
        double* const to = coefficients + static_cast<std::ptrdiff_t>(k) * 2 * row_;
        for (int i = 0; i < n_; ++i) {
          to[i] = from[i].value;
          to[row_ + i] = from[own_row + i].value;
          to[change + i] = from[i].slope;
          to[row_ + change + i] = from[own_row + i].slope;
        }
      }
    }
  }

 private:
  static constexpr int width = Lanes<Block>::width;

  Motion motion_;
  int n_;
  int count_;
  int row_;
  mutable std::vector<Dual<double>> state_, series_;  ///< of the motion and one change
};

}  // namespace pendcore
