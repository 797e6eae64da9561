"""The scans of the benchmarks: the angles of a measured paint, parameters drawn at random, and noise."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import brdf_fit as bf

FILE = Path(__file__).parents[2] / "data" / "measured" / "z307_on_aluminium.csv"
N = 1.5
K2 = 0.01, 1.0
KD = 0.01, 0.5
K1 = 0.02, 2.0
PROPORTIONAL_NOISE, CONSTANT_NOISE = 0.02, 0.001

Floats = NDArray[np.float64]


def measured_geometry(model: str = "three") -> bf.Geometry:
    """The 112 angles of the paint Z307 at 0.63 um, n = 1.5."""
    scan = bf.read(FILE)[0]
    return bf.Geometry(scan.psi, scan.theta, scan.phi, n=N, model=model)


@dataclass(frozen=True, slots=True)
class Columns:
    """The model of the paper at fixed angles and n: f_r cos theta = k2 s k1^2 / (t + k1^2) + kD a, with
    t = tan^2 alpha and a = cos theta / pi. Three arrays (readings,), from one evaluation of the library."""

    s: Floats
    t: Floats
    a: Floats
    cos_theta: Floats

    @classmethod
    def at(cls, geometry: bf.Geometry) -> Columns:
        psi, theta, phi = geometry.psi, geometry.theta, geometry.phi
        across = np.sin(psi) + np.sin(theta) * np.cos(phi)
        along = np.sin(theta) * np.sin(phi)
        t = (across**2 + along**2) / (np.cos(psi) + np.cos(theta)) ** 2
        lobe = bf.evaluate(psi, theta, phi, k2=1.0, kd=0.0, k1=1.0, n=geometry.n)
        cos_theta = np.cos(theta)
        return cls(s=lobe * cos_theta * (1.0 + t), t=t, a=cos_theta / np.pi, cos_theta=cos_theta)

    def values(self, k2: Floats, kd: Floats, k1: Floats) -> Floats:
        """f_r cos theta in 1/sr, shape (scans, readings), of parameters (scans,)."""
        square = np.asarray(k1)[..., None] ** 2
        lobe = self.s * square / (self.t + square)
        return np.asarray(k2)[..., None] * lobe + np.asarray(kd)[..., None] * self.a


def draw(columns: Columns, count: int, seed: int = 1, k1: tuple[float, float] = K1) -> Floats:
    """f_r in 1/sr, shape (count, readings): k2 from 0.01 to 1, kD from 0.01 to 0.5 and k1, all uniform in
    the logarithm; normal noise of 2 % of each reading and, added to it, 0.1 % of the largest of the scan."""
    random = np.random.default_rng(seed)
    k2, kd, width = (_logarithmic(random, ends, count) for ends in (K2, KD, k1))
    exact = columns.values(k2, kd, width) / columns.cos_theta
    size = PROPORTIONAL_NOISE * exact + CONSTANT_NOISE * exact.max(axis=1, keepdims=True)
    noisy: Floats = exact + size * random.standard_normal(exact.shape)
    return noisy


def _logarithmic(random: np.random.Generator, ends: tuple[float, float], count: int) -> Floats:
    return np.exp(random.uniform(float(np.log(ends[0])), float(np.log(ends[1])), count))
