// Boost.odeint on the hard cases, as an experienced user would write them: dopri5 with dense output
// or integrate_adaptive, fehlberg78 for high accuracy, rosenbrock4 for stiff cases. This is a
// module of Python, where the equations are stated once for all programs: rates(t, y) gives y', and
// derivatives(t, y) its Jacobian and its derivative by t.
//
// C++17, because Boost 1.74's ublas, which rosenbrock4 needs, uses what C++20 has removed.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <boost/numeric/odeint.hpp>
#include <boost/numeric/ublas/matrix.hpp>
#include <boost/numeric/ublas/vector.hpp>
#include <boost/version.hpp>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace {

namespace py = pybind11;
namespace ode = boost::numeric::odeint;
namespace ublas = boost::numeric::ublas;
using Numbers = std::vector<double>;
using Stiff = ublas::vector<double>;
using Matrix = ublas::matrix<double>;

template <class State>
py::array_t<double> shown(const State& y) {
  return py::array_t<double>(static_cast<py::ssize_t>(y.size()), &y[0]);
}

struct System {
  py::function rates, derivatives;
  template <class State>
  void operator()(const State& y, State& f, double t) const {
    const Numbers found = py::cast<Numbers>(rates(t, shown(y)));
    std::copy(found.begin(), found.end(), f.begin());
  }
  void operator()(const Stiff& y, Matrix& jacobian, double t, Stiff& by_time) const {
    using Both = std::pair<std::vector<Numbers>, Numbers>;
    const Both found = py::cast<Both>(derivatives(t, shown(y)));
    for (std::size_t i = 0; i < y.size(); ++i) {
      for (std::size_t j = 0; j < y.size(); ++j) jacobian(i, j) = found.first[i][j];
      by_time[i] = found.second[i];
    }
  }
};

struct Settings {
  double atol, rtol, first_step;
};

using Dopri5 = ode::runge_kutta_dopri5<Numbers>;
using Fehlberg78 = ode::runge_kutta_fehlberg78<Numbers>;
using Rosenbrock4 = ode::rosenbrock4<double>;

template <class State>
State as(const Numbers& y) {
  State copy(y.size());
  std::copy(y.begin(), y.end(), copy.begin());
  return copy;
}

// The last time and state, and the number of steps.
using End = std::tuple<double, Numbers, std::size_t>;
template <class Stepper, class System, class State>
End integrate(Stepper stepper, System system, State y, double t0, double t1, double step) {
  double t = t0;
  const auto steps = ode::integrate_adaptive(stepper, system, y, t0, t1, step,
                                             [&t](const State&, double now) { t = now; });
  return {t, {y.begin(), y.end()}, steps};
}

template <class Method>
std::vector<Numbers> at_times(const System& system, Numbers y, const Numbers& times,
                              const Settings& given) {
  std::vector<Numbers> states;
  ode::integrate_times(ode::make_controlled(given.atol, given.rtol, Method()), system, y,
                       times.begin(), times.end(), given.first_step,
                       [&states](const Numbers& x, double) { states.push_back(x); });
  return states;
}

std::vector<Numbers> stiff_at_times(const System& system, const Numbers& start,
                                    const Numbers& times, const Settings& given) {
  auto stepper = ode::make_dense_output<Rosenbrock4>(given.atol, given.rtol);
  auto y = as<Stiff>(start);
  stepper.initialize(y, 0.0, given.first_step);
  std::vector<Numbers> states;
  for (const double t : times) {
    while (stepper.current_time() < t) stepper.do_step(std::make_pair(system, system));
    stepper.calc_state(t, y);
    states.emplace_back(y.begin(), y.end());
  }
  return states;
}

// dopri5's steps with dense output, one by one; none is longer than the longest, if it is above 0.
class Dense {
 public:
  Dense(System system, const Numbers& y, double t, const Settings& given, double longest)
      : system_(std::move(system)),
        stepper_(longest > 0 ? ode::make_dense_output(given.atol, given.rtol, longest, Dopri5())
                             : ode::make_dense_output(given.atol, given.rtol, Dopri5())) {
    stepper_.initialize(y, t, given.first_step);
  }
  std::pair<double, double> step() { return stepper_.do_step(system_); }
  Numbers at(double t) {
    Numbers y(stepper_.current_state().size());
    stepper_.calc_state(t, y);
    return y;
  }

 private:
  System system_;
  decltype(ode::make_dense_output(1.0, 1.0, Dopri5())) stepper_;
};

}  // namespace

PYBIND11_MODULE(hard_cases_odeint, module) {
  module.attr("VERSION") = BOOST_LIB_VERSION;
  py::class_<System>(module, "System").def(py::init<py::function, py::function>());
  py::class_<Settings>(module, "Settings").def(py::init<double, double, double>());
  py::class_<Dense>(module, "Dense")
      .def(py::init<System, Numbers, double, Settings, double>())
      .def("step", &Dense::step)
      .def("at", &Dense::at);
  module.def("integrate", [](const std::string& method, const System& system, const Numbers& y,
                             double t0, double t1, const Settings& given) {
    const auto explicitly = [&](auto stepper) {
      return integrate(ode::make_controlled(given.atol, given.rtol, stepper), system, y, t0, t1,
                       given.first_step);
    };
    if (method == "rosenbrock4")
      return integrate(ode::make_controlled<Rosenbrock4>(given.atol, given.rtol),
                       std::make_pair(system, system), as<Stiff>(y), t0, t1, given.first_step);
    return method == "fehlberg78" ? explicitly(Fehlberg78()) : explicitly(Dopri5());
  });
  module.def("at_times", [](const std::string& method, const System& system, const Numbers& y,
                            const Numbers& times, const Settings& given) {
    if (method == "rosenbrock4") return stiff_at_times(system, y, times, given);
    return method == "fehlberg78" ? at_times<Fehlberg78>(system, y, times, given)
                                  : at_times<Dopri5>(system, y, times, given);
  });
}
