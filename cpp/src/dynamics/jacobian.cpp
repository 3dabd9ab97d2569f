#include "dynamics/jacobian.hpp"

#include <algorithm>

#include "dynamics/accelerations_kernel.hpp"
#include "dynamics/chain/chain_recursion.hpp"

namespace pendcore {
namespace {

/// Both matrices of equations of two links, with a direction in each lane.
template <class Form>
PENDCORE_INLINE void jacobian_in_lanes(const Form& form, double t, const double* q,
                                       const double* qd, double* by_q, double* by_qd) {
  using Four = Pack<4>;
  const auto both = [](const double* x, const Four& along_first, const Four& along_second) {
    return Dual<Two<Four>>({broadcast<Four>(x[0]), broadcast<Four>(x[1])},
                           {along_first, along_second});
  };
  const auto angles = both(q, Four{1.0, 0.0, 0.0, 0.0}, Four{0.0, 1.0, 0.0, 0.0});
  const auto rates = both(qd, Four{0.0, 0.0, 1.0, 0.0}, Four{0.0, 0.0, 0.0, 1.0});
  const Dual<Two<Four>> qdd = accelerations_at(form, t, angles, rates);
  const Two<Four>& by_all = qdd.slope;
  store(by_q, low_half(by_all.first));
  store(by_q + 2, low_half(by_all.second));
  store(by_qd, high_half(by_all.first));
  store(by_qd + 2, high_half(by_all.second));
}

/// Both matrices of closed-form equations. Written out for all directions, what does not depend on
/// the direction is computed once.
template <class Form>
PENDCORE_INLINE void jacobian_in_memory(const Form* form, double t, const double* q,
                                        const double* qd, double* by_q, double* by_qd) {
  if constexpr (takes_states_in_lanes<Form>) {
    jacobian_in_lanes(*form, t, q, qd, by_q, by_qd);
  } else {
    using Row = typename Form::Links;
    constexpr int n = Lanes<Row>::width;
    const Row angles = load<Row>(q);
    const Row rates = load<Row>(qd);
#pragma GCC unroll 2
    for (int j = 0; j < n; ++j) {
      Row direction{};
      set_lane(direction, j, 1.0);
      const Dual<Row> of_angle =
          accelerations_at(*form, t, Dual<Row>(angles, direction), Dual<Row>(rates));
      const Dual<Row> of_rate =
          accelerations_at(*form, t, Dual<Row>(angles), Dual<Row>(rates, direction));
      for (int i = 0; i < n; ++i) {
        by_q[i * n + j] = lane(of_angle.slope, i);
        by_qd[i * n + j] = lane(of_rate.slope, i);
      }
    }
  }
}

}  // namespace

Jacobian::Jacobian(const Scene& scene, const EquationsOfMotion& equations)
    : n_(static_cast<int>(scene.links.size())), equations_(equations) {
  one_.row.resize(3 * static_cast<std::size_t>(n_));
  if (!std::holds_alternative<std::shared_ptr<Chain>>(equations.form)) return;
  const auto effects = std::dynamic_pointer_cast<EffectsInRows<Pack<4>>>(equations.effects);
  const auto take = [&]<class Number>(Directions<Number>& some) {
    some.chain = std::make_shared<ChainOf<Number>>(scene, effects);
    some.row.resize(one_.row.size());
  };
  take(one_);
  if (!has_special_kernels_ || !effects->users.empty()) return;
  if (instruction_set() == InstructionSet::x86_64_v4) {
    take(eight_);
  } else {
    take(four_);
  }
}

template <class Number>
void Jacobian::compute(double t, Directions<Number>& some) const {
  constexpr auto* of_chain = &accelerations_in_memory<ChainOf<Number>, Number>;
  Number* const q = some.row.data();
  Number* const qd = q + n_;
  Number* const qdd = qd + n_;
  if constexpr (std::is_same_v<Number, Dual<double>>) {
    std::visit(
        [&]<class Form>(const Form& form) {
          if constexpr (std::is_same_v<Form, std::shared_ptr<Chain>>) {
            on_this_processor<of_chain, wide_sets>(some.chain.get(), t, q, qd, qdd);
          } else {
            on_this_processor<&accelerations_in_memory<Form, Number>>(&form, t, q, qd, qdd);
          }
        },
        equations_.form);
  } else if constexpr (has_special_kernels_of_rare_runs) {
    constexpr bool is_wide = Lanes<decltype(Number::slope)>::width == 8;
    constexpr InstructionSet set = is_wide ? wide_special_sets.best : special_sets.least;
    static const auto clone = only<of_chain, set>();
    clone(some.chain.get(), t, q, qd, qdd);
  }
  // The link after a held joint turns with the link before it, to the last bit.
  for (int i = 0; i < n_; ++i) {
    if (!equations_.effects || equations_.effects->held[i] == 0) continue;
    qdd[i].slope = (i > 0 ? qdd[i - 1] : Number{}).slope;
  }
}

/// Computes qdd along `count` directions, in a row y of q, qd and qdd: put(y, j, k) sets the slopes
/// of q and qd in lane k to direction j, and take(y, j, k) gets those of qdd.
template <class Number, class Put, class Take>
void Jacobian::in_turn(Directions<Number>& some, double t, const double* q, const double* qd,
                       int count, const Put& put, const Take& take) const {
  constexpr int at_once = Lanes<decltype(Number::slope)>::width;
  Number* const y = some.row.data();
  std::copy_n(q, n_, y);
  std::copy_n(qd, n_, y + n_);
  for (int first = 0; first < count; first += at_once) {
    const int after = std::min(first + at_once, count);
    for (int j = first; j < after; ++j) put(y, j, j - first);
    compute(t, some);
    for (int j = first; j < after; ++j) take(y, j, j - first);
  }
}

/// The same, several directions at a time where that is faster.
template <class Put, class Take>
void Jacobian::in_turn(double t, const double* q, const double* qd, int count, const Put& put,
                       const Take& take) const {
  if (count > 1 && eight_.chain) return in_turn(eight_, t, q, qd, count, put, take);
  if (count > 1 && four_.chain) return in_turn(four_, t, q, qd, count, put, take);
  in_turn(one_, t, q, qd, count, put, take);
}

void Jacobian::operator()(double t, const double* q, const double* qd, Eigen::Ref<Matrix> by_q,
                          Eigen::Ref<Matrix> by_qd) const {
  if (one_.chain || !has_special_kernels_) {
    return in_turn(
        t, q, qd, 2 * n_, [](auto* y, int j, int k) { set_lane(y[j].slope, k, 1.0); },
        [&](auto* y, int j, int k) {
          set_lane(y[j].slope, k, 0.0);
          auto column = j < n_ ? by_q.col(j) : by_qd.col(j - n_);
          for (int i = 0; i < n_; ++i) column[i] = lane(y[2 * n_ + i].slope, k);
        });
  }
  std::visit(
      [&]<class Form>(const Form& form) {
        if constexpr (has_special_kernels_of_rare_runs &&
                      !std::is_same_v<Form, std::shared_ptr<Chain>>) {
          on_this_processor<&jacobian_in_memory<Form>, special_sets>(&form, t, q, qd, by_q.data(),
                                                                     by_qd.data());
        }
      },
      equations_.form);
  if (!equations_.effects) return;
  for (int i = 0; i < n_; ++i) {
    if (equations_.effects->held[i] == 0) continue;
    for (Eigen::Ref<Matrix>* const matrix : {&by_q, &by_qd}) {
      if (i > 0) {
        matrix->row(i) = matrix->row(i - 1);
      } else {
        matrix->row(i).setZero();
      }
    }
  }
}

void Jacobian::along(double t, const double* q, const double* qd, int count, const double* dq,
                     const double* dqd, double* qdd, double* changes) const {
  in_turn(
      t, q, qd, count,
      [&](auto* y, int j, int k) {
        for (int i = 0; i < n_; ++i) {
          set_lane(y[i].slope, k, dq[j * n_ + i]);
          set_lane(y[n_ + i].slope, k, dqd[j * n_ + i]);
        }
      },
      [&](auto* y, int j, int k) {
        for (int i = 0; i < n_; ++i) {
          qdd[i] = y[2 * n_ + i].value;
          changes[j * n_ + i] = lane(y[2 * n_ + i].slope, k);
        }
      });
}

}  // namespace pendcore
