#include "pendcore/effects/motor.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "arithmetic/floating_point_environment.hpp"
#include "arithmetic/sine_cosine.hpp"
#include "effects/behaviour.hpp"
#include "effects/times.hpp"

namespace pendcore {
namespace {

double sign_of(int mode) { return static_cast<double>(mode); }

/// The arc sine for 0 <= x < 1, by Newton's method on the sine that the laws use, so that it has
/// the same bits everywhere.
double arc_sine(double x) {
  double angle = x;
  for (int i = 0; i < 60; ++i) {
    double sine, cosine;
    sine_cosine(angle, sine, cosine);
    const double better = angle + (x - sine) / cosine;
    if (better == angle) break;
    angle = better;
  }
  return angle;
}

double clipped(double torque, double limit) { return std::max(-limit, std::min(torque, limit)); }

/// A table whose torques are clipped at +-limit, with points where it meets the limit. The table
/// may be one that check() refuses.
Table clipped_table(const Table& table, double limit) {
  if (!std::isfinite(limit) || table.torque.size() != table.t.size()) return table;
  Table result{.hold = table.hold};
  for (std::size_t i = 0; i < table.t.size(); ++i) {
    const double t = table.t[i];
    const double torque = table.torque[i];
    if (i > 0 && !table.hold) {
      const double t_before = table.t[i - 1];
      const double before = table.torque[i - 1];
      const double first = torque > before ? -limit : limit;  // of the edges that it may meet
      for (const double edge : {first, -first}) {
        if (!((before - edge) * (torque - edge) < 0.0)) continue;
        const double meet = t_before + (t - t_before) * ((edge - before) / (torque - before));
        if (!(meet > result.t.back() && meet < t)) continue;
        result.t.push_back(meet);
        result.torque.push_back(edge);  // exactly: a clipped piece has no slope, by rounding either
      }
    }
    result.t.push_back(t);
    result.torque.push_back(clipped(torque, limit));
  }
  return result;
}

class MotorBehaviour final : public EffectOf<Motor> {
 public:
  explicit MotorBehaviour(Motor given) : EffectOf(std::move(given)) {
    const FloatingPointEnvironment ieee;
    if (given_.table) table_ = clipped_table(*given_.table, given_.limit);
  }

  std::optional<Couple> couple(int mode) const override;
  std::vector<Sinusoid> waves() const override {
    if (given_.sinusoid) return {*given_.sinusoid};
    return {};
  }

  bool has_modes() const override {
    return table_ || (given_.limit < never && given_.pd) || is_clipped();
  }
  int mode_at(double t, double phi, double phid, bool forward) const override;
  std::vector<Guard> guards(int mode) const override;
  int next_mode(int mode, std::size_t guard) const override {
    if (mode != 0) return 0;
    return guard == 0 ? 1 : -1;
  }
  double next_time(double t, bool forward) const override;
  double first_time() const override { return table_ ? table_->t.front() : -never; }
  double last_time() const override { return table_ ? table_->t.back() : never; }

 private:
  void check_together(const std::string& where) const override {
    const int laws = given_.constant.has_value() + given_.sinusoid.has_value() +
                     given_.table.has_value() + given_.pd.has_value();
    if (laws == 1) return;
    throw std::invalid_argument(where + (laws == 0 ? "no law" : "more than one law") +
                                " given: give one of constant, sinusoid, table and pd");
  }
  bool is_clipped() const {
    return given_.sinusoid && std::abs(given_.sinusoid->amplitude) > given_.limit;
  }

  std::optional<Table> table_;
};

double MotorBehaviour::next_time(double t, bool forward) const {
  if (table_) return next_of(table_->t, t, forward);
  const double none = forward ? never : -never;
  if (!given_.sinusoid || !is_clipped()) return none;
  const auto& [amplitude, frequency, phase] = *given_.sinusoid;
  if (frequency == 0.0) return none;
  const double pi = 3.14159265358979323846;
  const double edge = arc_sine(given_.limit / std::abs(amplitude));
  const double half_waves = std::floor(fma(frequency, t, phase) / pi);
  double next = none;
  for (int k = -2; k <= 2; ++k) {
    for (const double side : {edge, -edge}) {
      const double time = (fma(half_waves + k, pi, side) - phase) / frequency;
      if (forward ? time > t && time < next : time < t && time > next) next = time;
    }
  }
  return next;
}

int MotorBehaviour::mode_at(double t, double phi, double phid, bool forward) const {
  if (table_) return piece_at(table_->t, t, forward);
  if (given_.pd) {
    const auto& [kp, kd, reference] = *given_.pd;
    const double torque = kp * (reference - phi) - kd * phid;
    return torque > given_.limit ? 1 : torque < -given_.limit ? -1 : 0;
  }
  if (!given_.sinusoid || !is_clipped()) return 0;
  // The mode is the one halfway to the next change, because t may itself be a time of change.
  const double next = next_time(t, forward);
  const double middle = std::isfinite(next) ? 0.5 * (t + next) : t;
  double sine, cosine;
  sine_cosine(fma(given_.sinusoid->angular_frequency, middle, given_.sinusoid->phase), sine,
              cosine);
  const double torque = given_.sinusoid->amplitude * sine;
  return torque > given_.limit ? 1 : torque < -given_.limit ? -1 : 0;
}

std::vector<Guard> MotorBehaviour::guards(int mode) const {
  if (!given_.pd || !std::isfinite(given_.limit)) return {};
  auto guard = [&](double sign, double offset) {  // on the torque without the limit
    const auto& [kp, kd, reference] = *given_.pd;
    return Guard{
        .offset = sign * kp * reference + offset, .on_phi = -sign * kp, .on_phid = -sign * kd};
  };
  if (mode != 0) return {guard(sign_of(mode), -given_.limit)};
  return {guard(-1.0, given_.limit), guard(1.0, given_.limit)};
}

std::optional<Couple> MotorBehaviour::couple(int mode) const {
  if (given_.constant) return Couple{.held = clipped(*given_.constant, given_.limit)};
  if (table_) {
    const auto& [t, torque, hold] = *table_;
    const int last = static_cast<int>(t.size()) - 1;
    if (mode < 0 || mode >= last) return Couple{.held = std::nan("")};
    if (hold) return Couple{.held = torque[mode]};
    const double rise = torque[mode + 1] - torque[mode];
    return Couple{.held = torque[mode], .slope = rise / (t[mode + 1] - t[mode]), .start = t[mode]};
  }
  if (mode != 0) return Couple{.held = sign_of(mode) * given_.limit};
  if (given_.pd) {
    const auto& [kp, kd, reference] = *given_.pd;
    return Couple{.held = kp * reference, .on_phi = -kp, .on_phid = -kd};
  }
  return given_.sinusoid ? Couple{.gain = given_.sinusoid->amplitude} : Couple{};
}

}  // namespace

std::shared_ptr<const EffectBehaviour> behaviour(Motor given) {
  return std::make_shared<MotorBehaviour>(std::move(given));
}

}  // namespace pendcore
