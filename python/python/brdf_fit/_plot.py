"""Figures with Matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ._fit import Fit

#: Readings within this of the plane of incidence are drawn, in degrees of azimuth.
IN_PLANE_DEG = 0.05


def plot_fit(result: Fit, ax: Axes | None) -> Axes:
    """The readings in the plane of incidence, and the fit, over the signed view angle."""
    if ax is None:
        from matplotlib import pyplot

        _, ax = pyplot.subplots()
    scan = result.scan
    psi_deg, brdf = np.rad2deg(scan.psi), scan.brdf
    theta_deg, in_plane = _signed(np.rad2deg(scan.theta), np.rad2deg(scan.phi))
    for psi in np.unique(psi_deg[in_plane].round(1)):
        chosen = in_plane & (np.abs(psi_deg - psi) < 0.06)
        (points,) = ax.plot(theta_deg[chosen], brdf[chosen], "o", ms=3, label=f"{psi:g} deg")
        ends = theta_deg[chosen].min(), theta_deg[chosen].max()
        views = np.linspace(*ends, 400)
        curve = result.evaluate(psi_deg=psi, theta_deg=views)
        ax.plot(views, curve, color=points.get_color(), lw=1)
    ax.set_xlabel("theta (deg), positive towards the source")
    ax.set_ylabel("f_r (1/sr)")
    ax.legend(title="psi")
    return ax


def _signed(
    theta_deg: np.ndarray, phi_deg: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """theta as seen at phi = 0, and whether the view is in the plane of incidence."""
    half_turns = np.round(phi_deg / 180.0)
    in_plane = (np.abs(phi_deg - 180.0 * half_turns) < IN_PLANE_DEG) | (theta_deg == 0.0)
    return np.where(half_turns % 2 == 1, -theta_deg, theta_deg), in_plane
