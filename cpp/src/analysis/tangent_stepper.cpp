#include "analysis/tangent_stepper.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "arithmetic/dual.hpp"
#include "dynamics/jacobian.hpp"
#include "dynamics/series/double_pendulum_series.hpp"
#include "dynamics/series/few_links_series.hpp"
#include "integrate/runge_kutta/dormand_prince_8.hpp"
#include "integrate/runge_kutta/runge_kutta_in_memory.hpp"
#include "integrate/taylor/taylor_stepper.hpp"
#include "scene/effects_of_scene.hpp"

namespace pendcore {
namespace {

/// The Taylor series of a motion and of small changes of its state. The coefficients of a change
/// are the derivatives of the coefficients of the motion along it. So the recurrences of the
/// motion, on dual numbers, give both.
///
/// The links of this series (integrate/taylor/taylor_step.hpp) are those of the motion and, for
/// each change, as many more. The rows of a state are (q, dq_1 .. dq_k) and (qd, dqd_1 .. dqd_k),
/// padded to whole blocks with zeros that nothing writes. The expand() of a `Motion` takes dual
/// numbers.
template <class Motion>
class TangentSeries {
 public:
  using Block = Pack<4>;
  static constexpr int blocks = 0;  ///< known at run time only
  static constexpr bool is_short = false;
  static constexpr Sets sets = usual_sets;

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

/// The state and k changes of it as one second-order system: rows (q, dq_1 .. dq_k) and
/// (qd, dqd_1 .. dqd_k).
class TangentSystem final : public GeneralSystem {
 public:
  /// A row has `size` numbers, padding included.
  TangentSystem(const Scene& scene, int count, int size, double t_end, bool forward)
      : GeneralSystem(size, 0),
        equations_(equations_of_motion(scene)),
        jacobian_(scene, equations_),
        n_(static_cast<int>(scene.links.size())),
        count_(count),
        t_end_(t_end),
        forward_(forward) {}

  void operator()(double t, const double* y, double* dydt) const override {
    const double* const qd = y + row;
    double* const qdd = dydt + row;
    __builtin_memcpy(dydt, qd, row * sizeof(double));
    std::fill_n(qdd, row, 0.0);
    choose_laws(t, y, qd);
    jacobian_.along(t, y, qd, count_, y + n_, qd + n_, qdd, qdd + n_);
  }

 private:
  /// A law whose pieces meet without a jump takes the piece that the state calls for. A table takes
  /// its last piece where the run ends with the table.
  void choose_laws(double t, const double* q, const double* qd) const {
    if (!equations_.effects || !equations_.effects->has_modes) return;
    const bool is_within = forward_ ? t < t_end_ : t > t_end_;
    choose_modes(*equations_.effects, is_within ? t : t_end_, q, qd, is_within == forward_);
  }

  EquationsOfMotion equations_;
  Jacobian jacobian_;
  int n_;
  int count_;
  double t_end_;
  bool forward_;
};

}  // namespace

std::unique_ptr<Stepper> tangent_stepper(const Scene& scene, int count, double t_end,
                                         bool forward) {
  const int numbers = static_cast<int>(scene.links.size()) * (1 + count);
  const EquationsOfMotion equations = equations_of_motion(scene);
  const auto& effects = equations.effects;
  const auto by_series = [&]<class Series>(Series series) -> std::unique_ptr<Stepper> {
    auto system = std::make_shared<TangentSystem>(scene, count, numbers, t_end, forward);
    auto rates = [system](double t, const double* y, double* dydt) { (*system)(t, y, dydt); };
    return std::make_unique<Taylor<TangentSeries<Series>>>(
        TangentSeries<Series>(std::move(series), count), std::move(rates), 0);
  };
  if (auto bare = bare_series(equations)) return by_series(*std::move(bare));
  if (effects && equations.are_steady() && !without_series(scene)) {
    if (auto loaded = series_with_torque(equations)) return by_series(*std::move(loaded));
    if (FewLinksSeries::has(scene, equations)) {
      return by_series(
          FewLinksSeries(scene, std::dynamic_pointer_cast<EffectsInRows<Pack<4>>>(effects)));
    }
  }
  const int row = row_in_memory(numbers, false);
  return runge_kutta_in_memory(dormand_prince_8.info.name,
                               std::make_unique<TangentSystem>(scene, count, row, t_end, forward),
                               numbers);
}

}  // namespace pendcore
