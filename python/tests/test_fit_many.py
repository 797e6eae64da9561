"""Fits of many scans."""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
import threading
import time
from typing import Any

import numpy as np
import pytest
from conftest import columns_equal, simulated
from numpy.typing import NDArray

import brdf_fit as bf


def test_each_scan_has_the_optimum_of_the_single_fit(geometry: bf.Geometry) -> None:
    scans = simulated(geometry, 20)
    many = geometry.fit_many(scans)
    for i, values in enumerate(scans):
        one = bf.fit(geometry.psi, geometry.theta, geometry.phi, values, n=1.5)
        assert many.e_percent[i] == pytest.approx(one.e_percent, rel=1e-9)
        assert many.k1[i] == pytest.approx(one.parameters.k1, rel=1e-5)
        assert many.k2[i] == pytest.approx(one.parameters.k2, rel=1e-5)
        assert many.kd[i] == pytest.approx(one.parameters.kd, rel=1e-5)
        assert many.readings[i] == one.readings


def test_known_parameters_are_found(geometry: bf.Geometry) -> None:
    truth: dict[str, Any] = {"k2": 0.3, "kd": 0.1, "k1": 0.2}
    scan = bf.evaluate(geometry.psi, geometry.theta, geometry.phi, **truth, n=1.5)
    many = geometry.fit_many(scan)
    assert many.shape == () and many.status == 0
    for name, value in truth.items():
        assert getattr(many, name) == pytest.approx(value, rel=1e-6)


def test_the_order_in_memory_has_no_effect(geometry: bf.Geometry) -> None:
    scans = simulated(geometry, 70)
    expected = geometry.fit_many(scans)
    spread = np.zeros((140, 2 * len(geometry)))
    spread[::2, ::2] = scans
    backwards = np.ascontiguousarray(scans[::-1, ::-1])[::-1, ::-1]
    shifted = np.frombuffer(b"." + scans.tobytes(), offset=1).reshape(scans.shape)
    for other in (
        np.asfortranarray(scans),
        spread[::2, ::2],
        backwards,
        shifted,
        scans.astype(">f8"),
        scans.tolist(),
    ):
        assert columns_equal(geometry.fit_many(other), expected)


def test_leading_axes_are_kept_in_each_order(geometry: bf.Geometry) -> None:
    scans = simulated(geometry, 24)
    expected = geometry.fit_many(scans).k1.reshape(2, 3, 4)
    cube = scans.reshape(2, 3, 4, -1)
    for other in (cube, np.asfortranarray(cube), np.moveaxis(np.moveaxis(cube, -1, 0).copy(), 0, -1)):
        many = geometry.fit_many(other)
        assert many.shape == (2, 3, 4)
        assert np.array_equal(many.k1, expected)
        assert many.k1.flags.c_contiguous
    assert geometry.fit_many(scans[:0]).shape == (0,)
    assert geometry.fit_many(np.empty((3, 0, len(geometry)))).shape == (3, 0)


def test_single_precision_has_the_result_of_its_values_in_double(geometry: bf.Geometry) -> None:
    scans = simulated(geometry, 70).astype(np.float32)
    expected = geometry.fit_many(scans.astype(np.float64))
    for other in (scans, np.asfortranarray(scans), scans[:, ::-1][:, ::-1]):
        many = geometry.fit_many(other)
        assert columns_equal(many, expected)
        assert many.k1.dtype == np.float64


def test_a_gap_is_a_reading_that_was_not_taken(geometry: bf.Geometry) -> None:
    scans = simulated(geometry, 70)
    expected = geometry.fit_many(scans)
    gaps = scans.copy()
    gaps[3, :40:2] = np.nan
    many = geometry.fit_many(gaps)
    masked = np.ma.masked_array(scans, mask=np.isnan(gaps))
    assert columns_equal(geometry.fit_many(masked), many)
    assert many.readings[3] == 92 and many.readings[4] == 112
    taken = ~np.isnan(gaps[3])
    part = bf.Geometry(geometry.psi[taken], geometry.theta[taken], geometry.phi[taken], n=1.5)
    assert many.e_percent[3] == pytest.approx(part.fit_many(gaps[3, taken]).e_percent, rel=1e-9)
    others = np.arange(70) != 3
    assert np.array_equal(many.k1[others], expected.k1[others])


def test_scans_that_cannot_be_fitted_have_a_status(geometry: bf.Geometry) -> None:
    scans = simulated(geometry, 4)
    scans[0] = np.nan
    scans[1] = 0.0
    scans[2, 0] = np.inf
    many = geometry.fit_many(scans)
    assert [bf.STATUS[code] for code in many.status] == [
        "too few readings",
        "all readings are zero",
        "a reading is out of range",
        "fitted",
    ]
    assert np.isnan(many.e_percent[:3]).all() and many.readings[0] == 0


def test_a_surface_without_a_lobe_has_no_width(geometry: bf.Geometry) -> None:
    many = geometry.fit_many(np.full((2, len(geometry)), 0.2))
    assert (many.status == 1).all() and (many.k2 == 0.0).all() and np.isnan(many.k1).all()
    # The columns can be evaluated as they are.
    f_r = bf.evaluate(0.3, 0.1, k2=many.k2, kd=many.kd, k1=many.k1, n=many.n)
    assert f_r == pytest.approx(0.2)


def test_weights_of_zero_are_gaps(geometry: bf.Geometry) -> None:
    scans = simulated(geometry, 5)
    weights = np.ones(len(geometry))
    weights[::3] = 0.0
    gaps = np.where(weights > 0.0, scans, np.nan)
    expected = geometry.fit_many(gaps)
    for given in (weights, np.tile(weights, (5, 1)), weights.astype(np.float32), weights[None, :]):
        many = geometry.fit_many(scans, weights=given)
        assert np.allclose(many.k1, expected.k1, rtol=1e-9)
        assert np.array_equal(many.readings, expected.readings)


def test_standard_errors_scatter_as_the_fits(geometry: bf.Geometry) -> None:
    truth: dict[str, Any] = {"k2": 0.3, "kd": 0.1, "k1": 0.2}
    f_r = bf.evaluate(geometry.psi, geometry.theta, geometry.phi, **truth, n=1.5)
    noise = np.random.default_rng(2).standard_normal((2000, len(geometry)))
    many = geometry.fit_many(f_r + 0.002 * noise / np.cos(geometry.theta), errors=True)
    for name in truth:
        stderr = many.columns()[f"{name}_stderr"]
        assert getattr(many, name).std() == pytest.approx(stderr.mean(), rel=0.1)
    assert np.isnan(many.columns()["n_stderr"]).all()
    assert "k1_stderr" not in geometry.fit_many(f_r).columns()


@pytest.mark.parametrize("model", ["three", "three+n"])
@pytest.mark.parametrize("precision", [np.float64, np.float32])
def test_intervals_are_those_of_the_single_fit(scan: bf.Scan, model: str, precision: type) -> None:
    geometry = bf.Geometry(scan.psi, scan.theta, scan.phi, n=1.5, model=model)
    scans: NDArray[Any] = simulated(geometry, 6).astype(precision)
    scans[1, 3:40:2] = np.nan
    scans[2] = np.nan
    scans[3] = 0.0
    scans[4] = 0.2
    scans[5] = 0.2 + 1e-3 * np.cos(7.0 * np.arange(len(geometry)))
    many = geometry.fit_many(scans.reshape(2, 3, -1), intervals=True)
    names = ["k2", "kd", "k1"] + ["n"] * (model == "three+n")
    assert list(many.intervals) == list(many.standard_errors) == names
    for i, values in enumerate(scans.astype(np.float64)):
        at = divmod(i, 3)
        if i in (2, 3, 4):
            # Not taken, zero, and the same at all angles: the single fit refuses them.
            assert all(np.isnan(interval[at]).all() for interval in many.intervals.values())
            assert all(np.isnan(error[at]) for error in many.standard_errors.values())
            continue
        one = bf.fit(geometry.psi, geometry.theta, geometry.phi, values, n=1.5, model=model)
        for name in names:
            assert np.array_equal(many.intervals[name][at], one.intervals[name], equal_nan=True)
            assert np.array_equal(many.standard_errors[name][at], one.stderr[name], equal_nan=True)
    assert np.isfinite(many.intervals["k1"][0, :2]).all()


def test_intervals_have_columns_of_their_own(geometry: bf.Geometry) -> None:
    scans = simulated(geometry, 3)
    plain = geometry.fit_many(scans)
    assert plain.intervals == plain.standard_errors == {}
    many = geometry.fit_many(scans, errors=True, intervals=True)
    columns = many.columns()
    new = [f"{name}_{end}" for name in ("k2", "kd", "k1") for end in ("standard_error", "from", "to")]
    assert list(columns) == [*geometry.fit_many(scans, errors=True).columns(), *new]
    assert np.array_equal(columns["k1_standard_error"], many.standard_errors["k1"])
    assert np.array_equal(columns["k1_from"], many.intervals["k1"][:, 0])
    assert np.array_equal(columns["k1_to"], many.intervals["k1"][:, 1])
    assert (columns["k1_standard_error"] != columns["k1_stderr"]).all()
    pytest.importorskip("pandas")
    assert np.array_equal(many.to_frame()["k1_to"], columns["k1_to"])
    single = bf.fit_many(
        geometry.psi, geometry.theta, geometry.phi, scans[0], n=1.5, intervals=True
    )
    assert np.array_equal(single.intervals["k1"], many.intervals["k1"][0])
    assert geometry.fit_many(scans[:0], intervals=True).intervals["k1"].shape == (0, 2)


def test_intervals_cover_the_truth(geometry: bf.Geometry) -> None:
    f_r = bf.evaluate(geometry.psi, geometry.theta, geometry.phi, k2=0.3, kd=0.1, k1=0.2, n=1.5)
    noise = np.random.default_rng(2).standard_normal((100, len(geometry)))
    many = geometry.fit_many(f_r * (1.0 + 0.02 * noise), intervals=True)
    for name, truth in {"k2": 0.3, "kd": 0.1, "k1": 0.2}.items():
        low, high = np.moveaxis(many.intervals[name], -1, 0)
        assert ((low < truth) & (truth < high)).mean() > 0.85


def test_bits_do_not_depend_on_threads_and_division(geometry: bf.Geometry) -> None:
    scans = simulated(geometry, 1500)
    scans[7, 3] = np.nan
    expected = geometry.fit_many(scans, errors=True, threads=1)
    some = geometry.fit_many(scans[:150], intervals=True, threads=1)
    for threads in (None, 2, 3):
        assert columns_equal(geometry.fit_many(scans, errors=True, threads=threads), expected)
        assert columns_equal(geometry.fit_many(scans[:150], intervals=True, threads=threads), some)
    parts = [geometry.fit_many(part) for part in np.array_split(scans, [1, 66, 700, 1499])]
    assert np.array_equal(np.concatenate([part.k1 for part in parts]), expected.k1)


def test_n_and_other_models(geometry: bf.Geometry) -> None:
    scan = bf.evaluate(geometry.psi, geometry.theta, geometry.phi, k2=0.3, kd=0.1, k1=0.2, n=1.7)
    free = bf.Geometry(geometry.psi, geometry.theta, geometry.phi, n=1.5, model="three+n")
    assert free.fit_many(scan).n == pytest.approx(1.7, rel=1e-6)
    assert (geometry.fit_many(scan).n == 1.5).all()
    lambert = bf.Geometry(geometry.psi, geometry.theta, geometry.phi, n=1.5, model="lambert")
    assert lambert.fit_many(np.full(len(geometry), 0.1)).kd == pytest.approx(0.1 * np.pi)


def test_degrees_and_radians_and_frames_are_one_geometry(geometry: bf.Geometry) -> None:
    columns: dict[str, Any] = {
        "psi_deg": np.rad2deg(geometry.psi),
        "theta_deg": np.rad2deg(geometry.theta),
        "phi_deg": np.rad2deg(geometry.phi),
    }
    others = (
        bf.Geometry.from_degrees(*columns.values(), n=1.5),
        bf.Geometry.from_frame(columns, n=1.5),
        bf.Geometry(psi=geometry.psi, theta_deg=columns["theta_deg"], n=1.5),
    )
    for other in others:
        assert np.allclose(other.theta, geometry.theta, rtol=1e-15)
    scans = simulated(geometry, 3)
    direct = bf.fit_many(**columns, scans=scans, n=1.5)
    assert np.allclose(direct.k1, geometry.fit_many(scans).k1)
    assert len(bf.Geometry([0.1, 0.2, 0.3], 0.4, n=1.5)) == 3


def test_pickled_geometry_is_the_same(geometry: bf.Geometry) -> None:
    other = pickle.loads(pickle.dumps(geometry))
    assert other == geometry and hash(other) == hash(geometry)
    # A process makes the plan of a geometry once.
    assert other._plan is geometry._plan


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (
            lambda g: g.fit_many(np.ones((2, 5))),
            ValueError,
            "the scans have 5 readings each: expected 112",
        ),
        (lambda g: g.fit_many(1.0), ValueError, "expected the shape (..., readings)"),
        (lambda g: g.fit_many(np.ones(112, complex)), TypeError, "complex128"),
        (lambda g: g.fit_many(["a"] * 112), TypeError, "expected real numbers"),
        (
            lambda g: g.fit_many(np.ones((2, 112)), weights=-np.ones(112)),
            ValueError,
            "scan 0, reading 0: weight -1: expected a finite number of at least 0",
        ),
        (
            lambda g: g.fit_many(np.ones((2, 112)), weights=np.ones((3, 112))),
            ValueError,
            "weights have the shape (3, 112): expected (112,), or that of the scans, (2, 112)",
        ),
        (
            lambda g: g.fit_many(np.ones((2, 112)), weights=np.ones(5)),
            ValueError,
            "5 readings",
        ),
        (
            lambda g: g.fit_many(np.ones((2, 112)), weights=np.ones(112), intervals=True),
            ValueError,
            "weights and intervals=True are both given: expected one of them",
        ),
        (lambda g: g.fit_many(np.ones(112), threads=0), ValueError, "threads = 0"),
        (lambda g: bf.Geometry([0.1, 2.0], 0.0, n=1.5), ValueError, "reading 1: incidence"),
        (lambda g: bf.Geometry([0.1, 0.2], [0.0] * 3, n=1.5), ValueError, "psi (2,), theta (3,)"),
        (lambda g: bf.Geometry(0.1, 0.2, n=0.5), ValueError, "n = 0.5: expected a number from 1"),
        (lambda g: bf.Geometry(0.1, 0.2, n=1.5, model="x"), ValueError, "expected one of"),
        (lambda g: bf.Geometry(0.1, n=1.5), TypeError, "neither theta (radians) nor theta_deg"),
        (lambda g: bf.Geometry(0.1, 0.2, psi_deg=3, n=1.5), TypeError, "both given"),
        (lambda g: bf.Geometry([], [], n=1.5), ValueError, "there are no readings"),
    ],
)
def test_errors_say_what_was_expected(geometry, call, error, words) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(error) as caught:
        call(geometry)
    assert words in str(caught.value)


FORKED = """
import multiprocessing, sys
import numpy as np, brdf_fit as bf

def fit(threads):
    geometry = bf.Geometry([0.1, 0.5, 0.9, 0.3, 0.2], [-0.1, -0.4, 0.3, 0.2, 0.1], n=1.5)
    scans = np.linspace(1.0, 2.0, 2000 * 5).reshape(2000, 5)
    one = bf.fit(geometry.psi, geometry.theta, 0.0, scans[0], n=1.5)
    some = geometry.fit_many(scans[:10], threads=threads, intervals=True)
    return geometry.fit_many(scans, threads=threads).k2.sum() + one.parameters.k2 + some.k2.sum()

if __name__ == "__main__":
    expected = fit(None)
    context = multiprocessing.get_context(sys.argv[1])
    with context.Pool(2) as pool:
        assert pool.map(fit, [None, 1, 2, None]) == [expected] * 4
    assert fit(None) == expected
    print("done")
"""


@pytest.mark.parametrize("method", ["fork", "spawn"])
def test_processes_can_be_forked_after_a_call(method: str, tmp_path) -> None:  # type: ignore[no-untyped-def]
    if method == "fork" and not hasattr(os, "fork"):
        pytest.skip("this system cannot fork")
    script = tmp_path / "forked.py"
    script.write_text(FORKED)
    command = [sys.executable, "-W", "ignore", str(script), method]
    result = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert result.stdout == "done\n", result.stderr


def test_other_threads_run_meanwhile(geometry: bf.Geometry) -> None:
    scans = np.tile(simulated(geometry, 200), (200, 1))
    ended = threading.Event()
    counted = []

    def count() -> None:
        n = 0
        while not ended.is_set():
            n += 1
            time.sleep(0)
        counted.append(n)

    counter = threading.Thread(target=count)
    counter.start()
    geometry.fit_many(scans, threads=1)
    ended.set()
    counter.join()
    # With the GIL held, the counter would run for the switch interval at the ends alone.
    assert counted[0] > 100


@pytest.mark.skipif(sys.platform == "win32", reason="signals are those of POSIX")
@pytest.mark.parametrize("intervals", [False, True])
@pytest.mark.parametrize("threads", [1, None])
def test_an_interrupt_ends_the_call(geometry: bf.Geometry, threads: int | None, intervals: bool) -> None:
    part = slice(None, None, 5)
    free = bf.Geometry(geometry.psi[part], geometry.theta[part], n=1.5, model="three+n")
    scans = np.tile(simulated(geometry, 100)[:, part], (100 if intervals else 1500, 1))
    timer = threading.Timer(0.1, lambda: os.kill(os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        free.fit_many(scans, intervals=intervals, threads=threads)
        pytest.fail("the call has ended before the interrupt")
    timer.join()


@pytest.mark.skipif(not os.path.isdir("/proc/self/task"), reason="the threads are counted on Linux")
def test_one_thread_is_the_calling_one() -> None:
    script = """
import os, numpy as np, brdf_fit as bf
geometry = bf.Geometry([0.1, 0.5, 0.9, 0.3, 0.2], [-0.1, -0.4, 0.3, 0.2, 0.1], n=1.5)
before = len(os.listdir("/proc/self/task"))
geometry.fit_many(np.linspace(1.0, 2.0, 50).reshape(10, 5), errors=True, intervals=True, threads=1)
assert len(os.listdir("/proc/self/task")) == before
"""
    result = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=300)
    assert result.returncode == 0, result.stderr
