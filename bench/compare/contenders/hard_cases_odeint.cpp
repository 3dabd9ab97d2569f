// Boost.odeint on the hard cases, as an experienced user would write them: dopri5 with dense output
// or integrate_adaptive, fehlberg78 for high accuracy, rosenbrock4 for stiff cases. Each request
// begins with SYSTEM PARAMETERS METHOD atol rtol first_step START, where lists have their length in
// front; bench/compare/hard_cases/ says what each case is about.
//
//   integrate ... t0 t1       the last time, the last state, the steps
//   states ... TIMES          the states at times
//   bounces ... t1 e capture      the last bounce, or t = -1; where the rod is
//   passages ... mark longest t1  the times at which y[0] passes the mark
//   fallen ... upright t1         when an angle is 1 rad off upright
//
// C++17, because Boost 1.74's ublas, which rosenbrock4 needs, uses what C++20 has removed.
#include <algorithm>
#include <boost/numeric/odeint.hpp>
#include <boost/numeric/ublas/matrix.hpp>
#include <boost/numeric/ublas/vector.hpp>
#include <boost/version.hpp>
#include <utility>

#include "conversation.hpp"
#include "hard_cases_systems.hpp"

namespace {

using namespace hard_cases;
using contenders::read_count, contenders::read_number, contenders::read_numbers, contenders::words;
namespace ode = boost::numeric::odeint;
namespace ublas = boost::numeric::ublas;
using Stiff = ublas::vector<double>;
using Matrix = ublas::matrix<double>;

Numbers read_list(std::istream& in) {
  const std::size_t count = read_count(in);
  return read_numbers(in, count);
}

struct Task {
  std::string system;
  Numbers parameters;
  std::string method;
  double atol, rtol, step;
  Numbers start;

  explicit Task(std::istream& in) {
    in >> system;
    parameters = read_list(in);
    in >> method;
    atol = read_number(in);
    rtol = read_number(in);
    step = read_number(in);
    start = read_list(in);
  }
  Rates rates() const { return hard_cases::system(system, parameters); }
  auto dense(double longest = 0) const {
    return longest > 0 ? ode::make_dense_output(atol, rtol, longest, dopri5())
                       : ode::make_dense_output(atol, rtol, dopri5());
  }
  static ode::runge_kutta_dopri5<Numbers> dopri5() { return {}; }
};

// One rod under a torque and friction with a smoothed sign, and its Jacobian. Its parameters are
// the friction and the rate of smoothing, then the weight's moment, or the bias and the amplitude
// of a torque bias + amplitude sin 2t.
struct Rubbed {
  Numbers p;
  bool by_weight;
  double torque(double t, double q) const {
    return by_weight ? p[2] * std::cos(q) : p[2] + p[3] * std::sin(2 * t);
  }
  void operator()(const Stiff& y, Stiff& f, double t) const {
    f[0] = y[1];
    f[1] = torque(t, y[0]) - p[0] * std::tanh(y[1] / p[1]);
  }
  void operator()(const Stiff& y, Matrix& j, double t, Stiff& by_time) const {
    const double s = std::tanh(y[1] / p[1]);
    j(0, 0) = 0;
    j(0, 1) = 1;
    j(1, 0) = by_weight ? -p[2] * std::sin(y[0]) : 0.0;
    j(1, 1) = -p[0] / p[1] * (1 - s * s);
    by_time[0] = 0;
    by_time[1] = by_weight ? 0.0 : 2 * p[3] * std::cos(2 * t);
  }
};

// The textbook's rods with a damper in joint 2 (parameter: its damping), or with friction of a
// smoothed sign in both (the frictions, the rate of smoothing, the amplitude of a torque
// amplitude sin t), with derivatives by differences.
struct Loaded {
  Numbers p;
  void operator()(const Stiff& y, Stiff& f, double t) const {
    if (p.size() == 1) return textbook(y, f, 0, -p[0] * (y[3] - y[2]));
    textbook(y, f, p[3] * std::sin(t) - p[0] * std::tanh(y[2] / p[2]),
             -p[1] * std::tanh((y[3] - y[2]) / p[2]));
  }
  void operator()(const Stiff& y, Matrix& j, double t, Stiff& by_time) const {
    Stiff plus(4), minus(4), at = y;
    for (std::size_t k = 0; k < 4; ++k) {
      const double step = 1e-6 * std::max(1e-3, std::abs(y[k]));
      at[k] = y[k] + step;
      (*this)(at, plus, t);
      at[k] = y[k] - step;
      (*this)(at, minus, t);
      at[k] = y[k];
      for (std::size_t i = 0; i < 4; ++i) j(i, k) = (plus[i] - minus[i]) / (2 * step);
    }
    (*this)(y, plus, t + 1e-6);
    (*this)(y, minus, t - 1e-6);
    by_time = (plus - minus) / 2e-6;
  }
};

template <class Stepper, class System, class State>
std::string integrate(Stepper stepper, System system, State y, double step, std::istream& in) {
  const double t0 = read_number(in), t1 = read_number(in);
  double t = t0;
  const auto steps = ode::integrate_adaptive(stepper, system, y, t0, t1, step,
                                             [&t](const State&, double now) { t = now; });
  return "t" + words({t}) + ";y" + words({y.begin(), y.end()}) + ";steps" +
         words({static_cast<double>(steps)});
}

template <class System>
std::string stiff(const std::string& word, const Task& task, const System& system,
                  std::istream& in) {
  const auto both = std::make_pair(system, system);
  Stiff y(task.start.size());
  std::copy(task.start.begin(), task.start.end(), y.begin());
  using Method = ode::rosenbrock4<double>;
  if (word == "integrate")
    return integrate(ode::make_controlled<Method>(task.atol, task.rtol), both, y, task.step, in);
  auto stepper = ode::make_dense_output<Method>(task.atol, task.rtol);
  stepper.initialize(y, 0.0, task.step);
  Numbers states;
  for (const double t : read_list(in)) {
    while (stepper.current_time() < t) stepper.do_step(both);
    stepper.calc_state(t, y);
    states.insert(states.end(), y.begin(), y.end());
  }
  return "states" + words(states);
}

template <class Method>
std::string controlled(const std::string& word, const Task& task, std::istream& in) {
  const auto stepper = ode::make_controlled(task.atol, task.rtol, Method());
  if (word == "integrate") return integrate(stepper, task.rates(), task.start, task.step, in);
  const Numbers times = read_list(in);
  Numbers y = task.start, states;
  ode::integrate_times(
      stepper, task.rates(), y, times.begin(), times.end(), task.step,
      [&states](const Numbers& x, double) { states.insert(states.end(), x.begin(), x.end()); });
  return "states" + words(states);
}

// The time in the stepper's last step at which the sign of `value` of the state changes.
template <class Stepper, class Value>
double bisect(Stepper& stepper, const Value& value) {
  Numbers shown(stepper.current_state().size());
  const auto above = [&](double t) {
    stepper.calc_state(t, shown);
    return value(shown) > 0;
  };
  double low = stepper.previous_time(), high = stepper.current_time();
  const bool first = above(low);
  for (int k = 0; k < 80; ++k) {
    const double middle = 0.5 * (low + high);
    (above(middle) == first ? low : high) = middle;
  }
  return high;
}

std::string bounces(const Task& task, std::istream& in) {
  const double t_end = read_number(in), restitution = read_number(in), capture = read_number(in);
  Numbers y = task.start, shown(2);
  double t = 0;
  while (t < t_end) {
    auto stepper = task.dense();
    const double flight = y[1] > 0 ? y[1] : 1.0;  // the flight takes 2 y[1]/2 s: begin within it
    stepper.initialize(y, t, 0.25 * flight);
    do {
      stepper.do_step(task.rates());
    } while (stepper.current_state()[0] > 0 && stepper.current_time() < t_end);
    if (stepper.current_state()[0] > 0) break;
    t = bisect(stepper, [](const Numbers& at) {
      return at[0] == 0 ? 1.0 : at[0];  // the start of a flight is on the stop
    });
    stepper.calc_state(t, shown);
    if (-shown[1] * restitution < capture) return "t" + words({t}) + ";q 0";
    y = {0, -restitution * shown[1]};
  }
  return "t -1;q" + words({y[0]});
}

std::string passages(const Task& task, std::istream& in) {
  const double mark = read_number(in), longest = read_number(in), t_end = read_number(in);
  const auto past = [mark](const Numbers& y) { return y[0] - mark; };
  auto stepper = task.dense(longest);
  stepper.initialize(task.start, 0.0, task.step);
  Numbers found;
  double before = -1;
  while (stepper.current_time() < t_end) {
    stepper.do_step(task.rates());
    const double now = past(stepper.current_state());
    if (before * now < 0) found.push_back(bisect(stepper, past));
    before = now;
  }
  return "t" + words(found);
}

std::string fallen(const Task& task, std::istream& in) {
  const double upright = read_number(in), t_end = read_number(in);
  const auto off = [upright](const Numbers& y) {
    return std::max(std::abs(y[0] - upright), std::abs(y[1] - upright)) - 1;
  };
  auto stepper = task.dense();
  stepper.initialize(task.start, 0.0, task.step);
  do {
    stepper.do_step(task.rates());
  } while (off(stepper.current_state()) < 0 && stepper.current_time() < t_end);
  return "t" + words({bisect(stepper, off)});
}

std::string answer(std::istream& in) {
  std::string word;
  in >> word;
  if (word == "version") return BOOST_LIB_VERSION;
  const Task task(in);
  if (word == "bounces") return bounces(task, in);
  if (word == "passages") return passages(task, in);
  if (word == "fallen") return fallen(task, in);
  if (task.system == "loaded") return stiff(word, task, Loaded{task.parameters}, in);
  if (task.method == "rosenbrock4")
    return stiff(word, task, Rubbed{task.parameters, task.system == "held"}, in);
  if (task.method == "fehlberg78")
    return controlled<ode::runge_kutta_fehlberg78<Numbers>>(word, task, in);
  return controlled<ode::runge_kutta_dopri5<Numbers>>(word, task, in);
}

}  // namespace

int main() { return contenders::converse(answer); }
