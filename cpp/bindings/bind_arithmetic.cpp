#include "arguments.hpp"
#include "arithmetic/floating_point_environment.hpp"
#include "arithmetic/sine_cosine.hpp"

namespace pendcore::bindings {

void bind_arithmetic(py::module_& module) {
  module.def(
      "sine_cosine",
      [](const Array& x) {
        const FloatingPointEnvironment ieee;
        const std::vector<py::ssize_t> shape(x.shape(), x.shape() + x.ndim());
        Array sine(shape);
        Array cosine(shape);
        sine_cosine(x.data(), x.size(), sine.mutable_data(), cosine.mutable_data());
        return py::make_tuple(sine, cosine);
      },
      py::arg("x"), "Sine and cosine of angles (rad), as the core computes them.");
  module.def(
      "instruction_set", [] { return name(instruction_set()); },
      "The instruction set in use: baseline, x86-64-v3 or x86-64-v4.");
}

}  // namespace pendcore::bindings
