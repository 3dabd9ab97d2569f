"""The polynomials of the core's sine, cosine and powers of two, made anew: Remez exchange.

Run it (``python tests/reference/minimax.py``) to print the coefficients of
cpp/src/arithmetic/{sine_cosine,power}.hpp with the largest error of each.
"""

from __future__ import annotations

from collections.abc import Callable

from mpmath import cos, factorial, floor, log, lu_solve, matrix, mp, mpf, pi, sin, sqrt

Function = Callable[[mpf], mpf]


def minimax(
    f: Function, weight: Function, low: mpf, high: mpf, degree: int
) -> tuple[list[mpf], mpf]:
    """Fit a polynomial with the smallest largest weighted error; return it and that error."""
    count = degree + 2
    middle, half = (low + high) / 2, (high - low) / 2
    points = [middle - half * cos(pi * k / (count - 1)) for k in range(count)]
    grid = [low + (high - low) * mpf(k) / 2000 for k in range(2001)]
    for _ in range(12):
        equations = matrix(count, count)
        for i, x in enumerate(points):
            for j in range(degree + 1):
                equations[i, j] = x**j
            equations[i, degree + 1] = (-1) ** i / weight(x)
        solution = lu_solve(equations, matrix([f(x) for x in points]))
        coefficients = [solution[j] for j in range(degree + 1)]
        errors = [weight(x) * (_value(coefficients, x) - f(x)) for x in grid]
        extrema = _alternating_extrema(errors)
        while len(extrema) > count:
            extrema.pop(0 if abs(errors[extrema[0]]) < abs(errors[extrema[-1]]) else -1)
        if len(extrema) < count:
            break
        points = [grid[k] for k in extrema]
    return coefficients, max(abs(e) for e in errors)


def _value(coefficients: list[mpf], x: mpf) -> mpf:
    return sum(c * x**j for j, c in enumerate(coefficients))


def _alternating_extrema(errors: list[mpf]) -> list[int]:
    """Places of the largest error of each stretch of one sign."""
    places: list[int] = []
    for k, error in enumerate(errors):
        neighbours = errors[max(k - 1, 0) : k + 2]
        if abs(error) < max(abs(e) for e in neighbours):
            continue
        if places and (errors[places[-1]] > 0) == (error > 0):
            if abs(error) > abs(errors[places[-1]]):
                places[-1] = k
        else:
            places.append(k)
    return places


def _series(first: int, z: mpf) -> mpf:
    """z^0/first! - z/(first + 2)! + ..., for z near 0."""
    return sum((-1) ** k * z**k / factorial(first + 2 * k) for k in range(8))


def sine_part(z: mpf) -> mpf:
    """(sin r - r) / r^3 at z = r^2."""
    r = sqrt(z)
    return -_series(3, z) if z < mpf("1e-6") else (sin(r) - r) / (r * z)


def cosine_part(z: mpf) -> mpf:
    """(cos r - 1 + r^2/2) / r^4 at z = r^2."""
    return _series(4, z) if z < mpf("1e-6") else (cos(sqrt(z)) - 1 + z / 2) / z**2


def log2_part(u: mpf) -> mpf:
    """log2(1 + u) / u."""
    return log(1 + u, 2) / u if u else 1 / log(mpf(2))


def fits() -> dict[str, tuple[list[mpf], mpf]]:
    """Return each polynomial of the core with its largest error."""
    tiny, square = mpf("1e-12"), (pi / 4) ** 2 * mpf("1.0001")
    root = 1 / sqrt(mpf(2))
    return {
        "sine": minimax(sine_part, lambda z: z * sqrt(z) / sin(sqrt(z)), tiny, square, 5),
        "cosine": minimax(cosine_part, lambda z: z * z / cos(sqrt(z)), tiny, square, 5),
        "exp2": minimax(lambda x: mpf(2) ** x, lambda x: mpf(2) ** -x, -mpf(1) / 2, mpf(1) / 2, 7),
        "log2": minimax(log2_part, lambda _: mpf(1), root - 1, 1 / root - 1, 10),
    }


def half_pi_parts() -> list[mpf]:
    """pi/2 in three parts: 33 bits, then doubles."""
    first = floor(pi / 2 * mpf(2) ** 32) / mpf(2) ** 32
    second = mpf(float(pi / 2 - first))
    return [first, second, mpf(float(pi / 2 - first - second))]


def two_over_pi_words(count: int) -> list[int]:
    """2/pi in words of 64 bits."""
    words, rest = [], 2 / pi
    for _ in range(count):
        rest *= mpf(2) ** 64
        words.append(int(floor(rest)))
        rest -= words[-1]
    return words


if __name__ == "__main__":
    mp.prec = 1400
    print("2/pi:", *(f"0x{word:016x}" for word in two_over_pi_words(20)))
    mp.dps = 50
    print("pi/2:", *(float(part).hex() for part in half_pi_parts()))
    for name, (coefficients, error) in fits().items():
        print(f"{name}: largest error 2^{float(log(error, 2)):.1f}")
        print(*(f"  {float(c).hex()}" for c in coefficients), sep="\n")
