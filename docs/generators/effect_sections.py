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
effect = pc.effects.CompiledUser(damp)  # or an address, an int; it keeps `damp` alive
scene = pc.Scene(links=[rod, rod], effects=[effect])
sol = pc.simulate(scene, q0=[0.5, 1.0], t_span=(0, 1), ledger=True)
print(sol.energy().ledger)
```

Where the forces jump in time, `breaks` names the times: see [`User`](user.md).

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
extern "C" void damp(double t, int n, const double* q, const double* qd, double* Q,
                     void* data) {
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

JUMPS_OF_TABLES = """## A torque that jumps

With `hold=True` each torque holds until the next time, as a controller with a clock commands it;
the last one holds for no time. In a linear table, two equal times make a step: the first has the
torque before it, the second the torque after it.

```python
held = pc.effects.Table(t=[0.0, 0.1, 0.2, 1.0], torque=[2.0, -1.0, 0.5, 0.0], hold=True)
pulse = pc.effects.Table(t=[0, 0.4, 0.4, 0.5, 0.5, 1], torque=[0, 0, 3, 3, 0, 0])
driven = scene.replace(effects=[pc.effects.Motor(1, table=t) for t in (held, pulse)])
sol = pc.simulate(driven, q0=[0.5, 1.0], t_span=(0, 1), ledger=True)
print(sol.stats.limited_by_break)  # a step ends at each of these times
```

Angles and rates do not jump with the torque; accelerations and reactions do. At the time of a jump
they are those after it.
"""

JUMPS_OF_FUNCTIONS = """## Forces that jump

A function is taken to be smooth. At a jump the steps shrink until the errors are within the
tolerances, or a run ends with `step_too_small`. A law that jumps with the state, such as
`-sign(w)`, may creep on for minutes before it ends with `max_steps`: try such a law with
`time_limit=5`, and use `DryJointFriction` for friction. If the times of the jumps are known, name
them:

```python
def push(t, q, qd):
    return [2.0 if t < 0.5 else -2.0, 0.0]


pushed = scene.replace(effects=[pc.effects.User(push, breaks=[0.5])])
sol = pc.simulate(pushed, q0=[0.5, 1.0], t_span=(0, 1), ledger=True)
print(0.5 in sol.t)  # True: no step goes across it
```

The function is not called at a break itself but at the nearest double on the side of the step, so
`t < 0.5` and `t <= 0.5` give the same run. Accelerations and reactions at a break are those after
it. What jumps with the state, such as sign(w), has no times: use
[DryJointFriction](dry_joint_friction.md), or smooth the law.
"""

MORE = {
    "torsional_spring": MOVING_END,
    "joint_stop": IMPACTS,
    "motor": JUMPS_OF_TABLES,
    "user": JUMPS_OF_FUNCTIONS,
}
"""Further sections by kind; each goes on from the example of its page."""
