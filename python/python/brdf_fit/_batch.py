"""Fits of many scans of the same angles."""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._angles import Floats, broadcast, numbers, radians

if TYPE_CHECKING:
    import pandas
    import xarray

#: What a status of :class:`BatchFit` means.
STATUS = (
    "fitted",
    "k2 = 0: no lobe",
    "kD = 0: no diffuse part",
    "k1 at an end of its range",
    "too few readings",
    "all readings are zero",
    "a reading is out of range",
)

COLUMNS = ("k2", "kd", "k1", "n", "p", "e_percent", "readings", "status")
STDERR_COLUMNS = ("k2_stderr", "kd_stderr", "k1_stderr", "n_stderr", "p_stderr")

WEIGHTS_AND_INTERVALS = (
    "weights and intervals=True are both given: expected one of them, because the intervals are those of readings "
    "without weights"
)


def interval_columns(parameter: str) -> tuple[str, str, str]:
    """The names of the columns of the standard error of a parameter and of the ends of its interval."""
    return f"{parameter}_standard_error", f"{parameter}_from", f"{parameter}_to"


@dataclass(frozen=True, slots=True)
class BatchFit:
    """The fits of many scans: one array for each column, in the shape of the scans without their last axis.

    A scan that cannot be fitted is NaN, and its ``status`` says why.
    """

    k2: Floats
    """Specular weight, dimensionless."""
    kd: Floats
    """Diffuse weight, dimensionless."""
    k1: Floats
    """Width of the facet distribution, dimensionless; NaN where k2 = 0."""
    n: Floats
    """Refractive index: as given, or as fitted."""
    p: Floats
    """Exponent of the facet distribution; 1 where the model has none."""
    e_percent: Floats
    """E of eq. (5) in percent."""
    readings: NDArray[np.uint32]
    """The number of readings that were taken and have a weight."""
    status: NDArray[np.uint8]
    """0 fitted, 1 no lobe (k2 = 0), 2 no diffuse part (kD = 0), 3 k1 at an end of its range; not fitted:
    4 too few readings, 5 all zero, 6 out of range. ``STATUS`` has the texts."""
    k2_stderr: Floats | None = None
    """Standard errors for noise of constant size in f_r cos theta, where ``errors=True``. Real scans have
    other errors as well, and these are then too small; NaN for a parameter at an end of its range."""
    kd_stderr: Floats | None = None
    """As ``k2_stderr``, of kD."""
    k1_stderr: Floats | None = None
    """As ``k2_stderr``, of k1."""
    n_stderr: Floats | None = None
    """As ``k2_stderr``, of n; NaN where n is not free."""
    p_stderr: Floats | None = None
    """As ``k2_stderr``, of p; NaN where p is not free."""
    standard_errors: dict[str, Floats] = field(default_factory=dict)
    """The standard error of each free parameter by its name, where ``intervals=True``: as ``stderr`` of
    :func:`brdf_fit.fit`, from errors of the readings that are estimated from the residuals of each scan, and
    not of constant size as those of ``k2_stderr``. NaN where there is none."""
    intervals: dict[str, Floats] = field(default_factory=dict)
    """The interval of 95 % of each free parameter by its name, shape (..., 2), where ``intervals=True``: the
    ``intervals`` of :func:`brdf_fit.fit`. An end is NaN where the interval is unbounded or not known."""

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of the columns."""
        return self.k2.shape

    @property
    def rms(self) -> Floats:
        """The rms of the residuals over that of the readings, both of f_r cos theta: sqrt(E), dimensionless."""
        return np.sqrt(self.e_percent / 100.0)

    def columns(self) -> dict[str, NDArray[Any]]:
        """The columns by name, without the standard errors and the intervals where there are none. The latter
        are ``k1_standard_error``, ``k1_from`` and ``k1_to``, as those of the command line."""
        found = ((name, getattr(self, name)) for name in (*COLUMNS, *STDERR_COLUMNS))
        columns = {name: column for name, column in found if column is not None}
        for name, interval in self.intervals.items():
            of_name = (self.standard_errors[name], interval[..., 0], interval[..., 1])
            columns.update(zip(interval_columns(name), of_name))
        return columns

    def to_frame(self) -> pandas.DataFrame:
        """A table of pandas with one row for each scan, in C order. Needs pandas."""
        import pandas

        return pandas.DataFrame({name: column.ravel() for name, column in self.columns().items()})

    def to_dataset(
        self, dims: Sequence[Hashable], coords: Mapping[Any, Any] | None = None
    ) -> xarray.Dataset:
        """A Dataset of xarray with these dimensions. Needs xarray."""
        import xarray

        return xarray.Dataset(
            {name: (tuple(dims), column) for name, column in self.columns().items()}, coords=coords
        )

    def _repr_html_(self) -> str:
        from ._html import batch

        return batch(self)

    def __repr__(self) -> str:
        return f"<BatchFit of {self.k2.size} scans, shape {self.shape}>"


class Geometry:
    """The angles of a scan, at which many scans are fitted.

    Making one takes 10 to 60 ms, as long as some thousand fits. It can be pickled; a process makes each
    one once.

    Args:
        psi: Incidence angle in radians, [0, pi/2). It broadcasts with the other angles.
        theta: Signed view angle in radians; positive at phi = 0 is the side of the source.
        phi: View azimuth from that of the source in radians.
        n: Refractive index, 1 to 1e5. It has no effect where the model fits n.
        model: ``three`` (k2, kD and k1), or another model of the command line, as ``three+n`` or ``ggx``.

    Raises:
        ValueError: An angle (with the number of its reading), n or the model is outside its domain, or the
            shapes do not broadcast.
    """

    __slots__ = ("_key", "_plan")

    _key: tuple[bytes, bytes, bytes, float, str]
    _plan: _native.BatchPlan

    def __init__(
        self,
        psi: ArrayLike | None = None,
        theta: ArrayLike | None = None,
        phi: ArrayLike | None = None,
        *,
        psi_deg: ArrayLike | None = None,
        theta_deg: ArrayLike | None = None,
        phi_deg: ArrayLike | None = None,
        n: float,
        model: str = "three",
    ) -> None:
        angles = radians(psi, theta, phi, psi_deg, theta_deg, phi_deg)
        _, flat = broadcast(("psi", "theta", "phi"), *angles)
        of_psi, of_theta, of_phi = (angle.tobytes() for angle in flat)
        self._key = (of_psi, of_theta, of_phi, float(n), model)
        self._plan = _plan(*self._key)

    @classmethod
    def from_degrees(
        cls,
        psi_deg: ArrayLike,
        theta_deg: ArrayLike,
        phi_deg: ArrayLike = 0.0,
        *,
        n: float,
        model: str = "three",
    ) -> Geometry:
        """The geometry of angles in degrees."""
        return cls(psi_deg=psi_deg, theta_deg=theta_deg, phi_deg=phi_deg, n=n, model=model)

    @classmethod
    def from_frame(cls, frame: Any, *, n: float, model: str = "three") -> Geometry:
        """The geometry of the columns ``psi_deg``, ``theta_deg`` and, where there is one, ``phi_deg`` of a
        DataFrame, a Dataset or a dictionary.

        Raises:
            KeyError: A column is missing.
        """
        phi_deg = frame["phi_deg"] if "phi_deg" in frame else 0.0
        return cls.from_degrees(frame["psi_deg"], frame["theta_deg"], phi_deg, n=n, model=model)

    @property
    def psi(self) -> Floats:
        """Incidence angles in radians, one for each reading; read-only."""
        return np.frombuffer(self._key[0])

    @property
    def theta(self) -> Floats:
        """Signed view angles in radians, one for each reading; read-only."""
        return np.frombuffer(self._key[1])

    @property
    def phi(self) -> Floats:
        """View azimuths in radians, one for each reading; read-only."""
        return np.frombuffer(self._key[2])

    @property
    def n(self) -> float:
        """Refractive index."""
        return self._key[3]

    @property
    def model(self) -> str:
        """The model."""
        return self._key[4]

    def __len__(self) -> int:
        return self.psi.size

    def __repr__(self) -> str:
        return f"<Geometry of {len(self)} readings, n={self.n}, model={self.model!r}>"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Geometry) and self._key == other._key

    def __hash__(self) -> int:
        return hash(self._key)

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, self._key

    def __dask_tokenize__(self) -> tuple[Any, ...]:
        return self._key

    def fit_many(
        self,
        scans: ArrayLike,
        *,
        weights: ArrayLike | None = None,
        errors: bool = False,
        intervals: bool = False,
        threads: int | None = None,
    ) -> BatchFit:
        """Fits scans, each to the global optimum.

        The GIL is released: other threads must not write to ``scans`` meanwhile. Arrays of float64 or float32
        in C or Fortran order are not copied. Ctrl+C ends the call. The result does not depend on the number
        of threads, and not on how the scans are divided among calls.

        Args:
            scans: f_r in 1/sr, shape (..., readings). NaN, or a masked value, is a
                reading that was not taken.
            weights: Weights of the readings of at least 0: shape (readings,) or that of the scans. Scans with
                weights or gaps take four times as long.
            errors: Whether to compute standard errors for noise of constant size: ``k1_stderr`` and so on.
            intervals: Whether to compute ``intervals`` and ``standard_errors`` by the full inference of single
                scans. It takes a few hundred times as long as the fits, and needs scans without weights.
            threads: The number of threads; None takes all cores. With 1, as the workers of an engine need it,
                no thread is started, except for intervals of scans of 8192 readings or more.

        Returns:
            One array of shape (...) for each column.

        Raises:
            ValueError: The last axis has not one value for each angle, a weight is negative, or weights and
                intervals are both given.
        """
        if intervals and weights is not None:
            raise ValueError(WEIGHTS_AND_INTERVALS)
        array = _readings("scans", scans)
        shape = array.shape[:-1]
        given = None
        if weights is not None:
            given = _readings("weights", weights)
            if given.dtype != array.dtype:
                given, array = given.astype(np.float64), array.astype(np.float64)
            given = _rows(given if given.ndim == 1 else _as_scans(given, array.shape))
        found = self._plan.fit_many(_rows(array), given, errors, intervals, threads)
        columns = {name: column.reshape(shape) for name, column in found.items()}
        standard_errors, ends = {}, {}
        for name in self._plan.free if intervals else ():
            standard_error, low, high = (columns.pop(column) for column in interval_columns(name))
            standard_errors[name] = standard_error
            ends[name] = np.stack([low, high], axis=-1)
        return BatchFit(**columns, standard_errors=standard_errors, intervals=ends)


def fit_many(
    psi: ArrayLike | None = None,
    theta: ArrayLike | None = None,
    phi: ArrayLike | None = None,
    scans: ArrayLike | None = None,
    *,
    psi_deg: ArrayLike | None = None,
    theta_deg: ArrayLike | None = None,
    phi_deg: ArrayLike | None = None,
    n: float,
    model: str = "three",
    weights: ArrayLike | None = None,
    errors: bool = False,
    intervals: bool = False,
    threads: int | None = None,
) -> BatchFit:
    """Fits scans of the same angles: ``Geometry(psi, theta, phi, n=n, model=model).fit_many(scans)``.

    A geometry that a process has used lately is kept, so that repeated calls do not make it anew.
    Arguments, result and errors are those of :class:`Geometry` and :meth:`Geometry.fit_many`.
    """
    if scans is None:
        raise TypeError("scans are missing: expected an array (..., readings) of f_r in 1/sr")
    geometry = Geometry(
        psi,
        theta,
        phi,
        psi_deg=psi_deg,
        theta_deg=theta_deg,
        phi_deg=phi_deg,
        n=n,
        model=model,
    )
    return geometry.fit_many(
        scans, weights=weights, errors=errors, intervals=intervals, threads=threads
    )


@lru_cache(maxsize=64)
def _plan(psi: bytes, theta: bytes, phi: bytes, n: float, model: str) -> _native.BatchPlan:
    return _native.BatchPlan(
        np.frombuffer(psi), np.frombuffer(theta), np.frombuffer(phi), n, model
    )


def _restored(psi: bytes, theta: bytes, phi: bytes, n: float, model: str) -> Geometry:
    angles = (np.frombuffer(angle) for angle in (psi, theta, phi))
    return Geometry(*angles, n=n, model=model)


def _readings(name: str, values: ArrayLike) -> NDArray[Any]:
    """An array of float64 or float32 with at least one axis. Other real numbers become float64."""
    array = numbers(name, values)
    if array.dtype not in (np.float64, np.float32) or not array.dtype.isnative:
        array = array.astype(np.float64)
    if array.ndim == 0:
        raise ValueError(f"{name} has no axis: expected the shape (..., readings)")
    return array


def _as_scans(weights: NDArray[Any], shape: tuple[int, ...]) -> NDArray[Any]:
    try:
        return np.broadcast_to(weights, shape)
    except ValueError:
        raise ValueError(
            f"weights have the shape {weights.shape}: expected {shape[-1:]}, or that of the scans, {shape}"
        ) from None


def _rows(array: NDArray[Any]) -> NDArray[Any]:
    """The array as (scans, readings), in C or Fortran order; copied only where it has neither."""
    count = math.prod(array.shape[:-1])
    rows = array.reshape(count, array.shape[-1])
    if rows.flags.f_contiguous and rows.flags.aligned:
        return rows
    return np.require(rows, requirements=["C", "ALIGNED"])
