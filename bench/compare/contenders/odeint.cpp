// Boost.odeint at its best: states of fixed size, a closed form with its constants in place, loops
// of single steps (quicker than integrate_times, which takes the last step apart), a first step
// that suits the tolerance, results written in place, no allocation.
#include <array>
#include <boost/numeric/odeint/stepper/controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/generation.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>
#include <boost/version.hpp>
#include <cmath>
#include <cstddef>
#include <functional>
#include <vector>

#include "solves.hpp"
#include "unit_rods.hpp"

namespace contenders {
namespace {

namespace ode = boost::numeric::odeint;

template <class Rods>
using StateOf = std::array<double, Rods::size>;

template <class Rods>
struct Rates {
  Rods rods;
  void operator()(const StateOf<Rods>& y, StateOf<Rods>& f, double /*t*/) const {
    rods(y.data(), f.data());
  }
};

template <class Rods>
struct CountedRates : Rates<Rods> {
  long long count = 0;
  void operator()(const StateOf<Rods>& y, StateOf<Rods>& f, double t) {
    ++count;
    Rates<Rods>::operator()(y, f, t);
  }
};

struct Dopri5 {
  template <class System, class State>
  static void integrate(System& rates, State y, const Numbers& times, double tolerance,
                        State* out) {
    auto stepper = ode::make_dense_output(tolerance, tolerance, ode::runge_kutta_dopri5<State>());
    stepper.initialize(y, times.front(), 0.5 * std::pow(tolerance, 0.2));
    *out++ = y;
    for (std::size_t k = 1; k < times.size();) {
      stepper.do_step(std::ref(rates));
      for (; k < times.size() && times[k] <= stepper.current_time(); ++k)
        stepper.calc_state(times[k], *out++);
    }
  }
};

// The method has no dense output. A step that would pass a time asked for ends there, and the step
// after it has the length that the control wanted before.
struct Fehlberg78 {
  template <class System, class State>
  static void integrate(System& rates, State y, const Numbers& times, double tolerance,
                        State* out) {
    auto stepper = ode::make_controlled(tolerance, tolerance, ode::runge_kutta_fehlberg78<State>());
    double now = times.front(), wished = 0.5 * std::pow(tolerance, 0.125);
    *out++ = y;
    for (std::size_t k = 1; k < times.size(); ++k) {
      while (now < times[k]) {
        const double left = times[k] - now;
        const bool last = wished >= left * (1 - 1e-12);
        double step = last ? left : wished;
        if (stepper.try_step(std::ref(rates), y, now, step) != ode::success)
          wished = step;
        else if (!last)
          wished = step;
        else {
          now = times[k];
          wished = std::max(wished, step);
        }
      }
      *out++ = y;
    }
  }
};

template <class Method, class Rods>
class OdeintRun : public Run {
 public:
  OdeintRun(const Rods& rods, const Given& given)
      : rates_{rods}, times_(given["times"]), tolerance_(given["setting"][0]), out_(times_.size()) {
    std::copy_n(given["start"].begin(), Rods::size, start_.begin());
  }
  void solve() override { Method::integrate(rates_, start_, times_, tolerance_, out_.data()); }
  std::span<const double> states() const override {
    return {out_.front().data(), Rods::size * out_.size()};
  }
  Counts counts() override {
    CountedRates<Rods> rates{rates_};
    Method::integrate(rates, start_, times_, tolerance_, out_.data());
    return {.evaluations = rates.count};
  }

 private:
  Rates<Rods> rates_;
  StateOf<Rods> start_{};
  Numbers times_;
  double tolerance_;
  std::vector<StateOf<Rods>> out_;
};

template <class Method>
Contender odeint(const std::string& name, const std::string& method, const std::string& output) {
  return {"odeint_" + name, "Boost.odeint " + method + ", C++",
          "Boost.odeint " BOOST_LIB_VERSION ", " + output + ", " CONTENDER_BUILD,
          [](const Given& given) {
            return with_rods(given, [&]<class Rods>(const Rods& rods) -> std::unique_ptr<Run> {
              return std::make_unique<OdeintRun<Method, Rods>>(rods, given);
            });
          }};
}

}  // namespace

std::vector<Contender> contenders() {
  return {odeint<Dopri5>("dopri5", "dopri5", "runge_kutta_dopri5 with dense output"),
          odeint<Fehlberg78>("rkf78", "RKF78",
                             "runge_kutta_fehlberg78, which has no dense output: steps end at the "
                             "times asked for")};
}

}  // namespace contenders
