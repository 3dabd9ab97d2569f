// The parts of the extension module; each is bound in a file of its own.
#include <pybind11/pybind11.h>

namespace pendcore::bindings {

void bind_effects(pybind11::module_& module);
void bind_events(pybind11::module_& module);
void bind_scene(pybind11::module_& module);
void bind_run(pybind11::module_& module);
void bind_options(pybind11::module_& module);
void bind_simulate(pybind11::module_& module);
void bind_watches(pybind11::module_& module);
void bind_lyapunov(pybind11::module_& module);
void bind_methods(pybind11::module_& module);
void bind_ensemble(pybind11::module_& module);
void bind_arithmetic(pybind11::module_& module);

}  // namespace pendcore::bindings

PYBIND11_MODULE(_core, module, pybind11::mod_gil_not_used()) {
  using namespace pendcore::bindings;
  module.doc() = "The compiled core: scenes, runs and methods as numbers and arrays.";
  module.attr("__version__") = PENDCORE_VERSION;
#if defined(__clang__)
  module.attr("compiler") = "clang " __clang_version__;
#else
  module.attr("compiler") = "GCC " __VERSION__;
#endif
  bind_effects(module);
  bind_events(module);
  bind_scene(module);
  bind_run(module);
  bind_options(module);
  bind_watches(module);
  bind_simulate(module);
  bind_lyapunov(module);
  bind_methods(module);
  bind_ensemble(module);
  bind_arithmetic(module);
}
