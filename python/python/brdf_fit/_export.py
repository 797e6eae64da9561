"""Fits for other programs."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path

from . import _native
from ._fit import Fit


def export(
    fits: Fit | Iterable[Fit],
    path: str | os.PathLike[str],
    format: str,
    *,
    name: str = "brdf",
    tolerance: float | None = None,
    grid: str = "",
    rgb_um: tuple[float, float, float] | None = None,
) -> list[Path]:
    """Writes the fits of one surface in the format of another program.

    Args:
        fits: A fit, or one for each wavelength where the format has several.
        path: The file. A format of two files, as ``mitsuba`` with its scene, has the second one beside it.
        format: ``json``; source code: ``c``, ``glsl``, ``wgsl``, ``osl``, ``python``; ``mitsuba``; tables:
            ``merl``, ``astm``, ``zemax``, ``csv``.
        name: The prefix of the names in source code, and the type of the BSDF in Mitsuba.
        tolerance: The largest relative error of a table, above 0 and below 1; None is 0.05 for ``astm`` and
            ``zemax``, and no limit for ``merl``.
        grid: The angles of ``csv`` in degrees, as ``"psi=10:70:20 theta=-85:85:1 phi=0,90"``.
        rgb_um: The wavelengths for red, green and blue in micrometres, for ``merl`` and ``mitsuba``.

    Returns:
        The files that were written.

    Raises:
        ExportError: The format cannot take the fits, as several wavelengths where it has one, or no table is
            within the tolerance.
        OSError: A file cannot be written.
    """
    all_fits = [fits] if isinstance(fits, Fit) else list(fits)
    reports = [fit._report for fit in all_fits]
    content, companion, _ = _native.export(reports, format, name, tolerance, grid, rgb_um)
    file = Path(path)
    written = [file]
    if companion is not None:
        extension, text = companion
        beside = file.with_suffix(f".{extension}")
        if beside == file:
            raise ValueError(f"{file} would be written twice: expected another extension")
        beside.write_bytes(text)
        written.append(beside)
    file.write_bytes(content)
    return written
