"""The fit of one scan."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from . import _native
from ._angles import Floats
from ._brdf import evaluate
from ._parameters import Parameters
from ._scan import Scan

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class Interval(NamedTuple):
    """A confidence interval of 95 %; an end is NaN where the interval is unbounded or not known."""

    low: float
    high: float


@dataclass(frozen=True, slots=True)
class FitWarning:
    """What limits the meaning of a fit."""

    kind: str
    """The kind in a word, as ``few-incidences``."""
    text: str
    """The sentence."""

    def __str__(self) -> str:
        return self.text


@dataclass(frozen=True, slots=True)
class Fit:
    """The fit of one scan."""

    parameters: Parameters
    """The fitted parameters."""
    intervals: dict[str, Interval]
    """The interval of 95 % of each free parameter by its name: k2, kd, k1, n, p."""
    stderr: dict[str, float]
    """The standard error of each free parameter by its name; NaN where there is none."""
    e_percent: float
    """E of eq. (5) in percent."""
    readings: int
    """The number of fitted readings."""
    status: str
    """How the fit ended: ``ok``, ``global`` where the check of the global optimum found a lower minimum,
    ``iteration-limit``."""
    warnings: tuple[FitWarning, ...]
    """What limits the meaning of the fit."""
    wavelength_um: float | None
    """Wavelength in micrometres, where the scan states one."""
    scan: Scan = field(repr=False, compare=False)
    """The scan."""
    _report: _native.Report = field(repr=False, compare=False)

    @property
    def rms(self) -> float:
        """The rms of the residuals over that of the readings, both of f_r cos theta: sqrt(E), dimensionless."""
        return math.sqrt(self.e_percent / 100.0)

    def evaluate(
        self,
        psi: ArrayLike | None = None,
        theta: ArrayLike | None = None,
        phi: ArrayLike | None = None,
        *,
        psi_deg: ArrayLike | None = None,
        theta_deg: ArrayLike | None = None,
        phi_deg: ArrayLike | None = None,
    ) -> Floats:
        """f_r of the fit in 1/sr; see :func:`brdf_fit.evaluate`."""
        return evaluate(
            psi,
            theta,
            phi,
            psi_deg=psi_deg,
            theta_deg=theta_deg,
            phi_deg=phi_deg,
            **self.parameters.to_dict(),
        )

    def residuals(self) -> Floats:
        """Readings less the fit in 1/sr, in the order of the scan."""
        scan = self.scan
        return scan.brdf - self.evaluate(scan.psi, scan.theta, scan.phi)

    def report(self, details: bool = False) -> str:
        """The report as text, as the command line prints it."""
        return self._report.detailed_text() if details else self._report.text()

    def to_json(self) -> str:
        """The document of fits with this one, as the command line writes it with ``--json``."""
        return self._report.to_json()

    def plot(self, ax: Axes | None = None) -> Axes:
        """Readings and fit over theta, one colour for each incidence. Needs Matplotlib."""
        from ._plot import plot_fit

        return plot_fit(self, ax)

    def _repr_html_(self) -> str:
        from ._html import fit

        return fit(self)

    def __reduce__(self) -> tuple[Any, ...]:
        return _fit_from_json, (self.to_json(), self.scan)


def fit(
    psi: Scan | ArrayLike | None = None,
    theta: ArrayLike | None = None,
    phi: ArrayLike | None = None,
    brdf: ArrayLike | None = None,
    *,
    psi_deg: ArrayLike | None = None,
    theta_deg: ArrayLike | None = None,
    phi_deg: ArrayLike | None = None,
    sigma: ArrayLike | None = None,
    wavelength_um: float | None = None,
    n: float | None = None,
    model: str = "three",
    weights: str = "constant",
    robust: str | None = None,
    fixed: Mapping[str, float] | None = None,
    energy_limit_deg: float | None = None,
    global_check: bool = True,
    depth: str = "fit",
    threads: int | None = None,
) -> Fit:
    """Fits a scan in two stages, with the check of the global optimum: the fit of the command line.

    ``fit(scan, n=1.5)`` takes a :class:`Scan`, and ``fit(psi, theta, phi, brdf, n=1.5)`` its arrays.

    Args:
        psi: A scan, or incidence angles in radians; or ``psi_deg`` in degrees.
        theta: Signed view angles in radians, or ``theta_deg``.
        phi: View azimuths in radians, or ``phi_deg``; 0 by default.
        brdf: f_r in 1/sr; NaN is a reading that was not taken.
        sigma: Standard deviations in 1/sr, for ``weights="stated"``.
        wavelength_um: Wavelength in micrometres.
        n: Refractive index, 1 to 1e5; None takes that of the scan. Where the model fits n, the start.
        model: ``three``; another model of the command line, as ``three+n`` or ``ggx``; or ``auto``, the
            smallest model that predicts incidences outside the fit about as well as the best.
        weights: The errors that the weights assume: ``constant`` in f_r cos theta (the E of the paper),
            ``stated`` (those of sigma) or ``relative`` to the model.
        robust: A loss for outliers, ``huber`` or ``tukey``; None is least squares.
        fixed: Values of parameters that are not fitted, as ``{"kd": 0.1}``.
        energy_limit_deg: The incidence in degrees up to which the reflectance is at most 1; None sets no limit.
        global_check: Whether the grid search checks the global optimum.
        depth: ``fit``; or ``assessed``, with cross-validation and the model hierarchy in the report; or
            ``compared``, with the reference models as well.
        threads: The number of threads; None takes all cores.

    Raises:
        FitError: The scan cannot be fitted: too few readings, no refractive index, and so on.
        ValueError: A value or an option is outside its domain.
    """
    if isinstance(psi, Scan):
        given = (theta, phi, brdf, psi_deg, theta_deg, phi_deg, sigma, wavelength_um)
        if any(value is not None for value in given):
            raise TypeError("a scan and arrays are both given: expected one of them")
        scan = psi
    else:
        scan = Scan(
            psi,
            theta,
            phi,
            brdf,
            psi_deg=psi_deg,
            theta_deg=theta_deg,
            phi_deg=phi_deg,
            sigma=sigma,
            wavelength_um=wavelength_um,
        )
    options = {
        "n": n,
        "model": model,
        "weights": weights,
        "robust": robust,
        "fixed": list((fixed or {}).items()),
        "energy_limit": None if energy_limit_deg is None else float(np.deg2rad(energy_limit_deg)),
        "global_check": global_check,
    }
    return _of_report(_native.fit(scan._handle, options, depth, threads), scan)


def _of_report(report: _native.Report, scan: Scan) -> Fit:
    estimates = report.estimates
    return Fit(
        parameters=Parameters(*report.parameters, report.model),
        intervals={name: Interval(low, high) for name, _, low, high in estimates},
        stderr={name: stderr for name, stderr, _, _ in estimates},
        e_percent=report.e_percent,
        readings=report.readings,
        status=report.status,
        warnings=tuple(FitWarning(kind, text) for kind, text in report.warnings),
        wavelength_um=report.wavelength_um,
        scan=scan,
        _report=report,
    )


def _fit_from_json(text: str, scan: Scan) -> Fit:
    return _of_report(_native.Report.from_json(text), scan)
