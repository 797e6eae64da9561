"""The notebook, the tables of HTML and the figure."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import ROOT, simulated

import brdf_fit as bf

NOTEBOOK = ROOT / "python" / "notebooks" / "file_to_mitsuba.ipynb"


def test_the_notebook_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    nbformat = pytest.importorskip("nbformat")
    nbclient = pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel")
    pytest.importorskip("matplotlib")
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    assert not any(cell.get("outputs") for cell in notebook.cells), "it is kept without outputs"
    # The figures belong into the notebook whatever the surroundings say.
    monkeypatch.setenv("MPLBACKEND", "module://matplotlib_inline.backend_inline")
    client = nbclient.NotebookClient(
        notebook, timeout=300, resources={"metadata": {"path": str(NOTEBOOK.parent)}}
    )
    client.execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    kinds = {kind for output in outputs for kind in output.get("data", {})}
    assert {"text/html", "image/png"} <= kinds


def test_a_fit_and_many_fits_are_tables_of_html(scan: bf.Scan, geometry: bf.Geometry) -> None:
    html = bf.fit(scan, n=1.5)._repr_html_()
    assert "<td>k1</td>" in html and "given" in html and "rms error" in html
    scans = simulated(geometry, 5)
    scans[0] = np.nan
    html = geometry.fit_many(scans)._repr_html_()
    assert "5 scans, shape (5,): 4 fitted, 1 too few readings" in html
    assert "0 scans" in geometry.fit_many(scans[:0])._repr_html_()


def test_a_figure_has_points_and_a_curve_for_each_incidence(scan: bf.Scan) -> None:
    pyplot = pytest.importorskip("matplotlib.pyplot")
    fit = bf.fit(scan, n=1.5)
    _, ax = pyplot.subplots()
    assert fit.plot(ax) is ax
    incidences = len(np.unique(np.rad2deg(scan.psi).round(1)))
    assert len(ax.lines) == 2 * incidences
    curve = ax.lines[1]
    assert curve.get_color() == ax.lines[0].get_color()
    expected = fit.evaluate(psi_deg=np.rad2deg(scan.psi.min()), theta_deg=curve.get_xdata())
    assert np.allclose(curve.get_ydata(), expected, rtol=1e-3)
    pyplot.close()


def test_tables_of_pandas(scan: bf.Scan, geometry: bf.Geometry) -> None:
    pytest.importorskip("pandas")
    frame = scan.to_frame()
    assert list(frame.columns) == ["psi_deg", "theta_deg", "phi_deg", "brdf"] and len(frame) == 112
    assert np.allclose(bf.Geometry.from_frame(frame, n=1.5).theta, scan.theta)
    many = geometry.fit_many(simulated(geometry, 6).reshape(2, 3, -1))
    table = many.to_frame()
    assert table.shape == (6, 8) and np.array_equal(table["k1"], many.k1.ravel())
