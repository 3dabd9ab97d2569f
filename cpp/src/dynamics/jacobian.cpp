#include "pendcore/dynamics/jacobian.hpp"

#include "pendcore/dynamics/accelerations_kernel.hpp"
#include "pendcore/dynamics/chain/chain_recursion.hpp"

namespace pendcore {
Jacobian::Jacobian(const Scene& scene, const EquationsOfMotion& equations)
    : n_(static_cast<int>(scene.links.size())), equations_(equations), q_(n_), qd_(n_), qdd_(n_) {
  if (std::holds_alternative<std::shared_ptr<Chain>>(equations.form)) {
    chain_ = std::make_shared<ChainOf<Dual<double>>>(
        scene, std::dynamic_pointer_cast<ActingEffects<Pack<4>>>(equations.effects));
  }
}

bool Jacobian::has_differences() const {
  return equations_.effects && !equations_.effects->users.empty();
}

void Jacobian::compute(double t) const {
  std::visit(
      [&]<class Form>(const Form& form) {
        if constexpr (std::is_same_v<Form, std::shared_ptr<Chain>>) {
          static const auto accelerations =
              fastest<&accelerations_in_memory<ChainOf<Dual<double>>, Dual<double>>>();
          accelerations(chain_.get(), t, q_.data(), qd_.data(), qdd_.data());
        } else {
          static const auto accelerations =
              fastest<&accelerations_in_memory<Form, Dual<double>>, best_for(2)>();
          accelerations(&form, t, q_.data(), qd_.data(), qdd_.data());
        }
      },
      equations_.form);
  // The link after a held joint turns with the link before it, to the last bit.
  for (int i = 0; i < n_; ++i) {
    if (!equations_.effects || equations_.effects->held[i] == 0) continue;
    qdd_[i].slope = i > 0 ? qdd_[i - 1].slope : 0.0;
  }
}

void Jacobian::operator()(double t, const double* q, const double* qd, double* by_q,
                          double* by_qd) const {
  for (int i = 0; i < n_; ++i) {
    q_[i] = q[i];
    qd_[i] = qd[i];
  }
  auto one = [&](Dual<double>& variable, double* column) {
    variable.slope = 1.0;
    compute(t);
    variable.slope = 0.0;
    for (int i = 0; i < n_; ++i) column[i * n_] = qdd_[i].slope;
  };
  for (int j = 0; j < n_; ++j) {
    one(q_[j], by_q + j);
    one(qd_[j], by_qd + j);
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
