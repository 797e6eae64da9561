"""Values, reflectances and samples of a BRDF."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._angles import Floats, broadcast, floats, radians, radians_of


def evaluate(
    psi: ArrayLike | None = None,
    theta: ArrayLike | None = None,
    phi: ArrayLike | None = None,
    *,
    psi_deg: ArrayLike | None = None,
    theta_deg: ArrayLike | None = None,
    phi_deg: ArrayLike | None = None,
    k2: ArrayLike,
    kd: ArrayLike,
    k1: ArrayLike,
    n: ArrayLike,
    p: ArrayLike = 1.0,
    model: str = "three",
) -> Floats:
    """f_r in 1/sr, in the shape to which angles and parameters broadcast.

    The values have the digits of ``brdf_core::AnyBrdf::value``, on every machine. For many points of one
    BRDF within a tolerance, :class:`Plan` is faster.

    Args:
        psi: Incidence angle in radians, [0, pi/2); or ``psi_deg`` in degrees.
        theta: Signed view angle in radians, or ``theta_deg``; positive at phi = 0 is the side of the source,
            so that theta = -psi is the mirror direction.
        phi: View azimuth from that of the source in radians, or ``phi_deg``.
        k2: Specular weight; and so on as in :class:`Parameters`. The results of ``fit_many`` can be given as
            they are: a NaN is NaN in the result, but for k1 where k2 = 0.
        model: The model.

    Raises:
        ValueError: An angle or a parameter is outside its domain (with its number in C order), or the shapes
            do not broadcast.
    """
    angles = radians(psi, theta, phi, psi_deg, theta_deg, phi_deg)
    names = ("k2", "kd", "k1", "n", "p")
    values = [floats(name, value) for name, value in zip(names, (k2, kd, k1, n, p))]
    if all(value.ndim == 0 for value in values) and not any(np.isnan(value) for value in values):
        shape, flat = broadcast(("psi", "theta", "phi"), *angles)
        found = _native.evaluate(flat, [float(value) for value in values], model)
    else:
        shape, flat = broadcast(("psi", "theta", "phi", *names), *angles, *values)
        found = _native.evaluate_each(flat[:3], flat[3:], model)
    return found.reshape(shape)


def hemispherical_reflectance(
    psi: ArrayLike | None = None,
    *,
    psi_deg: ArrayLike | None = None,
    k2: float,
    kd: float,
    k1: float,
    n: float,
    p: float = 1.0,
    model: str = "three",
    tolerance: float = 1e-6,
) -> Floats:
    """The directional-hemispherical reflectance rho(psi), dimensionless, in the shape of psi.

    Args:
        psi: Incidence angle in radians, [0, pi/2); or ``psi_deg`` in degrees.
        tolerance: Relative tolerance of the integral, above 0 and below 1.

    Raises:
        ValueError: An angle, a parameter or the tolerance is outside its domain.
    """
    shape, (flat,) = broadcast(("psi",), radians_of("psi", psi, psi_deg))
    parameters = _scalars(k2, kd, k1, n, p)
    return _native.hemispherical_reflectance(flat, parameters, model, tolerance).reshape(shape)


@dataclass(frozen=True, slots=True)
class Samples:
    """Directions that were drawn."""

    direction: Floats
    """Unit vectors towards the viewer, shape (..., 3); NaN where the facet that was drawn mirrors the source
    below the surface."""
    pdf: Floats
    """Density of the directions in 1/sr, shape (...)."""
    weight: Floats
    """f_r cos theta / pdf, dimensionless, shape (...); 0 where the direction is NaN. Its mean is the
    hemispherical reflectance."""


def sample(
    source: ArrayLike,
    u: ArrayLike,
    *,
    k2: float,
    kd: float,
    k1: float,
    n: float,
    p: float = 1.0,
    model: str = "three",
) -> Samples:
    """Draws view directions with a density that resembles f_r cos theta.

    The first call for a BRDF takes some milliseconds; the preparation is kept for later ones.

    Args:
        source: Unit vectors towards the source, shape (..., 3), with z along the surface normal.
        u: Random numbers in [0, 1), shape (..., 3): for the lobe and for the direction.

    Raises:
        ValueError: A source is not a unit vector above the surface, or a parameter is outside its domain.
    """
    shape, (sources, numbers) = _vectors(("source", "u"), source, u)
    direction, pdf, weight = _sampler(_scalars(k2, kd, k1, n, p), model).sample(sources, numbers)
    return Samples(direction.reshape(*shape, 3), pdf.reshape(shape), weight.reshape(shape))


def pdf(
    source: ArrayLike,
    view: ArrayLike,
    *,
    k2: float,
    kd: float,
    k1: float,
    n: float,
    p: float = 1.0,
    model: str = "three",
) -> Floats:
    """The density in 1/sr with which :func:`sample` draws a view, per solid angle of the view.

    Args:
        source: Unit vectors towards the source, shape (..., 3).
        view: Unit vectors towards the viewer, shape (..., 3).

    Raises:
        ValueError: A direction is not a unit vector above the surface, or a parameter is outside its domain.
    """
    shape, (sources, views) = _vectors(("source", "view"), source, view)
    return _sampler(_scalars(k2, kd, k1, n, p), model).pdf(sources, views).reshape(shape)


class Plan:
    """The fastest evaluation of one BRDF within a tolerance on this machine. Making one takes some tens of
    milliseconds.

    Args:
        tolerance: Largest relative error of f_r, for angles as they are given.
        psi_max_deg: Largest incidence angle in degrees.
        theta_max_deg: Largest view angle in degrees.
        evaluations: The number of evaluations, over which the time of making an evaluator is distributed.
        cosines: Whether points are the cosines of psi, theta and phi instead of the angles.

    Raises:
        ValueError: No evaluator is within the tolerance, or an argument is outside its domain.
    """

    __slots__ = ("_plan",)

    def __init__(
        self,
        *,
        k2: float,
        kd: float,
        k1: float,
        n: float,
        p: float = 1.0,
        model: str = "three",
        tolerance: float = 1e-3,
        psi_max_deg: float = 85.0,
        theta_max_deg: float = 85.0,
        evaluations: float = 1e8,
        cosines: bool = False,
    ) -> None:
        psi_max, theta_max = np.deg2rad([psi_max_deg, theta_max_deg]).tolist()
        parameters = _scalars(k2, kd, k1, n, p)
        self._plan = _native.Plan(
            parameters, model, tolerance, psi_max, theta_max, evaluations, cosines
        )

    @property
    def name(self) -> str:
        """The name of the evaluator."""
        return self._plan.name

    @property
    def max_error(self) -> float | None:
        """The largest relative error that was measured in the domain."""
        return self._plan.max_error

    def evaluate_many(
        self, psi: ArrayLike, theta: ArrayLike, phi: ArrayLike = 0.0, *, threads: int | None = None
    ) -> NDArray[Any]:
        """f_r in 1/sr at many points: angles in radians, or cosines where the plan says so.

        Arrays of one shape and type, float64 or float32, are not copied, and the result has their type.
        Points outside the domain of the model are NaN.

        Args:
            threads: The number of threads; None takes all cores.

        Raises:
            ValueError: The shapes do not broadcast.
        """
        given = [np.asarray(values) for values in (psi, theta, phi)]
        arrays = [values for values in given if values.ndim > 0] or given
        single = all(values.dtype == np.float32 for values in arrays)
        floats_given = [floats("a coordinate", values) for values in given] if not single else given
        shape, flat = broadcast(("psi", "theta", "phi"), *floats_given)
        if single:
            flat = [values.astype(np.float32, copy=False) for values in flat]
        return self._plan.evaluate(flat, threads).reshape(shape)

    def __repr__(self) -> str:
        return f"<Plan {self.name!r}>"


def _scalars(*values: float) -> tuple[float, ...]:
    return tuple(float(value) for value in values)


@lru_cache(maxsize=64)
def _sampler(parameters: tuple[float, ...], model: str) -> _native.Sampler:
    return _native.Sampler(parameters, model)


def _vectors(names: tuple[str, str], *values: ArrayLike) -> tuple[tuple[int, ...], list[Floats]]:
    arrays = [floats(name, value) for name, value in zip(names, values)]
    for name, array in zip(names, arrays):
        if array.shape[-1:] != (3,):
            raise ValueError(f"{name} has the shape {array.shape}: expected (..., 3)")
    shape, flat = broadcast(names, *arrays)
    return shape[:-1], [array.reshape(-1, 3) for array in flat]
