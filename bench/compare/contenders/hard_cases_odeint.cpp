// Boost.odeint on the hard cases, as an experienced user would write them: dopri5 with dense output
// or integrate_adaptive, fehlberg78 for high accuracy, rosenbrock4 for stiff cases. A request is
// the name of a case and numbers; bench/compare/hard_cases/ says what each case is about.
// C++17, because Boost 1.74's ublas, which rosenbrock4 needs, uses what C++20 has removed.
#include <algorithm>
#include <array>
#include <boost/numeric/odeint.hpp>
#include <boost/numeric/ublas/matrix.hpp>
#include <boost/numeric/ublas/vector.hpp>
#include <boost/version.hpp>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "hard_cases_odeint.hpp"

namespace {

using namespace hard_cases;
namespace ode = boost::numeric::odeint;
namespace ublas = boost::numeric::ublas;

using Two = std::array<double, 2>;
using Four = std::array<double, 4>;
using Stiff = ublas::vector<double>;
using Matrix = ublas::matrix<double>;
constexpr double pi = 3.14159265358979323846;

template <class State>
auto dense_dopri5(double atol, double rtol) {
  return ode::make_dense_output(atol, rtol, ode::runge_kutta_dopri5<State>());
}

// The time in [low, high] at which the sign of `value` changes.
double bisect(double low, double high, const std::function<double(double)>& value) {
  const bool above = value(low) > 0;
  for (int k = 0; k < 80; ++k) {
    const double middle = 0.5 * (low + high);
    ((value(middle) > 0) == above ? low : high) = middle;
  }
  return high;
}

// One rod under a torque and friction with a smoothed sign, and its Jacobian.
struct Rubbed {
  double friction, soft;
  std::function<double(double, double)> torque, torque_by_angle, torque_by_time;
  void operator()(const Stiff& y, Stiff& f, double t) const {
    f[0] = y[1];
    f[1] = torque(t, y[0]) - friction * std::tanh(y[1] / soft);
  }
  void jacobian(const Stiff& y, Matrix& j, double t, Stiff& by_time) const {
    const double s = std::tanh(y[1] / soft);
    j(0, 0) = 0;
    j(0, 1) = 1;
    j(1, 0) = torque_by_angle(t, y[0]);
    j(1, 1) = -friction / soft * (1 - s * s);
    by_time[0] = 0;
    by_time[1] = torque_by_time(t, y[0]);
  }
};

auto with_jacobian(const Rubbed& rod) {
  return std::make_pair([&rod](const Stiff& y, Stiff& f, double t) { rod(y, f, t); },
                        [&rod](const Stiff& y, Matrix& j, const double& t, Stiff& by_time) {
                          rod.jacobian(y, j, t, by_time);
                        });
}

void held_rod(const Numbers&) {
  const double weight = 1.5 * 9.81;
  const Rubbed rod{
      2 * weight * std::cos(pi / 6), 1e-6, [=](double, double q) { return weight * std::cos(q); },
      [=](double, double q) { return -weight * std::sin(q); }, [](double, double) { return 0.0; }};
  Stiff y(2);
  y[0] = pi / 6;
  y[1] = 0;
  ode::integrate_adaptive(ode::make_controlled<ode::rosenbrock4<double>>(1e-12, 1e-8),
                          with_jacobian(rod), y, 0.0, 1e6, 1e-6);
  tell("q", {y[0]});
}

// Number: a time at which the rod rests.
void stick_slip(const Numbers& numbers) {
  const Rubbed rod{0.7, 1e-4, [](double t, double) { return 0.4 + 0.5 * std::sin(2 * t); },
                   [](double, double) { return 0.0; },
                   [](double t, double) { return std::cos(2 * t); }};
  auto stepper = ode::make_dense_output<ode::rosenbrock4<double>>(1e-10, 1e-7);
  stepper.initialize(Stiff(2, 0.0), 0.0, 1e-6);
  Stiff shown(2);
  const auto reach = [&](double t) {
    while (stepper.current_time() < t) stepper.do_step(with_jacobian(rod));
    stepper.calc_state(t, shown);
  };
  reach(numbers[0]);
  tell("rest", {shown[1]});
  reach(20 * pi);
  tell("end", {shown[0]});
}

void bounces(const Numbers&) {
  const auto rates = [](const Two& y, Two& f, double) { f = {y[1], -2.0}; };
  const double restitution = 0.8, capture = 1e-9, t_end = 8;
  Two y{0.4, 0}, shown{};
  double t = 0;
  while (t < t_end) {
    auto stepper = dense_dopri5<Two>(1e-13, 1e-11);
    const double flight = y[1] > 0 ? y[1] : 1.0;  // the flight takes 2 y[1]/2 s: begin within it
    stepper.initialize(y, t, 0.25 * flight);
    do {
      stepper.do_step(rates);
    } while (stepper.current_state()[0] > 0 && stepper.current_time() < t_end);
    if (stepper.current_state()[0] > 0) break;
    t = bisect(stepper.previous_time(), stepper.current_time(), [&](double s) {
      stepper.calc_state(s, shown);
      return shown[0] == 0 ? 1.0 : shown[0];  // the start of a flight is on the stop
    });
    stepper.calc_state(t, shown);
    if (-shown[1] * restitution < capture) {
      tell("t", {t});
      tell("q", {0});
      return;
    }
    y = {0, -restitution * shown[1]};
  }
  tell("t", {-1});
  tell("q", {y[0]});
}

void not_a_number(const Numbers&) {
  Two y{0, 1};
  double t = 0;
  ode::integrate_adaptive(
      controlled_dopri5<Two>(1e-10, 1e-6),
      [](const Two& x, Two& f, double) { f = {x[1], 0.0 * std::sqrt(0.5 - x[0])}; }, y, 0.0, 2.0,
      0.01, [&](const Two&, double s) { t = s; });
  tell("t", {t});
  tell("q", {y[0]});
}

void blow_up(const Numbers&) {
  Two y{0, 1};
  double t = 0;
  ode::integrate_adaptive(
      controlled_dopri5<Two>(1e-10, 1e-6),
      [](const Two& x, Two& f, double) { f = {x[1], x[1] * x[1] * x[1]}; }, y, 0.0, 1.0, 0.01,
      [&](const Two&, double s) { t = s; });
  tell("t", {t});
}

void late_start(const Numbers&) {
  Four y{0.3, 0.3, 0, 0};
  double t = 0;
  const auto steps = ode::integrate_adaptive(
      controlled_dopri5<Four>(1e-10, 1e-6), [](const Four& x, Four& f, double) { textbook(x, f); },
      y, 1e17, 1e17 + 160, 0.01, [&](const Four&, double s) { t = s; });
  tell("t", {t});
  tell("q", {y[0]});
  tell("steps", {static_cast<double>(steps)});
}

// Numbers: the end, the longest step.
void two_roots(const Numbers& numbers) {
  const double g = 9.81, mark = 0.99999;
  auto stepper = ode::make_dense_output(1e-12, 1e-9, numbers[1], ode::runge_kutta_dopri5<Two>());
  Two shown{};
  stepper.initialize(Two{-1.0, 0.0}, 0.0, 1e-3);
  Numbers found;
  double before = -1;
  while (stepper.current_time() < numbers[0]) {
    stepper.do_step([=](const Two& y, Two& f, double) { f = {y[1], -1.5 * g * std::sin(y[0])}; });
    const double now = stepper.current_state()[0] - mark;
    if (before * now < 0)
      found.push_back(bisect(stepper.previous_time(), stepper.current_time(), [&](double s) {
        stepper.calc_state(s, shown);
        return shown[0] - mark;
      }));
    before = now;
  }
  tell("t", found);
}

// A right-hand side of four components, with derivatives by differences.
template <class Rates>
auto with_differences(const Rates& rates) {
  return std::make_pair(rates, [rates](const Stiff& y, Matrix& j, const double& t, Stiff& by_time) {
    Stiff plus(4), minus(4), at = y;
    for (std::size_t k = 0; k < 4; ++k) {
      const double step = 1e-6 * std::max(1e-3, std::abs(y[k]));
      at[k] = y[k] + step;
      rates(at, plus, t);
      at[k] = y[k] - step;
      rates(at, minus, t);
      at[k] = y[k];
      for (std::size_t i = 0; i < 4; ++i) j(i, k) = (plus[i] - minus[i]) / (2 * step);
    }
    rates(y, plus, t + 1e-6);
    rates(y, minus, t - 1e-6);
    by_time = (plus - minus) / 2e-6;
  });
}

Stiff four(double q_1, double q_2) {
  Stiff y(4, 0.0);
  y[0] = q_1;
  y[1] = q_2;
  return y;
}

void stiff_damper(const Numbers&) {
  const auto rates = [](const Stiff& y, Stiff& f, double) {
    textbook(y, f, 0, -1e5 * (y[3] - y[2]));
  };
  Stiff y = four(pi / 4, pi / 3);
  const auto steps =
      ode::integrate_adaptive(ode::make_controlled<ode::rosenbrock4<double>>(1e-10, 1e-8),
                              with_differences(rates), y, 0.0, 5.0, 1e-6);
  tell("q", {y[0], y[1]});
  tell("steps", {static_cast<double>(steps)});
}

// Numbers: the times at which to print the states.
void two_joints(const Numbers& times) {
  const auto rates = [](const Stiff& y, Stiff& f, double t) {
    const double soft = 1e-3;
    textbook(y, f, 10 * std::sin(t) - 5 * std::tanh(y[2] / soft),
             -1.5 * std::tanh((y[3] - y[2]) / soft));
  };
  auto stepper = ode::make_dense_output<ode::rosenbrock4<double>>(1e-10, 1e-8);
  stepper.initialize(four(pi / 2, pi / 2), 0.0, 1e-6);
  Numbers states;
  Stiff shown(4);
  for (std::size_t k = 0; k < times.size();) {
    stepper.do_step(with_differences(rates));
    for (; k < times.size() && times[k] <= stepper.current_time(); ++k) {
      stepper.calc_state(times[k], shown);
      states.insert(states.end(), shown.begin(), shown.end());
    }
  }
  tell("states", states);
}

// Numbers: the start (upright), the tolerances.
void upright(const Numbers& numbers) {
  const double start = numbers[0], top = numbers[1];
  auto stepper = dense_dopri5<Four>(numbers[3], numbers[2]);
  stepper.initialize(Four{start, start, 0, 0}, 0.0, 1e-4);
  Four shown{};
  const auto off = [&](const Four& y) {
    return std::max(std::abs(y[0] - top), std::abs(y[1] - top)) - 1;
  };
  do {
    stepper.do_step([](const Four& y, Four& f, double) { textbook(y, f); });
  } while (off(stepper.current_state()) < 0 && stepper.current_time() < 6);
  tell("t", {bisect(stepper.previous_time(), stepper.current_time(), [&](double s) {
         stepper.calc_state(s, shown);
         return off(shown);
       })});
}

// Numbers: amplitude and period.
void separatrix(const Numbers& numbers) {
  Two y{numbers[0], 0};
  ode::integrate_adaptive(
      controlled_dopri5<Two>(1e-14, 1e-12),
      [](const Two& x, Two& f, double) { f = {x[1], -1.5 * 9.807 * std::sin(x[0])}; }, y, 0.0,
      numbers[1], 1e-3);
  tell("q", {y[0]});
}

const std::map<std::string, void (*)(const Numbers&)> cases{{"held_rod", held_rod},
                                                            {"stick_slip", stick_slip},
                                                            {"bounces", bounces},
                                                            {"not_a_number", not_a_number},
                                                            {"blow_up", blow_up},
                                                            {"late_start", late_start},
                                                            {"two_roots", two_roots},
                                                            {"upright", upright},
                                                            {"stiff_damper", stiff_damper},
                                                            {"separatrix", separatrix},
                                                            {"two_joints", two_joints},
                                                            {"payload", payload},
                                                            {"chain", chain},
                                                            {"drift", drift},
                                                            {"shaken", shaken}};

}  // namespace

int main() {
  return contenders::converse([](std::istream& request) {
    std::string word;
    request >> word;
    told.clear();
    if (word == "version") return std::string(BOOST_LIB_VERSION ";");
    Numbers numbers;
    for (double number = 0; request >> number;) numbers.push_back(number);
    cases.at(word)(numbers);
    return told;
  });
}
