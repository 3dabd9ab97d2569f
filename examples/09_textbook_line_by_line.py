"""Section 2.1 of the textbook, line by line: the MATLAB commands and their equals.

The MATLAB lines are the book's, marked with %. What stands below them is SymPy, by
pendcore.derive (`pip install ".[symbolic]"` in a clone), and every result is compared
with what the derivation has. At the end stand the book's figure, its function file
RR.m, and its inline function.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import pi
from pathlib import Path

import pendcore as pc
import sympy
from pendcore.derive.chain import of_differences

# %  L1 = 1; L2 = 1; m1 = 1; m2 = 1; g = 9.807;
# %  t = sym('t','real');
# MATLAB has numbers from here on; SymPy keeps the symbols, and the numbers come last.
rod = pc.Link(mass=1, length=1)
scene = pc.Scene(links=[rod, rod], gravity=9.807)
book = pc.derive.Derivation(scene)
s = book.symbols
(m1, m2), (L1, L2), g = s.masses, s.lengths, s.gravity
(q1, q2), (qdd1, qdd2) = s.q, s.qdd
diff = book.chain.velocity  # diff(..., t) of a point: angles and rates depend on time


def same(ours: Iterable[sympy.Expr], derived: Iterable[sympy.Expr]) -> bool:
    """Whether expressions are the same: in a normal form, their difference is 0."""
    return all(of_differences(a - b) == 0 for a, b in zip(ours, derived, strict=True))


def cross(a: tuple[sympy.Expr, ...], b: tuple[sympy.Expr, ...]) -> sympy.Expr:
    """Component along k of a x b."""
    return a[0] * b[1] - a[1] * b[0]


# %  xB = L1*cos(sym('q1(t)'));  yB = L1*sin(sym('q1(t)'));  rB = [xB yB 0];
xB, yB = L1 * sympy.cos(q1), L1 * sympy.sin(q1)
rB = (xB, yB)
# %  rC1 = rB/2;  vC1 = diff(rC1,t);  aC1 = diff(vC1,t);
rC1 = (xB / 2, yB / 2)
vC1 = diff(rC1)
aC1 = diff(vC1)
# %  xD = xB + L2*cos(sym('q2(t)'));  yD = yB + L2*sin(sym('q2(t)'));  rD = [xD yD 0];
xD, yD = xB + L2 * sympy.cos(q2), yB + L2 * sympy.sin(q2)
# %  rC2 = (rB + rD)/2;  vC2 = diff(rC2,t);  aC2 = diff(vC2,t);
rC2 = ((xB + xD) / 2, (yB + yD) / 2)
vC2 = diff(rC2)
aC2 = diff(vC2)
assert same(rC2, book.chain.centers[1])
assert same(aC2, book.chain.center_accelerations[1])
print(f"aC2 = [{s.text(aC2[0])},\n       {s.text(aC2[1])}]")

# %  omega1 = [0 0 diff('q1(t)',t)];  alpha1 = diff(omega1,t);     the same for link 2
alpha1, alpha2 = qdd1, qdd2

# %  G1 = [0 m1*g 0];  G2 = [0 m2*g 0];
G1, G2 = (sympy.Integer(0), m1 * g), (sympy.Integer(0), m2 * g)
# %  IC1 = m1*L1^2/12;  IA = IC1 + m1*(L1/2)^2;  IC2 = m2*L2^2/12;
IC1 = m1 * L1**2 / 12
IA = IC1 + m1 * (L1 / 2) ** 2
IC2 = m2 * L2**2 / 12
assert same((IC1, IC2), s.inertias)
print(f"IA = {s.text(IA)}")

# %  F21 = -m2*aC2 + G2;
F21 = (-m2 * aC2[0] + G2[0], -m2 * aC2[1] + G2[1])
forces = book.equations.forces[1]
assert same(F21, [book.equations.solved_forces[force] for force in forces])

# %  EqA = -IA*alpha1 + cross(rB,F21) + cross(rC1,G1);
# %  Eq2 = -IC2*alpha2 + cross(rB-rC2,-F21);
EqA = -IA * alpha1 + cross(rB, F21) + cross(rC1, G1)
Eq2 = -IC2 * alpha2 + cross((rB[0] - rC2[0], rB[1] - rC2[1]), (-F21[0], -F21[1]))
lines = book.equations.without_reactions
assert same((EqA, Eq2), [line.acting - line.inertia for line in lines])

# %  slist = {diff('q1(t)',t,2), ...};  nlist = {'ddq1', ...};
# %  eq1 = subs(EqA(3),slist,nlist);
# Nothing to replace: q1, qd1 and qdd1 are symbols of their own from the start.
# %  sol = solve(eq1,eq2,'ddq1, ddq2');
sol = sympy.solve([EqA, Eq2], [qdd1, qdd2])
put_in = dict(zip((qdd1, qdd2), book.accelerations, strict=True))
left_over = [sympy.together(line.subs(put_in)) for line in (EqA, Eq2)]
numerators = [sympy.fraction(line)[0] for line in left_over]
assert same(numerators, (0, 0))  # the derivation's solution solves the book's equations
at_start = {**book.values, q1: pi / 4, q2: pi / 3, s.qd[0]: 0, s.qd[1]: 0}
ddq1, ddq2 = (sol[one].subs(at_start) for one in (qdd1, qdd2))
print(f"ddq1 = {ddq1:.6f}, ddq2 = {ddq2:.6f} rad/s^2")

# %  dx2 = sol.ddq1; ... ; dx2dt = char(dx2); ...
# %  g = inline(sprintf(' [%s;%s;%s;%s]',dx1dt,dx2dt,dx3dt,dx4dt),'t','x');
Path("inline_function.m").write_text(book.to_octave_inline(), encoding="utf-8")

# %  fid = fopen('RR.m','w+');
# %  fprintf(fid,'function dx = RR(t,x)\n');  ...  fclose(fid);
Path("RR.m").write_text(book.to_octave("RR"), encoding="utf-8")

# %  t0 = 0; tf = 5; time = [0 tf];  x0 = [pi/4; 0; pi/3; 0];
# %  [t,xs] = ode45(g, time, x0);
# %  [t,xs] = ode45(@RR, time, x0);     the same with the function file
# MATLAB's x is (q1, qd1, q2, qd2). The method is ode45's; its tolerances are by default
# 1e-3 and 1e-6.
run = pc.simulate(scene, (0, 5), [pi / 4, pi / 3], [0, 0], method="ode45")
print(f"q1(5) = {run.q[-1, 0]:.6f}, q2(5) = {run.q[-1, 1]:.6f} rad")

# %  x1 = xs(:,1);  x3 = xs(:,3);
# %  subplot(2,1,1),plot(t,x1*180/pi,'r'),xlabel('t (s)'),ylabel('q1 (deg)'),grid,...
# %  subplot(2,1,2),plot(t,x3*180/pi,'b'),xlabel('t (s)'),ylabel('q2 (deg)'),grid
run.plot()[0].figure.savefig("textbook_line_by_line.png")
