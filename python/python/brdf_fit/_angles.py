"""Angles in radians or degrees, and the shapes of arrays."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]


def radians(
    psi: ArrayLike | None,
    theta: ArrayLike | None,
    phi: ArrayLike | None,
    psi_deg: ArrayLike | None,
    theta_deg: ArrayLike | None,
    phi_deg: ArrayLike | None,
) -> tuple[Floats, Floats, Floats]:
    """The three angles in radians, each given in radians or in degrees; phi is 0 where neither is given.

    Raises TypeError where an angle is given in both units, or psi or theta in none.
    """
    return (
        _one("psi", psi, psi_deg),
        _one("theta", theta, theta_deg),
        _one("phi", phi, phi_deg, default=0.0),
    )


def radians_of(name: str, value: ArrayLike | None, value_deg: ArrayLike | None) -> Floats:
    """One angle in radians, given in radians or in degrees."""
    return _one(name, value, value_deg)


def _one(
    name: str, value: ArrayLike | None, value_deg: ArrayLike | None, default: float | None = None
) -> Floats:
    if value is not None and value_deg is not None:
        raise TypeError(f"{name} and {name}_deg are both given: expected one of them")
    if value is not None:
        return floats(name, value)
    if value_deg is not None:
        return np.deg2rad(floats(f"{name}_deg", value_deg))
    if default is None:
        raise TypeError(f"neither {name} (radians) nor {name}_deg (degrees) is given")
    return np.asarray(default)


def floats(name: str, value: ArrayLike) -> Floats:
    """An array of float64; masked values are NaN.

    Raises TypeError for what is not a real number: complex numbers, texts, objects.
    """
    return numbers(name, value).astype(np.float64, copy=False)


def numbers(name: str, value: ArrayLike) -> NDArray[Any]:
    """An array of real numbers of any type; masked values are NaN."""
    array = np.asarray(value)
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{name} has the type {array.dtype}: expected real numbers")
    mask = np.ma.getmask(value)
    if mask is np.ma.nomask:
        return array
    return np.where(mask, array.dtype.type(np.nan) if array.dtype.kind == "f" else np.nan, array)


def broadcast(
    names: tuple[str, ...], *arrays: NDArray[Any]
) -> tuple[tuple[int, ...], list[NDArray[Any]]]:
    """The common shape of arrays, and the arrays in this shape with one axis, contiguous.

    Raises ValueError where the shapes do not broadcast.
    """
    shape = arrays[0].shape
    # Most calls have arrays of one shape; NumPy's functions would take longer than all else of a call.
    if all(array.shape == shape for array in arrays):
        return shape, [_flat(array, shape) for array in arrays]
    try:
        shape = np.broadcast(*arrays).shape
    except ValueError:
        shapes = ", ".join(f"{name} {array.shape}" for name, array in zip(names, arrays))
        raise ValueError(f"the shapes do not broadcast: {shapes}") from None
    return shape, [_flat(array, shape) for array in arrays]


def _flat(array: NDArray[Any], shape: tuple[int, ...]) -> NDArray[Any]:
    """The array in this shape as one axis, copied only where it is broadcast or strided."""
    if array.shape != shape:
        array = np.broadcast_to(array, shape)
    if array.flags.c_contiguous and array.flags.aligned:
        return array if array.ndim == 1 else array.reshape(-1)
    return np.require(array, requirements=["C", "ALIGNED"]).reshape(-1)
