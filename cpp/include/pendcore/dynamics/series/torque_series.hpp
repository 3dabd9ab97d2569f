/// \file
/// The Taylor series of the torques of effects on a double pendulum. The effects are couples
/// (effects/law.hpp): polynomials of the time and of the angle and rate of a joint, and up to two
/// waves.
///
///     tau = held + slope (t - start) + on_phi phi + on_phid w + on_phid2 w^2 + on_phid3 w^3
///           + gain sin(omega t + phase)
///
/// Time is in units of sigma, and the result is tau sigma^2/A for each link. Squares and cubes of
/// the rate are sums of products. Each order of a wave follows from the order before,
///
///     s_{k+1} = omega sigma c_k/(k + 1),    c_{k+1} = -omega sigma s_k/(k + 1)
///
/// Cost: some 10 operations for each order, and k products for each square or cube.
#pragma once

#include <memory>
#include <utility>

#include "pendcore/arithmetic/order_of_series.hpp"
#include "pendcore/dynamics/acting_effects.hpp"

namespace pendcore {

class CoupleTorque {
 public:
  static constexpr bool is_there = true;
  static constexpr bool depends_on_time = true;

  /// The effects must neither hold a joint nor move the pivot, and have at most two waves.
  CoupleTorque(std::shared_ptr<const ActingEffects<Pair>> effects, const Pair& inverse_diagonal)
      : effects_(std::move(effects)), inverse_diagonal_(inverse_diagonal) {}

  /// The orders of one series.
  class Orders {
   public:
    PENDCORE_INLINE Orders(const CoupleTorque& laws, double t, double sigma)
        : sigma_(sigma), per_sigma_(1.0 / sigma), by_(sigma * sigma * laws.inverse_diagonal_) {
      const ActingEffects<Pair>& effects = *laws.effects_;
      if (!effects.couples.empty()) {
        couples_ = &effects.couples.front();
        has_powers_ = couples_->has_powers();
        in_time_ = couples_->in_time<Pair>(t);
      }
      if (effects.waves == 0) return;
      has_waves_ = true;
      const TwoWaves& two = effects.two_waves;
      sine_cosine(fma(two.angular_frequency, Pair{t, t}, two.phase), sine_, cosine_);
      turn_ = sigma * two.angular_frequency;
      // The gains may differ from series to series: a motor at its limit has no wave.
      for (const JointWave& one : effects.joint_waves) gain_[one.wave][one.joint] += one.gain;
    }

    /// Order k from the angles and rates of order k. The orders are called one after the other,
    /// from 0.
    PENDCORE_INLINE Pair next(int k, const Pair& angle, const Pair& rate) {
      Pair couple{};
      if (couples_ != nullptr) {
        const Pair w = per_sigma_ * (rate - before(rate));
        couple = fma(couples_->on_phid, w, couples_->on_phi * (angle - before(angle)));
        if (k == 0) couple = couple + in_time_;
        if (k == 1) couple = couple + sigma_ * couples_->slope;
        if (has_powers_) couple = couple + of_powers(k, w);
      }
      if (has_waves_) {
        couple = fma(gain_[0], Pair{sine_[0], sine_[0]}, couple);
        couple = fma(gain_[1], Pair{sine_[1], sine_[1]}, couple);
        const Pair factor = inverse_of[k + 1] * turn_;
        const Pair sine = sine_;
        sine_ = factor * cosine_;
        cosine_ = -(factor * sine);
      }
      return by_ * (couple - after(couple));
    }

   private:
    PENDCORE_INLINE Pair of_powers(int k, const Pair& w) {
      const auto rate = [this](int j) { return rates_[j]; };
      const auto square = [this](int j) { return squares_[j]; };
      rates_[k] = w;
      squares_[k] = order_of_product(k, rate, rate);
      const Pair cube = order_of_product(k, square, rate);
      return fma(couples_->on_phid2, squares_[k], couples_->on_phid3 * cube);
    }

    const Couples<Pair>* couples_ = nullptr;
    bool has_powers_ = false;
    bool has_waves_ = false;
    double sigma_, per_sigma_;
    Pair by_;         ///< sigma^2/A
    Pair in_time_{};  ///< held + slope (t - start)
    Pair sine_{}, cosine_{}, turn_{};
    Pair gain_[2]{};  ///< the gain of each wave on the joints
    Pair rates_[highest_order];
    Pair squares_[highest_order];
  };

 private:
  std::shared_ptr<const ActingEffects<Pair>> effects_;
  Pair inverse_diagonal_;
};

}  // namespace pendcore
