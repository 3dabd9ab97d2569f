"""Random starts and parameters for ensembles, functions of a seed and an index alone.

Sample number k of a seed is the same however many samples are drawn: a larger ensemble has those of
a smaller one first. The generator is Philox (Salmon, Moraes, Dror and Shaw, SC11, 2011), NumPy's.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from pendcore._messages.arguments import Floats, at_least, real_array

Size = int | tuple[int, ...]


def uniform(low: npt.ArrayLike, high: npt.ArrayLike, size: Size, *, seed: int = 0) -> Floats:
    """Draw numbers that are uniform between two bounds.

    Parameters
    ----------
    low, high : array_like
        The bounds; ``low`` is included. They broadcast to ``size``.
    size : int or tuple of int
        The shape of the result: for the starts of m members of n links ``(m, n)``.
    seed : int, default 0
        Not negative. Two seeds give independent numbers.

    Returns
    -------
    ndarray
        Number k, counted along the last axis first, is a function of ``seed`` and k alone.

    Examples
    --------
    >>> few = pc.sampling.uniform(-np.pi, np.pi, (2, 2), seed=1)
    >>> many = pc.sampling.uniform(-np.pi, np.pi, (1000, 2), seed=1)
    >>> np.array_equal(few, many[:2])
    True
    """
    low, high = real_array("low", low, ""), real_array("high", high, "")
    _require_to_fit(_shape(size), low=low, high=high)
    return low + (high - low) * _shares(size, seed)


def normal(mean: npt.ArrayLike, deviation: npt.ArrayLike, size: Size, *, seed: int = 0) -> Floats:
    """Draw numbers of a normal distribution.

    Parameters
    ----------
    mean, deviation : array_like
        The mean and the standard deviation. They broadcast to ``size``.
    size, seed
        As in `uniform`.

    Returns
    -------
    ndarray
        Number k, counted along the last axis first, is a function of ``seed`` and k alone (Box and
        Muller, *Ann. Math. Statist.* 29 (1958), 610). On another machine the last bit may differ,
        with its logarithm and its cosine.

    Examples
    --------
    >>> masses = pc.sampling.normal(1.0, 0.01, 10_000, seed=7)
    >>> f"{masses.mean():.3f} kg, {masses.std():.3f} kg"
    '1.000 kg, 0.010 kg'
    """
    mean, deviation = real_array("mean", mean, ""), real_array("deviation", deviation, "")
    if (deviation < 0).any():
        raise ValueError(f"deviation = {deviation.min():g}: must be >= 0")
    shape = _shape(size)
    _require_to_fit(shape, mean=mean, deviation=deviation)
    radius, angle = np.moveaxis(_shares((*shape, 2), seed), -1, 0)
    drawn: Floats = np.sqrt(-2.0 * np.log1p(-radius)) * np.cos(2.0 * np.pi * angle)
    return mean + deviation * drawn


def _shape(size: Size) -> tuple[int, ...]:
    given = size if isinstance(size, tuple) else (size,)
    return tuple(at_least("size", one, 0) for one in given)


def _require_to_fit(shape: tuple[int, ...], **given: Floats) -> None:
    for name, values in given.items():
        try:
            fits = np.broadcast_shapes(values.shape, shape) == shape
        except ValueError:
            fits = False
        if not fits:
            raise ValueError(f"{name}: shape {values.shape}: does not broadcast to size = {shape}")


def _shares(size: Size, seed: int) -> Floats:
    """Return numbers from 0 to below 1: each takes one output of the generator."""
    key = at_least("seed", seed, 0)
    drawn: Floats = np.random.Generator(np.random.Philox(key=key)).random(_shape(size))
    return drawn


__all__ = ["normal", "uniform"]
__dir__ = __all__.copy
