#include "pendcore/effects/motor.hpp"

#include "pendcore/arithmetic/sine_cosine.hpp"

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

}  // namespace

void Motor::check(const std::string& where) const {
  const int given =
      constant.has_value() + sinusoid.has_value() + table.has_value() + pd.has_value();
  if (given != 1) {
    throw std::invalid_argument(where + (given == 0 ? "no law" : "more than one law") +
                                " given: give one of constant, sinusoid, table and pd");
  }
}

Motor Motor::compiled() const {
  Motor motor = *this;
  if (!table || !std::isfinite(limit)) return motor;
  Table result{.hold = table->hold};
  for (std::size_t i = 0; i < table->t.size(); ++i) {
    const double t = table->t[i];
    const double torque = table->torque[i];
    if (i > 0 && !table->hold) {
      const double t_before = table->t[i - 1];
      const double before = table->torque[i - 1];
      std::vector<double> meets;
      for (const double edge : {-limit, limit}) {
        if ((before - edge) * (torque - edge) < 0.0) {
          meets.push_back(t_before + (t - t_before) * ((edge - before) / (torque - before)));
        }
      }
      std::ranges::sort(meets);
      for (const double meet : meets) {
        if (!(meet > result.t.back() && meet < t)) continue;
        result.t.push_back(meet);
        const double share = (meet - t_before) / (t - t_before);
        result.torque.push_back(clipped(before + (torque - before) * share));
      }
    }
    result.t.push_back(t);
    result.torque.push_back(clipped(torque));
  }
  motor.table = result;
  return motor;
}

double Motor::next_time(double t, bool forward) const {
  if (table) return next_of(table->t, t, forward);
  const double none = forward ? never : -never;
  if (!sinusoid || !is_clipped()) return none;
  const auto& [amplitude, frequency, phase] = *sinusoid;
  if (frequency == 0.0) return none;
  const double pi = 3.14159265358979323846;
  const double edge = arc_sine(limit / std::abs(amplitude));
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

int Motor::mode_at(double t, double phi, double phid, bool forward) const {
  if (table) return piece_at(table->t, t, forward);
  if (pd) {
    const double torque = pd->kp * (pd->reference - phi) - pd->kd * phid;
    return torque > limit ? 1 : torque < -limit ? -1 : 0;
  }
  if (!sinusoid || !is_clipped()) return 0;
  // The mode is the one halfway to the next change, because t may itself be a time of change.
  const double next = next_time(t, forward);
  const double middle = std::isfinite(next) ? 0.5 * (t + next) : t;
  double sine, cosine;
  sine_cosine(fma(sinusoid->angular_frequency, middle, sinusoid->phase), sine, cosine);
  const double torque = sinusoid->amplitude * sine;
  return torque > limit ? 1 : torque < -limit ? -1 : 0;
}

std::vector<Guard> Motor::guards(int mode) const {
  if (!pd || !std::isfinite(limit)) return {};
  auto guard = [&](double sign, double offset) {  // on the torque without the limit
    return Guard{.offset = sign * pd->kp * pd->reference + offset,
                 .on_phi = -sign * pd->kp,
                 .on_phid = -sign * pd->kd};
  };
  if (mode != 0) return {guard(sign_of(mode), -limit)};
  return {guard(-1.0, limit), guard(1.0, limit)};
}

int Motor::next_mode(int mode, std::size_t guard) const {
  if (mode != 0) return 0;
  return guard == 0 ? 1 : -1;
}

std::optional<Couple> Motor::couple(int mode) const {
  if (constant) return Couple{.held = clipped(*constant)};
  if (table) {
    const auto& [t, torque, hold] = *table;
    const int last = static_cast<int>(t.size()) - 1;
    if (mode < 0 || mode >= last) return Couple{.held = std::nan("")};
    if (hold) return Couple{.held = torque[mode]};
    const double rise = torque[mode + 1] - torque[mode];
    return Couple{.held = torque[mode], .slope = rise / (t[mode + 1] - t[mode]), .start = t[mode]};
  }
  if (mode != 0) return Couple{.held = sign_of(mode) * limit};
  if (pd) return Couple{.held = pd->kp * pd->reference, .on_phi = -pd->kp, .on_phid = -pd->kd};
  return sinusoid ? Couple{.gain = sinusoid->amplitude} : Couple{};
}

}  // namespace pendcore
