"""What the tests share."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import brdf_fit as bf

ROOT = Path(__file__).resolve().parents[2]
MEASURED = ROOT / "data" / "measured" / "z307_on_aluminium.csv"


@pytest.fixture(scope="session")
def scan() -> bf.Scan:
    """A measured scan of 112 readings."""
    return bf.read(MEASURED)[0]


@pytest.fixture(scope="session")
def geometry(scan: bf.Scan) -> bf.Geometry:
    """The angles of the measured scan at n = 1.5."""
    return bf.Geometry(scan.psi, scan.theta, scan.phi, n=1.5)


def simulated(geometry: bf.Geometry, count: int, seed: int = 1) -> NDArray[np.float64]:
    """Scans of known surfaces with noise of 1 % of each reading, shape (count, readings)."""
    random = np.random.default_rng(seed)
    k2, kd, k1 = np.exp(random.uniform(np.log(0.05), np.log(0.5), (3, count, 1)))
    f_r = bf.evaluate(geometry.psi, geometry.theta, geometry.phi, k2=k2, kd=kd, k1=k1, n=1.5)
    return f_r * (1.0 + 0.01 * random.standard_normal(f_r.shape))


def columns_equal(one: bf.BatchFit, other: bf.BatchFit) -> bool:
    """Whether two results have the same bits, NaN being equal to NaN."""
    a, b = one.columns(), other.columns()
    return a.keys() == b.keys() and all(
        np.array_equal(a[name], b[name], equal_nan=True) for name in a
    )
