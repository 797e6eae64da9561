"""The fit of one scan, and files."""

from __future__ import annotations

import json
import math
import os
import pickle
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import MEASURED

import brdf_fit as bf


@pytest.fixture(scope="module")
def fit(scan: bf.Scan) -> bf.Fit:
    return bf.fit(scan, n=1.5)


def test_the_numbers_are_those_of_the_command_line_to_the_last_bit(tmp_path: Path) -> None:
    brdf = os.environ.get("BRDF_PROGRAM")
    if brdf is None:
        pytest.skip("BRDF_PROGRAM does not say where the program brdf of this source is")
    command = [brdf, "fit", str(MEASURED), "--n", "1.5", "--json", str(tmp_path / "fits.json")]
    subprocess.run(command, capture_output=True, check=True)
    reports = json.loads((tmp_path / "fits.json").read_text())["reports"]
    scans = bf.read(MEASURED)
    assert len(reports) == len(scans)
    for report, scan in zip(reports, scans):
        fit = bf.fit(scan, n=1.5)
        expected = report["fit"]["parameters"]
        at = fit.parameters
        assert (at.k2, at.kd, at.k1) == (expected["k2"], expected["kd"], expected["k1"])
        assert fit.e_percent == report["fit"]["e_percent"]
        for estimate in report["uncertainty"]["estimates"]:
            interval = estimate["interval_95"]
            found = fit.intervals[estimate["parameter"]]
            assert found == (interval["from"], interval["to"])


def test_a_fit_has_parameters_intervals_and_rms(fit: bf.Fit) -> None:
    at = fit.parameters
    for name in ("k2", "kd", "k1"):
        low, high = fit.intervals[name]
        assert low < getattr(at, name) < high
        assert fit.stderr[name] > 0.0
    assert set(fit.intervals) == {"k2", "kd", "k1"}
    assert at.n == 1.5 and at.model == "three" and fit.status == "ok" and fit.readings == 112
    cosines = np.cos(fit.scan.theta)
    rms = np.sqrt(np.sum((fit.residuals() * cosines) ** 2) / np.sum((fit.scan.brdf * cosines) ** 2))
    assert fit.rms == pytest.approx(rms, rel=1e-12)
    assert f"{at.k1:.2g}"[:3] in fit.report() and len(fit.report(details=True)) > len(fit.report())


def test_arrays_and_degrees_give_the_fit_of_the_scan(fit: bf.Fit) -> None:
    scan = fit.scan
    by_radians = bf.fit(scan.psi, scan.theta, scan.phi, scan.brdf, n=1.5)
    assert by_radians.parameters == fit.parameters and by_radians.intervals == fit.intervals
    frame = scan.to_frame()
    columns: dict[str, Any] = {name: frame[name] for name in ("psi_deg", "theta_deg", "phi_deg", "brdf")}
    by_degrees = bf.fit(**columns, n=1.5)
    assert by_degrees.e_percent == pytest.approx(fit.e_percent, rel=1e-12)
    gap = np.append(scan.brdf, np.nan)
    with_gap = bf.fit(np.append(scan.psi, 0.1), np.append(scan.theta, 0.1), 0.0, gap, n=1.5)
    assert with_gap.readings == 112


def test_options_reach_the_library(scan: bf.Scan) -> None:
    fixed = bf.fit(scan, n=1.5, fixed={"kd": 0.05})
    assert fixed.parameters.kd == 0.05 and "kd" not in fixed.intervals
    free = bf.fit(scan, n=1.5, model="three+n", threads=1)
    assert "n" in free.intervals and free.parameters.n != 1.5
    robust = bf.fit(scan, n=1.5, robust="tukey")
    assert robust.e_percent > bf.fit(scan, n=1.5).e_percent
    assert bf.fit(scan, n=1.5, energy_limit_deg=80.0).e_percent > 0.0
    assert bf.fit(scan, n=1.5, weights="relative").parameters != fixed.parameters
    assessed = bf.fit(scan, n=1.5, model="auto", depth="assessed")
    assert "cross-validation" in assessed.report(details=True)
    assert "cross-validation" not in fixed.report(details=True)


@pytest.mark.parametrize(
    ("options", "error", "words"),
    [
        ({}, bf.FitError, "no refractive index"),
        ({"n": 0.5}, bf.FitError, "n = 0.5: expected a number in [1,"),
        ({"n": math.nan}, bf.FitError, "expected a number"),
        ({"n": 1.5, "model": "four"}, ValueError, "expected one of"),
        ({"n": 1.5, "weights": "stated"}, bf.FitError, "standard deviation"),
        ({"n": 1.5, "weights": "?"}, ValueError, "expected constant, stated or relative"),
        ({"n": 1.5, "robust": "?"}, ValueError, "expected huber or tukey"),
        ({"n": 1.5, "fixed": {"k9": 1.0}}, ValueError, "expected one of k2, kD, k1, n, p"),
        ({"n": 1.5, "depth": "?"}, ValueError, "expected fit, assessed or compared"),
        ({"n": 1.5, "theta": 0.1}, TypeError, "a scan and arrays are both given"),
    ],
)
def test_errors_of_a_fit(scan: bf.Scan, options, error, words) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(error) as caught:
        bf.fit(scan, **options)
    assert words in str(caught.value)
    assert pickle.loads(pickle.dumps(caught.value)).args == caught.value.args


def test_errors_of_readings() -> None:
    with pytest.raises(bf.FitError, match="3 readings: 3 free parameters need at least 4"):
        bf.fit([0.1, 0.2, 0.3], 0.1, 0.0, [1.0, 2.0, 3.0], n=1.5)
    with pytest.raises(ValueError, match="reading 1: .*inf"):
        bf.fit([0.1, 0.2, 0.3], 0.1, 0.0, [1.0, math.inf, 3.0], n=1.5)
    with pytest.raises(ValueError, match=r"psi \(2,\).*brdf \(3,\)"):
        bf.fit([0.1, 0.2], 0.1, 0.0, [1.0, 2.0, 3.0], n=1.5)
    with pytest.raises(TypeError, match="brdf is missing"):
        bf.fit(0.1, 0.2, n=1.5)


def test_results_can_be_pickled(fit: bf.Fit) -> None:
    other = pickle.loads(pickle.dumps(fit))
    assert other == fit and other.report() == fit.report()
    assert np.array_equal(other.scan.brdf, fit.scan.brdf)


def test_a_file_has_a_scan_for_each_wavelength() -> None:
    scans = bf.read(MEASURED)
    wavelengths = [scan.wavelength_um or 0.0 for scan in scans]
    assert wavelengths == sorted(wavelengths) and len(scans) > 1
    scan = scans[0]
    assert len(scan) == 112 and scan.format == "csv" and scan.source == str(MEASURED)
    assert scan.psi.min() >= 0.0 and scan.brdf.shape == (112,)
    assert scan.metadata and all(scan.metadata)
    assert "112 readings" in repr(scan)


def test_what_a_file_does_not_say_can_be_declared(tmp_path: Path) -> None:
    path = tmp_path / "scan.csv"
    path.write_text("Incident,theta_deg,value\n10,-10,50\n10,0,20\n")
    with pytest.raises(bf.ReadError, match="scan.csv"):
        bf.read(path)
    (scan,) = bf.read(
        path,
        columns={"Incident": "psi_deg", "value": "brdf"},
        declare={"quantity": "reflectance_factor", "unit": "percent"},
    )
    assert scan.brdf == pytest.approx([0.5 / math.pi, 0.2 / math.pi])
    assert scan.conversions


def test_errors_of_files(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match="none.csv"):
        bf.read(tmp_path / "none.csv")
    path = tmp_path / "scan.csv"
    path.write_text("psi_deg,theta_deg,brdf\n10,-10,0.5\n10,x,0.2\n")
    with pytest.raises(bf.ReadError, match="line 3"):
        bf.read(path)
    with pytest.raises(ValueError, match="expected one of csv, merl"):
        bf.read(path, format="unknown")


@pytest.mark.parametrize("name", ["json", "c", "glsl", "wgsl", "osl", "python", "astm", "zemax", "csv"])
def test_a_fit_is_written_in_each_format(fit: bf.Fit, tmp_path: Path, name: str) -> None:
    tolerance: dict[str, Any] = {"tolerance": 0.2} if name in ("astm", "zemax") else {}
    (path,) = bf.export(fit, tmp_path / "fit.txt", name, **tolerance)
    assert path.stat().st_size > 100


def test_values_have_the_digits_of_the_exported_table(fit: bf.Fit, tmp_path: Path) -> None:
    grid = "psi=0:80:10 theta=-85:85:5 phi=0,30,180"
    bf.export(fit, tmp_path / "fit.csv", "csv", grid=grid)
    (table,) = bf.read(tmp_path / "fit.csv")
    assert len(table) == 9 * 35 * 3
    assert np.array_equal(fit.evaluate(table.psi, table.theta, table.phi), table.brdf)


def test_mitsuba_has_a_plugin_and_a_scene(tmp_path: Path) -> None:
    fits = [bf.fit(scan, n=1.5) for scan in bf.read(MEASURED)]
    written = bf.export(fits[0], tmp_path / "paint.py", "mitsuba", name="paint")
    assert [path.name for path in written] == ["paint.py", "paint.xml"]
    assert "paint" in written[1].read_text()
    with pytest.raises(bf.ExportError, match="several fits"):
        bf.export(fits, tmp_path / "paint.h", "c")
    with pytest.raises(ValueError, match="not a format"):
        bf.export(fits[0], tmp_path / "x", "unknown")
    with pytest.raises(ValueError, match="tolerance = 2"):
        bf.export(fits[0], tmp_path / "x", "astm", tolerance=2.0)
