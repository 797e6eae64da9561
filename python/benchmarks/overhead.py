"""The times of the package, beside those of the library alone that ``examples/library_times.rs`` prints."""

from __future__ import annotations

from collections.abc import Callable
from unittest.mock import patch
from time import perf_counter

import numpy as np
from scans import FILE, Floats

import brdf_fit as bf
from brdf_fit import _native

SCANS = 100_000
SCANS_WITH_INTERVALS = 1000


def best(work: Callable[[], object], runs: int) -> float:
    """The shortest of many runs, in microseconds."""
    shortest = float("inf")
    for _ in range(runs):
        start = perf_counter()
        work()
        shortest = min(shortest, perf_counter() - start)
    return 1e6 * shortest


def show(what: str, work: Callable[[], object], runs: int = 300, scans: int = 1) -> None:
    print(f"{what:45} {best(work, runs) / scans:8.2f} us")


def show_python_share(scan: bf.Scan, columns: tuple[Floats, ...]) -> None:
    """What the Python files take: the compiled calls are replaced by results that are stored."""
    handle, report = scan._handle, bf.fit(scan, n=1.5)._report
    show("the readings as the library takes them", lambda: _native.Scan(columns, None, None, "arrays"), 3000)
    with patch.object(_native, "fit", lambda *_: report), patch.object(_native, "Scan", lambda *_: handle):
        show("Python's share of fit of a scan", lambda: bf.fit(scan, n=1.5), 3000)
        show("Python's share of fit of arrays", lambda: bf.fit(*columns, n=1.5), 3000)


def main() -> None:
    scan = bf.read(FILE)[0]
    columns = scan.psi, scan.theta, scan.phi, scan.brdf
    geometry = bf.Geometry(*columns[:3], n=1.5)
    many = scan.brdf * (1.0 + np.arange(SCANS))[:, None]
    one = bf.fit(scan, n=1.5).parameters.to_dict()
    show("fit of a scan", lambda: bf.fit(scan, n=1.5))
    show("fit of arrays", lambda: bf.fit(*columns, n=1.5))
    show_python_share(scan, columns)
    show("evaluate, 112 points", lambda: bf.evaluate(*columns[:3], **one))
    show("fit_many of one scan, threads=1", lambda: geometry.fit_many(scan.brdf, threads=1))
    show("fit_many of one scan", lambda: geometry.fit_many(scan.brdf))
    for name, scans in (
        ("float64", many),
        ("float32", many.astype(np.float32)),
        ("float64, Fortran order", np.asfortranarray(many)),
    ):
        for threads in (1, None):
            what = f"fit_many, {name}, {threads or 'all'} thread(s), per scan"
            show(what, lambda: geometry.fit_many(scans, threads=threads), 10, SCANS)
    some = many[:SCANS_WITH_INTERVALS]
    for threads in (1, None):
        what = f"fit_many with intervals, {threads or 'all'} thread(s), per scan"
        show(what, lambda: geometry.fit_many(some, intervals=True, threads=threads), 5, SCANS_WITH_INTERVALS)


if __name__ == "__main__":
    main()
