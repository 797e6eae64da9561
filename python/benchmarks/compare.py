"""Processor time and E of the package beside those of other solvers, on the same scans, in one run.

``python compare.py`` fits scans of 112 readings. Each solver fits the first of the same scans, as many as take it
about a second, several times in turn with the others; its shortest processor time counts, which other work on the
machine disturbs less than the wall time. E is computed from the parameters that a solver gives, in one way for all.
The best E of a scan is the lowest of all solvers within the bounds k2 >= 0, kD >= 0, 1e-6 <= k1 <= 1e3 (and
1 <= n <= 6 where n is free); a scan with parameters outside of them has no excess, but is counted.
"""

from __future__ import annotations

import os

# One thread for all, before NumPy and JAX read them.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("XLA_FLAGS", "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1")

import argparse
from collections.abc import Callable
from dataclasses import dataclass
from time import process_time
from typing import Any

import numpy as np
import solvers
from numpy.typing import NDArray
from scans import K1, N, Columns, Floats, draw, measured_geometry

import brdf_fit as bf

MISSED = 1e-6
"""The relative excess of E above which an optimum counts as missed."""
GAPS = 0.1
"""The share of the readings that are missing in the scans with gaps."""


@dataclass(slots=True)
class Method:
    """A solver with what it reached."""

    name: str
    scans: Floats
    fit: Callable[[Floats], Floats]
    """Parameters (scans, 4), k2, kD, k1 and n, of scans."""
    first: float = np.inf
    """Processor time in s of the first run, in which a method may compile."""
    shortest: float = np.inf
    parameters: Any = None

    def run(self) -> None:
        start = process_time()
        self.parameters = self.fit(self.scans)
        taken = process_time() - start
        if self.first == np.inf:
            self.first = taken
        self.shortest = min(self.shortest, taken)

    @property
    def microseconds(self) -> float:
        """Processor time a scan."""
        return 1e6 * self.shortest / len(self.scans)

    def error(self, geometry: bf.Geometry) -> tuple[Floats, NDArray[np.bool]]:
        """E, dimensionless, of each scan, and whether its parameters are within the bounds."""
        k2, kd, k1, n = self.parameters.T
        cos_theta = np.cos(geometry.theta)
        within = (k2 >= 0.0) & (kd >= 0.0) & (n >= 1.0) & (n <= 6.0)
        # k1 is NaN where there is no lobe.
        within &= ((np.abs(k1) >= 1e-6) & (np.abs(k1) <= 1e3)) | (k2 == 0.0)
        usable = [np.where(within, each, 0.1)[:, None] for each in (k2, kd, np.abs(k1))]
        at = geometry.psi, geometry.theta, geometry.phi
        found = bf.evaluate(*at, k2=usable[0], kd=usable[1], k1=usable[2], n=n[:, None])
        residuals = (found - self.scans) * cos_theta
        error = np.nansum(residuals**2, axis=1) / np.nansum((self.scans * cos_theta) ** 2, axis=1)
        return np.where(within, error, np.nan), within


def package_many(geometry: bf.Geometry, errors: bool = False) -> Callable[[Floats], Floats]:
    def fit(scans: Floats) -> Floats:
        found = geometry.fit_many(scans, errors=errors, threads=1)
        return np.stack([found.k2, found.kd, found.k1, found.n], axis=-1)

    return fit


def package_one(geometry: bf.Geometry) -> Callable[[Floats], Floats]:
    at = geometry.psi, geometry.theta, geometry.phi

    def fit(scans: Floats) -> Floats:
        fits = (bf.fit(*at, scan, n=N, model=geometry.model, threads=1).parameters for scan in scans)
        return np.array([[found.k2, found.kd, found.k1, found.n] for found in fits])

    return fit


def other(columns: Columns, make: Callable[[], solvers.Solver]) -> Callable[[Floats], Floats]:
    solver = make()

    def fit(scans: Floats) -> Floats:
        found = solver(scans * columns.cos_theta)
        return np.column_stack([found, np.full(len(found), N)])

    return fit


def with_gaps(scans: Floats) -> Floats:
    missing = np.random.default_rng(2).random(scans.shape) < GAPS
    return np.where(missing, np.nan, scans)


def groups(geometry: bf.Geometry, scans: Floats, iterations: int) -> dict[str, list[Method]]:
    """The methods by what they fit: only those of a group have the same best E."""
    columns = Columns.at(geometry)
    free = bf.Geometry(geometry.psi, geometry.theta, geometry.phi, n=N, model="three+n")
    gaps = with_gaps(scans)
    fixed = [
        Method("fit_many", scans, package_many(geometry)),
        Method("fit_many, standard errors", scans, package_many(geometry, errors=True)),
        Method("fit, intervals and warnings", scans[:1000], package_one(geometry)),
    ]
    for name, count, make in (
        ("NumPy", 10_000, lambda: solvers.numpy_solver(columns)),
        ("JAX", 5000, lambda: solvers.jax_solver(columns, iterations)),
        ("SciPy lm", 500, lambda: solvers.scipy_solver(columns, "lm")),
        ("SciPy trf", 200, lambda: solvers.scipy_solver(columns, "trf")),
        ("lmfit", 200, lambda: solvers.lmfit_solver(columns)),
        ("xarray curvefit", 100, lambda: solvers.xarray_solver(columns)),
    ):
        try:
            fixed.append(Method(name, scans[:count], other(columns, make)))
        except ImportError as error:
            print(f"{name}: skipped ({error})")
    return {
        "n = 1.5": fixed,
        "n = 1.5, gaps": [
            Method("fit_many", gaps[:10_000], package_many(geometry)),
            Method("fit, intervals and warnings", gaps[:1000], package_one(geometry)),
        ],
        "n free": [
            Method("fit_many", scans[:5000], package_many(free)),
            Method("fit, intervals and warnings", scans[:300], package_one(free)),
        ],
    }


def show(name: str, methods: list[Method], geometry: bf.Geometry, unit: float) -> None:
    """A table; the times are relative to ``unit`` in microseconds as well."""
    most = max(len(method.scans) for method in methods)
    best = np.full(most, np.inf)
    for method in methods:
        error, _ = method.error(geometry)
        best[: len(error)] = np.fmin(best[: len(error)], error)
    print(f"\n{name:28} {'scans':>6} {'us':>9} {'ratio':>7}   excess of E: largest, median, > {MISSED:g}; outside")
    for method in methods:
        error, within = method.error(geometry)
        excess = (error / best[: len(error)] - 1.0)[within]
        missed, outside = np.mean(excess > MISSED), np.mean(~within)
        print(
            f"{method.name:28} {len(error):6} {method.microseconds:9.2f} {method.microseconds / unit:7.1f}"
            f"   {excess.max():.0e}, {np.median(excess):.0e}, {100 * missed:.2f} %; {100 * outside:.2f} %"
        )
        compiling = method.first - method.shortest
        if method.name == "JAX":
            print(f"{'  compiling':28} {'':6} {compiling:9.2f} s")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scans", type=int, default=20_000)
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--k1", type=float, nargs=2, default=K1, metavar=("LOW", "HIGH"))
    parser.add_argument("--iterations", type=int, default=30, help="those of the solver in JAX")
    options = parser.parse_args()
    geometry = measured_geometry()
    scans = draw(Columns.at(geometry), options.scans, k1=tuple(options.k1))
    all_groups = groups(geometry, scans, options.iterations)
    for _ in range(options.runs):
        for methods in all_groups.values():
            for method in methods:
                method.run()
    unit = all_groups["n = 1.5"][0].microseconds
    for name, methods in all_groups.items():
        show(name, methods, geometry, unit)


if __name__ == "__main__":
    main()
