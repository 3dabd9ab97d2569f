// Boost.odeint's dopri5 with dense output, at its best: the state a std::array of fixed size, the
// constants of the textbook's case literal (quicker than parameters), a loop of do_step and
// calc_state (quicker than integrate_times, which takes the last step apart), a first step that
// suits the tolerance, results written in place, no allocation.
#include <array>
#include <boost/numeric/odeint/stepper/generation.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>
#include <boost/version.hpp>
#include <cmath>
#include <cstddef>
#include <functional>
#include <vector>

#include "contender.hpp"

namespace contenders {
namespace {

using State = std::array<double, 4>;
namespace ode = boost::numeric::odeint;

struct Rates {
  void operator()(const State& y, State& f, double /*t*/) const {
    constexpr double g = 9.807;
    const double d = y[0] - y[1], a12 = 0.5 * std::cos(d), h = 0.5 * std::sin(d);
    const double r1 = 1.5 * g * std::cos(y[0]) - h * y[3] * y[3];
    const double r2 = 0.5 * g * std::cos(y[1]) + h * y[2] * y[2];
    const double determinant = 4.0 / 9 - a12 * a12;
    f = {y[2], y[3], (r1 / 3 - a12 * r2) / determinant, (4.0 / 3 * r2 - a12 * r1) / determinant};
  }
};

struct CountedRates : Rates {
  long long count = 0;
  void operator()(const State& y, State& f, double t) {
    ++count;
    Rates::operator()(y, f, t);
  }
};

template <class System>
void integrate(System& rates, State y, const std::vector<double>& times, double tolerance,
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

class OdeintRun : public Run {
 public:
  OdeintRun(const Case& given, double tolerance)
      : times_(given.times), tolerance_(tolerance), out_(given.times.size()) {
    const std::vector<double> unit{1.0, 1.0};
    if (given.masses != unit || given.lengths != unit || given.gravity != 9.807)
      throw Unsupported("its right-hand side is written for two rods of 1 kg and 1 m");
    for (std::size_t i = 0; i < 4; ++i) start_[i] = given.start[i];
  }
  void solve() override {
    Rates rates;
    integrate(rates, start_, times_, tolerance_, out_.data());
  }
  std::span<const double> states() const override { return {out_.front().data(), 4 * out_.size()}; }
  long long evaluations() override {
    CountedRates rates;
    integrate(rates, start_, times_, tolerance_, out_.data());
    return rates.count;
  }

 private:
  State start_{};
  std::vector<double> times_;
  double tolerance_;
  std::vector<State> out_;
};

}  // namespace

Contender odeint() {
  return {"odeint", "Boost.odeint dopri5, C++",
          "Boost.odeint " BOOST_LIB_VERSION
          ", runge_kutta_dopri5 with dense output, " CONTENDER_BUILD,
          [](const Case& given, double tolerance) {
            return std::make_unique<OdeintRun>(given, tolerance);
          }};
}

}  // namespace contenders
