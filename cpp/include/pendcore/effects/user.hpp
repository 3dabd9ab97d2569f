/// \file
/// An effect of the user's own: a compiled function that gives generalised forces,
///
///     void f(double t, int n, const double* q, const double* qd, double* Q, void* data)
///
/// for the absolute angles, Q (n), N m. Q is zero on entry, and the result is added to the
/// equations. The address may be that of a C or C++ function, of a function that numba compiled, or
/// of a ctypes callback. The function must give the same forces for the same arguments. Power:
/// Q . qd. The joint reactions treat Q as couples, because they do not know what forces Q may stand
/// for. Where the forces jump at times that are known, `breaks` names them: the steps end there, as
/// at the points of a table, and between two breaks the function is called with times between them
/// only, whichever value it has at a break itself. The modes are the pieces between breaks. In C++,
/// any callable object can be used:
///
///     auto magnet = [&](double t, std::span<const double> q, std::span<const double> qd,
///                       std::span<double> Q) { Q[0] -= strength * std::sin(q[0]); };
///     scene.effects.push_back(CompiledUser::of(magnet));   // magnet must outlive the scene
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pendcore/effects/effect.hpp"

namespace pendcore {

struct CompiledUser {
  std::uintptr_t address = 0;       ///< of f
  std::uintptr_t data = 0;          ///< is passed to f
  std::vector<double> breaks = {};  ///< s, increasing

  static constexpr EffectInfo info{
      .name = "CompiledUser",
      .kind = "compiled_user",
      .sentence = "An effect of the user's own, as a compiled function of t, q and qd.",
      .law = "Q += f(t, q, qd)",
      .source = "the user's",
      .account = Account::user,
      .depends_on_time = true,
      .is_function = true,
      .examples =
          "from ctypes import CFUNCTYPE, POINTER, c_double, c_int, c_void_p\n"
          "@CFUNCTYPE(None, c_double, c_int, *[POINTER(c_double)] * 3, c_void_p)\n"
          "def damp(t, n, q, qd, Q, data):\n"
          "    Q[0] -= 0.1 * qd[0]\n"
          "CompiledUser(damp)",
      .outcome = "user: -0.339 J"};
  static constexpr auto parameters = std::tuple{
      parameter(&CompiledUser::address,
                {.name = "address",
                 .symbol = "f",
                 .sentence = "address of void f(double t, int n, const double* q, const double* "
                             "qd, double* Q, void* data)",
                 .required = true}),
      parameter(&CompiledUser::data,
                {.name = "data", .sentence = "passed to the function unchanged"}),
      parameter(&CompiledUser::breaks, {.name = "breaks",
                                        .unit = "s",
                                        .sentence = "times at which the forces may jump, "
                                                    "increasing"}),
  };
  /// Calls f(t, q, qd, Q) with spans, (n) each; f is not copied. An exception in f ends the run
  /// with Status::callback_error, and is in Solution::error.
  template <class Function>
  static CompiledUser of(Function& f) {
    const UserFunction call = [](double t, int n, const double* q, const double* qd, double* Q,
                                 void* data) {
      const std::size_t size = n;
      (*static_cast<Function*>(data))(t, std::span(q, size), std::span(qd, size),
                                      std::span(Q, size));
    };
    return {.address = reinterpret_cast<std::uintptr_t>(call),
            .data = reinterpret_cast<std::uintptr_t>(&f)};
  }
};

std::shared_ptr<const EffectBehaviour> behaviour(CompiledUser given);

}  // namespace pendcore
