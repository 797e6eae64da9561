"""The solvers that ``compare.py`` compares with the package, as a user would write them.

Each takes readings f_r cos theta (scans, readings) and gives the parameters k2, kD and k1 as (scans, 3). All know
the columns of the model, so that a value of the model costs a few operations: none computes angles in its loop.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from scans import Columns, Floats

START = 0.1, 0.1, 0.3
"""k2, kD and k1 at the start of each solver that needs one."""
LOW, HIGH = (0.0, 0.0, 1e-6), (np.inf, np.inf, 1e3)

Solver = Callable[[Floats], Floats]


def numpy_solver(columns: Columns, block: int = 512, steps: int = 9) -> Solver:
    """All scans of a block at once: the best of 84 widths by matrix products, then regula falsi on dE/d ln k1
    within the cell beside it. k2 and kD are the exact solution at each width, with k2 >= 0 and kD >= 0."""
    s, t, a = columns.s, columns.t, columns.a
    grid = np.exp(np.linspace(np.log(LOW[2]), np.log(HIGH[2]), 84))
    lobes = s * grid[:, None] ** 2 / (t + grid[:, None] ** 2)
    uu, ua, aa = (lobes**2).sum(axis=1), lobes @ a, a @ a

    def weights(uy: Floats, ay: Floats, uu: Floats, ua: Floats) -> tuple[Floats, Floats]:
        """k2 and kD of the least squares within the bounds, from the products of the columns."""
        determinant = uu * aa - ua**2
        k2 = (uy * aa - ay * ua) / determinant
        kd = (ay * uu - uy * ua) / determinant
        no_diffuse = kd < 0.0
        k2 = np.where(no_diffuse, np.maximum(uy / uu, 0.0), k2)
        kd = np.where(no_diffuse, 0.0, kd)
        no_lobe = k2 < 0.0
        return np.where(no_lobe, 0.0, k2), np.where(no_lobe, np.maximum(ay / aa, 0.0), kd)

    def slope(y: Floats, ay: Floats, x: Floats) -> tuple[Floats, Floats, Floats]:
        """-dE/dx up to a positive factor at x = ln k1, with k2 and kD."""
        share = 1.0 / (1.0 + t * np.exp(-2.0 * x)[:, None])
        u = s * share
        k2, kd = weights(
            np.einsum("ij,ij->i", u, y), ay, np.einsum("ij,ij->i", u, u), u @ a
        )
        residual = y - k2[:, None] * u - kd[:, None] * a
        u *= 1.0 - share
        falling: Floats = np.einsum("ij,ij->i", residual, u)
        return falling, k2, kd

    def fit_block(y: Floats) -> Floats:
        ay = y @ a
        uy = y @ lobes.T
        k2, kd = weights(uy, ay[:, None], uu, ua)
        explained = k2 * (2.0 * uy - k2 * uu - 2.0 * kd * ua) + kd * (2.0 * ay[:, None] - kd * aa)
        best = explained.argmax(axis=1)
        at = np.log(grid[best])
        here = slope(y, ay, at)[0]
        upward = here > 0.0
        other = np.log(grid[np.clip(best + np.where(upward, 1, -1), 0, len(grid) - 1)])
        there = slope(y, ay, other)[0]
        last = np.zeros(len(y))
        for _ in range(steps):
            # Where the slopes at the ends have one sign, the cell holds no root of the secant.
            bracketed = (here > 0.0) != (there > 0.0)
            secant = here / np.where(bracketed, here - there, 1.0)
            x = at + np.where(bracketed, secant, 0.5) * (other - at)
            f, k2, kd = slope(y, ay, x)
            side = np.where((f > 0.0) == upward, 1.0, -1.0)
            # Illinois: an end that stays twice counts half.
            stays = np.where(side == last, 0.5, 1.0)
            at, other = np.where(side > 0.0, x, at), np.where(side > 0.0, other, x)
            here, there = np.where(side > 0.0, f, stays * here), np.where(side > 0.0, stays * there, f)
            last = side
        return np.stack([k2, kd, np.exp(x)], axis=-1)

    def solve(y: Floats) -> Floats:
        return np.concatenate([fit_block(y[i : i + block]) for i in range(0, len(y), block)])

    return solve


def residual_functions(columns: Columns) -> tuple[Callable[..., Floats], Callable[..., Floats]]:
    """Residuals and their exact Jacobian at (k2, kD, k1)."""
    s, t, a = columns.s, columns.t, columns.a

    def residuals(p: Any, y: Floats) -> Floats:
        square = p[2] ** 2
        found: Floats = p[0] * s * square / (t + square) + p[1] * a - y
        return found

    def jacobian(p: Any, y: Floats) -> Floats:
        square = p[2] ** 2
        sum_ = t + square
        return np.stack([s * square / sum_, a, 2.0 * p[0] * p[2] * s * t / sum_**2], axis=-1)

    return residuals, jacobian


def scipy_solver(columns: Columns, method: str) -> Solver:
    """``least_squares`` with an exact Jacobian, scan by scan, tolerances of 1e-12: ``lm`` without bounds, or
    ``trf`` with them."""
    from scipy.optimize import least_squares

    residuals, jacobian = residual_functions(columns)
    options: dict[str, Any] = {"method": method, "ftol": 1e-12, "xtol": 1e-12, "gtol": 1e-12}
    if method != "lm":
        options["bounds"] = LOW, HIGH

    def solve(y: Floats) -> Floats:
        return np.array([least_squares(residuals, START, jacobian, args=(each,), **options).x for each in y])

    return solve


def lmfit_solver(columns: Columns) -> Solver:
    """``lmfit.minimize`` with its defaults: ``leastsq`` with bounds by a change of variables and a numeric
    Jacobian."""
    import lmfit

    residuals, _ = residual_functions(columns)
    start = lmfit.Parameters()
    for name, value, low, high in zip(("k2", "kd", "k1"), START, LOW, HIGH):
        start.add(name, value, min=low, max=high)

    def function(p: Any, y: Floats) -> Floats:
        return residuals((p["k2"].value, p["kd"].value, p["k1"].value), y)

    def solve(y: Floats) -> Floats:
        found = (lmfit.minimize(function, start, args=(each,)).params for each in y)
        return np.array([[p["k2"].value, p["kd"].value, p["k1"].value] for p in found])

    return solve


def xarray_solver(columns: Columns) -> Solver:
    """``Dataset.curvefit`` over all scans with its defaults: ``scipy.optimize.curve_fit``, ``trf`` with bounds
    and a numeric Jacobian."""
    import scipy  # noqa: F401  (curvefit needs it)
    import xarray

    def value(reading: Any, k2: float, kd: float, k1: float) -> Any:
        s, t, a = reading[..., 0], reading[..., 1], reading[..., 2]
        return k2 * s * k1**2 / (t + k1**2) + kd * a

    # The model needs three columns: the coordinate is the number of the reading.
    table = np.stack([columns.s, columns.t, columns.a], axis=-1)
    names = "k2", "kd", "k1"

    def function(reading: Any, k2: float, kd: float, k1: float) -> Any:
        return value(table[np.asarray(reading, dtype=np.int64)], k2, kd, k1)

    def solve(y: Floats) -> Floats:
        data = xarray.Dataset(
            {"y": (("scan", "reading"), y)}, coords={"reading": np.arange(float(y.shape[1]))}
        )
        fit = data.curvefit(
            "reading",
            function,
            param_names=list(names),
            p0=dict(zip(names, START)),
            bounds=dict(zip(names, zip(LOW, HIGH))),
        )
        return fit["y_curvefit_coefficients"].transpose("scan", "param").to_numpy()

    return solve


def jax_solver(columns: Columns, iterations: int = 30) -> Solver:
    """``vmap`` of Levenberg-Marquardt on k2, kD and ln k1 with the damping of Marquardt, an exact Jacobian and
    a fixed number of iterations: a step is taken where E falls. Parameters at a bound that E pushes outwards are
    held, and steps are cut at the bounds."""
    import jax

    jax.config.update("jax_enable_x64", True)
    import jax.numpy as jnp

    s, t, a = (jnp.asarray(column, np.float64) for column in (columns.s, columns.t, columns.a))
    low = jnp.asarray([*LOW[:2], np.log(LOW[2])], np.float64)
    high = jnp.asarray([*HIGH[:2], np.log(HIGH[2])], np.float64)
    start = jnp.asarray([*START[:2], np.log(START[2])], np.float64)
    aa = jnp.sum(a * a)

    def residual(p: Any, y: Any) -> Any:
        return p[0] * s / (1.0 + t * jnp.exp(-2.0 * p[2])) + p[1] * a - y

    def newton(m: tuple[Any, ...], v: tuple[Any, ...]) -> tuple[Any, ...]:
        """Solves a symmetric 3 x 3 system by Cramer's rule: a general solver costs more than all else. The
        matrix is given as its elements 00, 01, 02, 11, 12, 22."""
        xx, xy, xz, yy, yz, zz = m
        c00, c01, c02 = yy * zz - yz * yz, yz * xz - xy * zz, xy * yz - yy * xz
        c11, c12, c22 = xx * zz - xz * xz, xy * xz - xx * yz, xx * yy - xy * xy
        determinant = xx * c00 + xy * c01 + xz * c02
        return (
            (c00 * v[0] + c01 * v[1] + c02 * v[2]) / determinant,
            (c01 * v[0] + c11 * v[1] + c12 * v[2]) / determinant,
            (c02 * v[0] + c12 * v[1] + c22 * v[2]) / determinant,
        )

    def step(state: Any, y: Any) -> Any:
        p, error, damping = state
        share = 1.0 / (1.0 + t * jnp.exp(-2.0 * p[2]))
        u = s * share
        w = 2.0 * p[0] * u * (1.0 - share)
        r = p[0] * u + p[1] * a - y
        # Sums, and no product of matrices: the compiler makes one loop of them.
        gradient = jnp.stack([jnp.sum(column * r) for column in (u, a, w)])
        uu, ww = jnp.sum(u * u), jnp.sum(w * w)
        ua, uw, aw = jnp.sum(u * a), jnp.sum(u * w), jnp.sum(a * w)
        held = ((p <= low) & (gradient > 0.0)) | ((p >= high) & (gradient < 0.0))
        free = jnp.where(held, 0.0, 1.0)
        diagonal = jnp.where(held, 1.0, jnp.stack([uu, aa, ww]) * (1.0 + damping) + 1e-30)
        # Scaled to a diagonal of ones, so that Cramer's rule loses no more than it must.
        scale = free / jnp.sqrt(diagonal)
        ua, uw, aw = ua * scale[0] * scale[1], uw * scale[0] * scale[2], aw * scale[1] * scale[2]
        matrix = 1.0, ua, uw, 1.0, aw, 1.0
        move = -scale * jnp.stack(newton(matrix, tuple(gradient * scale)))
        tried = jnp.clip(p + move, low, high)
        found = jnp.sum(residual(tried, y) ** 2)
        better = found < error
        return (
            jnp.where(better, tried, p),
            jnp.where(better, found, error),
            jnp.where(better, jnp.maximum(damping * 0.1, 1e-12), jnp.minimum(damping * 8.0, 1e12)),
        )

    def fit_one(y: Any) -> Any:
        state = start, jnp.sum(residual(start, y) ** 2), jnp.asarray(1e-2, np.float64)
        p, _, _ = jax.lax.fori_loop(0, iterations, lambda _, state: step(state, y), state)
        return jnp.stack([p[0], p[1], jnp.exp(p[2])])

    compiled = jax.jit(jax.vmap(fit_one))
    return lambda y: np.asarray(compiled(y))
