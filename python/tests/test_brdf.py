"""Values, reflectances, samples and plans."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import brdf_fit as bf

EXPECTED = 0.490114021822736
AT: dict[str, Any] = {"k2": 1.211, "kd": 0.521, "k1": 0.071, "n": 1.60}


def test_angles_are_in_radians_or_degrees() -> None:
    # Sample 001 of the paper's Table 1, by `brdf_core::AnyBrdf::value`.
    assert bf.evaluate(0.5, -0.4, **AT) == pytest.approx(EXPECTED, rel=1e-14)
    assert bf.evaluate(psi=0.5, theta=-0.4, phi=0.0, **AT) == bf.evaluate(0.5, -0.4, **AT)
    degrees = bf.evaluate(psi_deg=math.degrees(0.5), theta_deg=math.degrees(-0.4), **AT)
    assert degrees == pytest.approx(EXPECTED, rel=1e-14)


def test_angles_and_parameters_broadcast() -> None:
    psi = np.array([0.1, 0.5])[:, None]
    theta = np.linspace(-1.0, 1.0, 5)
    values = bf.evaluate(psi, theta, **AT)
    assert values.shape == (2, 5) and values[1, 2] == bf.evaluate(0.5, 0.0, **AT)
    widths = np.array([0.071, 0.2, np.nan])
    each = bf.evaluate(psi[..., None], theta[:, None], **(AT | {"k1": widths}))
    assert each.shape == (2, 5, 3)
    assert np.array_equal(each[..., 0], values) and np.isnan(each[..., 2]).all()
    assert bf.evaluate([], 0.1, **AT).shape == (0,)
    assert np.isnan(bf.evaluate([0.1, np.nan], 0.1, **AT)).tolist() == [False, True]
    assert np.isnan(bf.evaluate(0.1, 0.1, **(AT | {"kd": math.nan})))


def test_other_models() -> None:
    ggx = bf.evaluate(0.5, -0.4, **AT, model="ggx")
    assert ggx != bf.evaluate(0.5, -0.4, **AT)
    power = bf.evaluate(0.5, -0.4, **AT, p=2.0, model="power+n")
    assert power != bf.evaluate(0.5, -0.4, **AT, p=1.0, model="power+n")
    at = bf.Parameters(**AT, model="ggx")
    assert bf.evaluate(0.5, -0.4, **at.to_dict()) == ggx


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"psi": [0.1, 2.0]}, "point 1: incidence"),
        ({"k1": 0.0}, "facet width k1 = 0: expected a number in [1e-8, 1e8]"),
        ({"k2": [-1.0, 1.0]}, "point 0: specular weight k2 = -1"),
        ({"psi": [0.1, 0.2], "theta": [0.1, 0.2, 0.3]}, "psi (2,), theta (3,)"),
        ({"model": "x"}, "expected one of"),
    ],
)
def test_errors_of_a_value(arguments, words) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(ValueError) as caught:
        bf.evaluate(**({"psi": 0.1, "theta": 0.2} | AT | arguments))
    assert words in str(caught.value)


def test_reflectance_is_the_integral_of_the_values() -> None:
    psi = 0.6
    rho = bf.hemispherical_reflectance(psi, **AT)
    mu = (np.arange(2000) + 0.5) / 2000
    phi = (np.arange(720) + 0.5) / 720 * 2.0 * math.pi
    theta = np.arccos(np.sqrt(mu))[:, None]
    assert bf.evaluate(psi, theta, phi, **AT).mean() * math.pi == pytest.approx(rho, rel=1e-4)
    assert bf.hemispherical_reflectance(psi_deg=[[0.0, 30.0]], **AT).shape == (1, 2)
    with pytest.raises(ValueError, match="point 0"):
        bf.hemispherical_reflectance(2.0, **AT)
    with pytest.raises(ValueError, match="tolerance = 0"):
        bf.hemispherical_reflectance(0.1, **AT, tolerance=0.0)


def test_the_mean_weight_of_samples_is_the_reflectance() -> None:
    source = np.array([0.6, 0.0, 0.8])
    u = np.random.default_rng(1).random((20_000, 3))
    samples = bf.sample(source, u, **AT)
    rho = bf.hemispherical_reflectance(math.acos(0.8), **AT)
    assert samples.weight.mean() == pytest.approx(rho, rel=0.02)
    drawn = ~np.isnan(samples.pdf)
    assert (samples.weight[~drawn] == 0.0).all()
    density = bf.pdf(source, samples.direction[drawn], **AT)
    assert np.array_equal(density, samples.pdf[drawn])
    assert np.allclose(np.linalg.norm(samples.direction[drawn], axis=-1), 1.0)
    assert bf.sample(source, u.reshape(100, 200, 3), **AT).direction.shape == (100, 200, 3)
    with pytest.raises(ValueError, match=r"u has the shape \(2,\): expected \(\.\.\., 3\)"):
        bf.sample(source, [0.1, 0.2], **AT)
    for wrong in (1.5, -0.1, math.nan):
        with pytest.raises(ValueError, match="point 1: u = .*: expected numbers in"):
            bf.sample(source, [[0.1, 0.2, 0.3], [0.1, wrong, 0.3]], **AT)
    with pytest.raises(ValueError, match="point 0"):
        bf.pdf([0.0, 0.0, 2.0], source, **AT)


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_a_plan_is_within_its_tolerance(dtype: type) -> None:
    plan = bf.Plan(**AT, tolerance=1e-4)
    random = np.random.default_rng(1)
    psi, theta, phi = random.uniform(0.0, 1.4, (3, 100, 50)).astype(dtype)
    values = plan.evaluate_many(psi, theta, phi)
    assert values.dtype == dtype and values.shape == (100, 50)
    assert np.array_equal(plan.evaluate_many(psi, theta, phi, threads=1), values)
    assert np.allclose(values, bf.evaluate(psi, theta, phi, **AT), rtol=1e-4)
    assert plan.max_error is not None and plan.max_error < 1e-4 and plan.name in repr(plan)
    assert plan.evaluate_many(psi, dtype(0.1)).dtype == dtype


def test_a_plan_takes_cosines_and_refuses_what_it_cannot_reach() -> None:
    plan = bf.Plan(**AT, cosines=True)
    value = plan.evaluate_many(np.cos(0.5), np.cos(0.4), -1.0)
    assert value == pytest.approx(bf.evaluate(0.5, -0.4, **AT), rel=1e-3)
    assert np.isnan(plan.evaluate_many([2.0, -0.1], 0.5, 0.5)).any()
    with pytest.raises(ValueError, match="no evaluator is within the relative tolerance"):
        bf.Plan(**AT, tolerance=1e-30)
    with pytest.raises(ValueError, match="incidence psi"):
        bf.Plan(**AT, psi_max_deg=95.0)
