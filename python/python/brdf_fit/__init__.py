"""Fits the three-parameter BRDF of Li, Yan and Wu (2002), and its relatives, to goniometer scans.

Angles are in radians, or in degrees where a name ends in ``_deg``; f_r is in 1/sr, wavelengths are in
micrometres. theta is signed, positive at phi = 0 on the side of the source, so that theta = -psi is the mirror
direction.

>>> import brdf_fit as bf
>>> scan, = bf.read("scan.csv")                            # doctest: +SKIP
>>> fit = bf.fit(scan, n=1.5)                              # doctest: +SKIP
>>> fit.parameters, fit.intervals["k1"], fit.rms           # doctest: +SKIP
>>> many = bf.Geometry(scan.psi, scan.theta, n=1.5).fit_many(cube)   # doctest: +SKIP
"""

from ._batch import STATUS, BatchFit, Geometry, fit_many
from ._brdf import Plan, Samples, evaluate, hemispherical_reflectance, pdf, sample
from ._export import export
from ._fit import Fit, FitWarning, Interval, fit
from ._native import ExportError, FitError, ReadError
from ._parameters import Parameters
from ._scan import Scan, read

__all__ = [
    "STATUS",
    "BatchFit",
    "ExportError",
    "Fit",
    "FitError",
    "FitWarning",
    "Geometry",
    "Interval",
    "Parameters",
    "Plan",
    "ReadError",
    "Samples",
    "Scan",
    "evaluate",
    "export",
    "fit",
    "fit_many",
    "hemispherical_reflectance",
    "pdf",
    "read",
    "sample",
]
