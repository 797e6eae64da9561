"""Scans, and the files that have them."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from . import _native
from ._angles import Floats, broadcast, floats, radians

if TYPE_CHECKING:
    import pandas


class Scan:
    """The readings of one wavelength, in the convention of the model.

    Args:
        psi: Incidence angle in radians, or ``psi_deg`` in degrees.
        theta: Signed view angle in radians, or ``theta_deg``; positive at phi = 0 is the side of the source.
        phi: View azimuth from that of the source in radians, or ``phi_deg``.
        brdf: f_r in 1/sr. It broadcasts with the angles; NaN is a reading that was not taken.
        sigma: Standard deviation of each reading in 1/sr.
        wavelength_um: Wavelength in micrometres.
        source: A name for reports.

    Raises:
        ValueError: A value is outside its domain (with the number of its reading), or the shapes do not
            broadcast.
    """

    __slots__ = ("_handle",)

    _handle: _native.Scan

    def __init__(
        self,
        psi: ArrayLike | None = None,
        theta: ArrayLike | None = None,
        phi: ArrayLike | None = None,
        brdf: ArrayLike | None = None,
        *,
        psi_deg: ArrayLike | None = None,
        theta_deg: ArrayLike | None = None,
        phi_deg: ArrayLike | None = None,
        sigma: ArrayLike | None = None,
        wavelength_um: float | None = None,
        source: str = "arrays",
    ) -> None:
        if brdf is None:
            raise TypeError("brdf is missing: expected f_r in 1/sr")
        columns = [*radians(psi, theta, phi, psi_deg, theta_deg, phi_deg), floats("brdf", brdf)]
        names = ["psi", "theta", "phi", "brdf"]
        if sigma is not None:
            columns.append(floats("sigma", sigma))
            names.append("sigma")
        _, flat = broadcast(tuple(names), *columns)
        if np.isnan(flat[3]).any():
            taken = ~np.isnan(flat[3])
            flat = [column[taken] for column in flat]
        errors = flat[4] if sigma is not None else None
        self._handle = _native.Scan(flat[:4], errors, wavelength_um, source)

    @classmethod
    def _of(cls, handle: _native.Scan) -> Scan:
        scan = cls.__new__(cls)
        scan._handle = handle
        return scan

    @property
    def psi(self) -> Floats:
        """Incidence angles in radians."""
        return self._handle.columns()[0]

    @property
    def theta(self) -> Floats:
        """Signed view angles in radians."""
        return self._handle.columns()[1]

    @property
    def phi(self) -> Floats:
        """View azimuths in radians."""
        return self._handle.columns()[2]

    @property
    def brdf(self) -> Floats:
        """f_r in 1/sr."""
        return self._handle.columns()[3]

    @property
    def sigma(self) -> Floats | None:
        """Standard deviations in 1/sr; None where the scan states none."""
        sigma = self._handle.columns()[4]
        return None if np.isnan(sigma).all() else sigma

    @property
    def wavelength_um(self) -> float | None:
        """Wavelength in micrometres, where the scan states one."""
        return self._handle.wavelength_um

    @property
    def n(self) -> float | None:
        """Refractive index, where the scan states one."""
        return self._handle.n

    @property
    def source(self) -> str:
        """The path of the file, or the name of the scan."""
        return self._handle.source

    @property
    def format(self) -> str:
        """The format of the file."""
        return self._handle.format

    @property
    def metadata(self) -> dict[str, str]:
        """The keys and values of the comments of the file; the first value of a key."""
        found: dict[str, str] = {}
        for key, value in self._handle.metadata:
            found.setdefault(key, value)
        return found

    @property
    def conversions(self) -> tuple[str, ...]:
        """What was converted or left out when the file was read, one sentence each."""
        return tuple(self._handle.conversions)

    @property
    def ignored_columns(self) -> tuple[str, ...]:
        """The columns of the file that are not used."""
        return tuple(self._handle.ignored_columns)

    def to_frame(self) -> pandas.DataFrame:
        """The readings as a table of pandas: psi_deg, theta_deg, phi_deg, brdf and sigma. Needs pandas."""
        import pandas

        psi, theta, phi, brdf, sigma = self._handle.columns()
        angles = {"psi_deg": psi, "theta_deg": theta, "phi_deg": phi}
        columns = {name: np.rad2deg(angle) for name, angle in angles.items()} | {"brdf": brdf}
        return pandas.DataFrame(columns if np.isnan(sigma).all() else columns | {"sigma": sigma})

    def __len__(self) -> int:
        return len(self._handle)

    def __repr__(self) -> str:
        wavelength = "" if self.wavelength_um is None else f" at {self.wavelength_um} um"
        return f"<Scan of {len(self)} readings{wavelength} from {self.source!r}>"

    def __reduce__(self) -> tuple[Any, ...]:
        return _scan_from_json, (self._handle.to_json(),)


def _scan_from_json(text: str) -> Scan:
    return Scan._of(_native.Scan.from_json(text))


def read(
    path: str | os.PathLike[str],
    *,
    format: str | None = None,
    theta_positive: str | None = None,
    phi_zero: str | None = None,
    sample: int | None = None,
    columns: Mapping[str, str] | None = None,
    declare: Mapping[str, str] | None = None,
) -> list[Scan]:
    """Reads a file of any format that the command line reads: one scan for each wavelength, ascending.

    Args:
        path: The file.
        format: The name of the format, as ``csv`` or ``merl``; None detects it.
        theta_positive: The side on which the file counts theta positive, ``source`` or ``forward``; None takes
            the convention of the format.
        phi_zero: The side on which the azimuth is zero, ``source`` or ``forward``.
        sample: About how many readings of each wavelength to keep, spread over the directions; None keeps all.
        columns: What columns of a table are: the name in the file, and that of the format, as
            ``{"Incident": "psi_deg"}``.
        declare: What the file does not say, as ``{"quantity": "reflectance_factor"}``.

    Raises:
        OSError: The file cannot be read.
        ReadError: The file is not a scan; the message has the line, the value, and what was expected.
        ValueError: An option is none that there is.
    """
    pairs = [list((given or {}).items()) for given in (columns, declare)]
    scans = _native.read(os.fspath(path), format, theta_positive, phi_zero, sample, *pairs)
    return [Scan._of(scan) for scan in scans]
