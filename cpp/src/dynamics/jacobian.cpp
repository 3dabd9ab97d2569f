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
    : n_(static_cast<int>(scene.links.size())), equations_(equations), q_(n_), qd_(n_), qdd_(n_) {
  if (std::holds_alternative<std::shared_ptr<Chain>>(equations.form)) {
    chain_ = std::make_shared<ChainOf<Dual<double>>>(
        scene, std::dynamic_pointer_cast<EffectsInRows<Pack<4>>>(equations.effects));
  }
}

void Jacobian::compute(double t) const {
  std::visit(
      [&]<class Form>(const Form& form) {
        if constexpr (std::is_same_v<Form, std::shared_ptr<Chain>>) {
          on_this_processor<&accelerations_in_memory<ChainOf<Dual<double>>, Dual<double>>,
                            wide_sets>(chain_.get(), t, q_.data(), qd_.data(), qdd_.data());
        } else {
          on_this_processor<&accelerations_in_memory<Form, Dual<double>>>(&form, t, q_.data(),
                                                                          qd_.data(), qdd_.data());
        }
      },
      equations_.form);
  // The link after a held joint turns with the link before it, to the last bit.
  for (int i = 0; i < n_; ++i) {
    if (!equations_.effects || equations_.effects->held[i] == 0) continue;
    qdd_[i].slope = i > 0 ? qdd_[i - 1].slope : 0.0;
  }
}

void Jacobian::operator()(double t, const double* q, const double* qd, Eigen::Ref<Matrix> by_q,
                          Eigen::Ref<Matrix> by_qd) const {
  // Both matrices at once have the bits of each direction alone, and are only faster.
  if (chain_ || !has_special_kernels_of_rare_runs || instruction_set() < special_sets.least) {
    return direction_by_direction(t, q, qd, by_q, by_qd);
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

void Jacobian::direction_by_direction(double t, const double* q, const double* qd,
                                      Eigen::Ref<Matrix> by_q, Eigen::Ref<Matrix> by_qd) const {
  std::copy_n(q, n_, q_.begin());
  std::copy_n(qd, n_, qd_.begin());
  auto one = [&](Dual<double>& variable, auto column) {
    variable.slope = 1.0;
    compute(t);
    variable.slope = 0.0;
    for (int i = 0; i < n_; ++i) column[i] = qdd_[i].slope;
  };
  for (int j = 0; j < n_; ++j) {
    one(q_[j], by_q.col(j));
    one(qd_[j], by_qd.col(j));
  }
}

void Jacobian::along(double t, const double* q, const double* qd, const double* dq,
                     const double* dqd, double* qdd, double* change) const {
  for (int i = 0; i < n_; ++i) {
    q_[i] = {q[i], dq[i]};
    qd_[i] = {qd[i], dqd[i]};
  }
  compute(t);
  for (int i = 0; i < n_; ++i) {
    qdd[i] = qdd_[i].value;
    change[i] = qdd_[i].slope;
  }
}

}  // namespace pendcore
