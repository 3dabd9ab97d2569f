#include <pybind11/stl.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <optional>
#include <span>
#include <unsupported/Eigen/MatrixFunctions>
#include <utility>
#include <vector>

#include "arguments.hpp"
#include "arithmetic/floating_point_environment.hpp"
#include "dynamics/cost.hpp"
#include "dynamics/equations_of_motion.hpp"
#include "kind_and_values.hpp"
#include "pendcore/effects/motor.hpp"
#include "pendcore/equations.hpp"
#include "pendcore/mechanics.hpp"
#include "simulate/initial_state.hpp"
#include "text/message.hpp"

namespace pendcore::bindings {
namespace {

using LinkNumbers = std::tuple<double, double, double, double>;

Scene make_scene(const std::vector<LinkNumbers>& links, double gravity, const py::list& effects) {
  Scene scene{.links = {}, .gravity = gravity, .effects = {}};
  for (const auto& [mass, length, center, inertia] : links) {
    scene.links.push_back({mass, length, center, inertia});
  }
  for (const py::handle effect : effects) scene.effects.push_back(make_effect(effect));
  check(scene);
  return scene;
}

/// Equations that a scene makes at its first call and keeps. One call uses them at a time: another
/// thread, or a function among the effects that calls its own scene, gets equations of its own.
template <class Made>
class Reused {
 public:
  template <class Make, class Use>
  auto use(const Make& make, const Use& use) {
    if (is_in_use_.test_and_set()) {
      Made other = make();
      return use(other);
    }
    try {
      if (!made_) made_.emplace(make());
      auto result = use(*made_);
      is_in_use_.clear();
      return result;
    } catch (...) {  // the equations may be in another mode
      made_.reset();
      is_in_use_.clear();
      throw;
    }
  }

 private:
  std::optional<Made> made_{};
  std::atomic_flag is_in_use_ = ATOMIC_FLAG_INIT;
};

/// A scene as Python holds it, with its equations.
struct SceneOfPython : Scene {
  explicit SceneOfPython(Scene scene) : Scene(std::move(scene)) {}

  template <class Use>
  auto with_equations(const Use& use) {
    return equations_.use([this] { return Equations(*this); }, use);
  }
  template <class Use>
  auto with_equations_of_motion(const Use& use) {
    return of_motion_.use([this] { return equations_of_motion(*this); }, use);
  }

 private:
  Reused<Equations> equations_;
  Reused<EquationsOfMotion> of_motion_;
};

/// The attribute `effects` keeps the functions among them alive, and the collector sees it: a
/// function may know the scene.
py::object scene_of_python(const std::vector<LinkNumbers>& links, double gravity,
                           const py::list& effects) {
  py::object scene = py::cast(std::make_unique<SceneOfPython>(make_scene(links, gravity, effects)));
  scene.attr("effects") = effects;
  return scene;
}

/// A row of an (m, n) array of the Python layer. The core refuses rows that are too long or short.
std::span<const double> row(const Array& array, py::ssize_t i) {
  return {array.data(i, 0), static_cast<std::size_t>(array.shape(1))};
}

/// An array of that shape with compute(i), a vector or a matrix, for each i along its first axis.
template <class Compute>
Array array_of(const std::vector<py::ssize_t>& shape, const Compute& compute) {
  const FloatingPointEnvironment ieee;
  Array result(shape);
  double* to = result.mutable_data();
  for (py::ssize_t i = 0; i < shape[0]; ++i) {
    const auto& one = compute(i);
    to = std::copy_n(one.data(), one.size(), to);
  }
  give_nan_one_sign(result);
  return result;
}

/// Without Equations, whose checks of every row would take a third of the time.
Array acceleration_rows(SceneOfPython& scene, const Array& t, const Array& q, const Array& qd) {
  const FloatingPointEnvironment ieee;
  const auto n = static_cast<py::ssize_t>(scene.links.size());
  if (q.shape(1) != n || qd.shape(1) != n) throw py::value_error("q and qd: must be (m, n)");
  return scene.with_equations_of_motion([&](const EquationsOfMotion& equations) {
    Array result({q.shape(0), n});
    for (py::ssize_t i = 0; i < q.shape(0); ++i) {
      accelerations(equations, t.at(i), q.data(i, 0), qd.data(i, 0), result.mutable_data(i, 0));
    }
    give_nan_one_sign(result);
    return result;
  });
}

/// The accelerations of one state, without the conversions to arrays of rows that many states need.
/// Returns nothing if t is not a finite number, or if q or qd are not n finite numbers: the caller
/// then says which.
std::optional<Array> acceleration_of_state(SceneOfPython& scene, py::handle t, py::handle q,
                                           py::handle qd) {
  const FloatingPointEnvironment ieee;
  const std::size_t n = scene.links.size();
  double time = 0.0;
  Vector state(2 * n);
  const std::span<double> angles(state.data(), n);
  const std::span<double> rates(state.data() + n, n);
  if (!take_plain(t, time) || !take_plain(q, angles) || !take_plain(qd, rates) ||
      !std::isfinite(time) || !state.allFinite()) {
    return std::nullopt;
  }
  return scene.with_equations_of_motion([&](const EquationsOfMotion& equations) {
    Array result(static_cast<py::ssize_t>(n));
    accelerations(equations, time, angles.data(), rates.data(), result.mutable_data());
    give_nan_one_sign(result);
    return result;
  });
}

/// The derivatives of the accelerations by the angles and by the rates, (m, n, n) each.
py::tuple jacobian_rows(SceneOfPython& scene, const Array& t, const Array& q, const Array& qd) {
  const py::ssize_t n = q.shape(1);
  Array by_q({q.shape(0), n, n});
  Array by_qd({q.shape(0), n, n});
  for (py::ssize_t i = 0; i < q.shape(0); ++i) {
    const Derivatives found = scene.with_equations(
        [&](Equations& equations) { return equations.jacobian(t.at(i), row(q, i), row(qd, i)); });
    std::copy_n(found.by_q.data(), n * n, by_q.mutable_data(i, 0, 0));
    std::copy_n(found.by_qd.data(), n * n, by_qd.mutable_data(i, 0, 0));
  }
  give_nan_one_sign(by_q);
  give_nan_one_sign(by_qd);
  return py::make_tuple(by_q, by_qd);
}

Array reaction_forces(SceneOfPython& scene, const Array& t, const Array& q, const Array& qd) {
  return scene.with_equations([&](Equations& equations) {
    return array_of({q.shape(0), q.shape(1), 2}, [&](py::ssize_t i) {
      return equations.reactions(t.at(i), row(q, i), row(qd, i));
    });
  });
}

/// The input that Python names by a joint, or by a text.
Input input_of(py::handle named) {
  if (PyLong_Check(named.ptr())) return {.joint = named.cast<int>()};
  const auto name = named.cast<std::string>();
  if (name == "pivot.x") return {.kind = Input::Kind::pivot_x};
  if (name == "pivot.y") return {.kind = Input::Kind::pivot_y};
  return {.kind = Input::Kind::parameter, .parameter = name};
}

py::array array_from(const Vector& found) {
  return copy({found.data(), static_cast<std::size_t>(found.size())});
}
py::array array_from(const Matrix& found) {
  const auto size = static_cast<std::size_t>(found.size());
  return copy({found.data(), size}, shape(found.rows(), found.cols()));
}

/// The state, its rate, A and B. Returns nothing if t is not a finite number, q not n finite
/// numbers, or qd neither n finite numbers nor one: the caller then says which. `torques` are held
/// in the joints that are the inputs, or None.
std::optional<py::tuple> linearize(SceneOfPython& scene, py::handle t, py::handle q, py::handle qd,
                                   const py::tuple& inputs, py::handle torques) {
  const std::size_t n = scene.links.size();
  std::vector<Input> given;
  given.reserve(inputs.size());
  for (const py::handle input : inputs) given.push_back(input_of(input));
  double time = 0.0, rate = 0.0;
  Vector state(2 * n);
  if (take_plain(qd, rate)) {
    state.tail(n).setConstant(rate);
  } else if (!take_plain(qd, {state.data() + n, n})) {
    return std::nullopt;
  }
  if (!take_plain(t, time) || !take_plain(q, {state.data(), n}) || !std::isfinite(time) ||
      !state.allFinite()) {
    return std::nullopt;
  }
  const Numbers angles(state.head(n)), rates(state.tail(n));
  Linearization found;
  if (torques.is_none()) {
    found = scene.with_equations(
        [&](Equations& equations) { return equations.linearize(time, angles, rates, given); });
  } else {
    const std::vector<double> held = numbers("torques", torques, "(k,)", given.size());
    require_size("torques", held, given.size());
    Scene driven = scene;
    for (std::size_t k = 0; k < given.size(); ++k) {
      driven.effects.push_back(Motor{.joint = given[k].joint, .constant = held[k]});
    }
    found = Equations(driven).linearize(time, angles, rates, given);
  }
  return py::make_tuple(array_from(state), array_from(found.drift), array_from(found.A),
                        array_from(found.B));
}

py::array matrix_exponential(const Array& given) {
  const FloatingPointEnvironment ieee;
  const py::ssize_t n = given.shape(0);
  const Matrix exponential = Eigen::Map<const Matrix>(given.data(), n, n).exp();
  return array_from(exponential);
}

}  // namespace

void bind_scene(py::module_& module) {
  module.def("matrix_exponential", &matrix_exponential, py::arg("matrix"));
  module.def("scene", &scene_of_python, py::arg("links"), py::arg("gravity"), py::arg("effects"));
  const py::class_<Scene> any_scene(module, "AnyScene");
  py::class_<SceneOfPython, Scene>(module, "Scene", py::dynamic_attr(),
                                   "A scene that was checked, as the core holds it.")
      .def_property_readonly("n", [](const Scene& scene) { return scene.links.size(); })
      .def_property_readonly("warnings", &plausibility_warnings)
      .def(
          "run_warnings",
          [](const Scene& scene, const std::vector<double>& q0, double t0, double t_end) {
            return run_warnings(scene, q0, t0, t_end);
          },
          py::arg("q0"), py::arg("t0"), py::arg("t_end"))
      .def("accelerations", &acceleration_rows, py::arg("t"), py::arg("q"), py::arg("qd"))
      .def("acceleration_of_state", &acceleration_of_state, py::arg("t"), py::arg("q"),
           py::arg("qd"))
      .def("jacobian", &jacobian_rows, py::arg("t"), py::arg("q"), py::arg("qd"))
      .def("linearize", &linearize, py::arg("t"), py::arg("q"), py::arg("qd"), py::arg("inputs"),
           py::arg("torques"))
      .def(
          "trim",
          [](SceneOfPython& scene, double t, const std::vector<double>& q,
             const py::tuple& joints) {
            std::vector<int> given;
            for (const py::handle joint : joints) {
              const Input input = input_of(joint);
              if (input.kind != Input::Kind::torque) {
                throw py::value_error("inputs: " + joint.cast<std::string>() +
                                      ": must be a joint, or its torque");
              }
              given.push_back(input.joint);
            }
            return scene.with_equations(
                [&](Equations& equations) { return array_from(equations.trim(t, q, given)); });
          },
          py::arg("t"), py::arg("q"), py::arg("joints"))
      .def(
          "inverse_dynamics",
          [](SceneOfPython& scene, const Array& t, const Array& q, const Array& qd,
             const Array& qdd) {
            return scene.with_equations([&](Equations& equations) {
              return array_of({q.shape(0), q.shape(1)}, [&](py::ssize_t i) {
                return equations.inverse_dynamics(t.at(i), row(q, i), row(qd, i), row(qdd, i));
              });
            });
          },
          py::arg("t"), py::arg("q"), py::arg("qd"), py::arg("qdd"))
      .def("reactions", &reaction_forces, py::arg("t"), py::arg("q"), py::arg("qd"))
      .def(
          "mass_matrix",
          [](SceneOfPython& scene, const Array& q) {
            return scene.with_equations([&](Equations& equations) {
              return array_of({q.shape(0), q.shape(1), q.shape(1)},
                              [&](py::ssize_t i) { return equations.mass_matrix(row(q, i)); });
            });
          },
          py::arg("q"))
      .def(
          "positions",
          [](const Scene& scene, const Array& t, const Array& q) {
            return array_of({q.shape(0), q.shape(1) + 1, 2},
                            [&](py::ssize_t i) { return positions(scene, t.at(i), row(q, i)); });
          },
          py::arg("t"), py::arg("q"))
      .def(
          "velocities",
          [](const Scene& scene, const Array& t, const Array& q, const Array& qd) {
            return array_of({q.shape(0), q.shape(1) + 1, 2}, [&](py::ssize_t i) {
              return velocities(scene, t.at(i), row(q, i), row(qd, i));
            });
          },
          py::arg("t"), py::arg("q"), py::arg("qd"))
      .def(
          "mass_centers",
          [](const Scene& scene, const Array& t, const Array& q) {
            return array_of({q.shape(0), q.shape(1), 2},
                            [&](py::ssize_t i) { return mass_centers(scene, t.at(i), row(q, i)); });
          },
          py::arg("t"), py::arg("q"))
      .def(
          "energy",
          [](const Scene& scene, const Array& t, const Array& q, const Array& qd) {
            const FloatingPointEnvironment ieee;
            Array kinetic(q.shape(0));
            Array potential(q.shape(0));
            for (py::ssize_t i = 0; i < q.shape(0); ++i) {
              kinetic.mutable_at(i) = kinetic_energy(scene, t.at(i), row(q, i), row(qd, i));
              potential.mutable_at(i) = potential_energy(scene, t.at(i), row(q, i));
            }
            give_nan_one_sign(kinetic);
            give_nan_one_sign(potential);
            return py::make_tuple(kinetic, potential);
          },
          py::arg("t"), py::arg("q"), py::arg("qd"))
      .def("costs",
           [](const Scene& scene) {
             py::list result;
             for (const Cost& cost : costs(scene)) {
               result.append(py::make_tuple(cost.what, cost.operations, cost.nanoseconds));
             }
             return result;
           })
      .def("mobility", [](const Scene& scene) {
        const Mobility m = mobility(scene);
        return py::make_tuple(m.links, m.c5, m.c4, m.degrees_of_freedom);
      });
}

}  // namespace pendcore::bindings
