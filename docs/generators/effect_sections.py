"""Sections of the pages in docs/effects that do not come from the descriptions of the core."""

from __future__ import annotations

COMPILED = """## In Python

The function may come from C or C++, or be compiled by numba:

```python
import ctypes
import pendcore as pc

DOUBLES = ctypes.POINTER(ctypes.c_double)
FORCES = ctypes.CFUNCTYPE(
    None, ctypes.c_double, ctypes.c_int, DOUBLES, DOUBLES, DOUBLES, ctypes.c_void_p
)


@FORCES
def damp(t, n, q, qd, Q, data):  # with numba: numba.cfunc(signature), at full speed
    for i in range(n):
        Q[i] -= 0.1 * qd[i]


rod = pc.Link(mass=1.0, length=1.0)
effect = pc.effects.CompiledUser(damp)  # or the address as an int; it keeps `damp` alive
scene = pc.Scene(links=[rod, rod], effects=[effect])
sol = pc.simulate(scene, q0=[0.5, 1.0], t_span=(0, 1), ledger=True)
print(sol.energy().ledger)
```

`Q` is zero when the function is called; its entries are generalised forces of the absolute angles,
N m. `data` is passed on unchanged. It is an address or a NumPy array; the function gets the
array's memory, so the array has to be C-contiguous float64, and any other is refused. Nothing
checks the address: a wrong address crashes the process.

An exception in a ctypes callback that is written in Python never reaches pendcore: ctypes prints
the exception and drops it, and the run goes on with the forces written so far, as a rule zero. For
a law in Python use [`User`](user.md), where an exception ends the run.

A function of C or C++ comes from a library of your own,
`CompiledUser(ctypes.CDLL("./laws.so").damp)`:

```cpp
extern "C" void damp(double t, int n, const double* q, const double* qd, double* Q, void* data) {
  for (int i = 0; i < n; ++i) Q[i] -= 0.1 * qd[i];
}
```

    g++ -O2 -shared -fPIC laws.cpp -o laws.so

## In C++

`pendcore::CompiledUser::of(f)` makes an effect from anything that can be called with time, angles,
rates and forces, the last three as `std::span`; `f` has to outlive the scene.
[examples/05_own_effect.cpp](../../examples/05_own_effect.cpp) has an example.
"""

MOVING_END = """## A moving end

The rest angle does not change in time. For a spring whose far end moves, to tow a joint or to
shake it, write a [function of your own](user.md). The function returns forces of the **absolute**
angles: a torque `tau` in joint j is `tau` on link j and `-tau` on link j-1.

```python
import numpy as np


def tow(t, q, qd):
    tau = -30.0 * (q[1] - q[0] - 0.2 * t)  # in joint 2; the end moves at 0.2 rad/s
    return np.array([-tau, tau])


towed = scene.replace(effects=[pc.effects.User(tow)])
run = pc.simulate(towed, q0=[0.5, 0.5], t_span=(0, 1), ledger=True)
print(run.energy().ledger.user[-1])  # the work of the spring on the rods, J
```

`sol.energy()` does not include the energy stored in such a spring; all its work is in the ledger's
`user`.
"""

IMPACTS = """## Counting impacts

At an impact `sol.t` holds the time twice, with the state before and after:

```python
import numpy as np

sol = pc.simulate(scene, q0=[0.5, 0.9], qd0=[0, 12], t_span=(0, 3), ledger=True)
k = np.flatnonzero(np.diff(sol.t) == 0)
print(sol.t[k], sol.qd[k], sol.qd[k + 1])  # times, rates before, rates after
```

This counts the impacts at all stops. It needs the kept steps, so it does not work with `t_eval` or
`store="end"`. Events count something else. A `JointAngle` at the stop finds only impacts that
follow a zero of the angle, so it misses the shortest bounces; a `RateZero` also finds the turns
between bounces.
"""

MORE = {"torsional_spring": MOVING_END, "joint_stop": IMPACTS}
"""Further sections by kind; each goes on from the example of its page."""
