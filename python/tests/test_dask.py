"""Fits with Dask: lazy, equal to the plain call, and complete where workers are lost."""

from __future__ import annotations

import os
import signal
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import simulated

import brdf_fit as bf

dask = pytest.importorskip("dask")
da = pytest.importorskip("dask.array")
xarray = pytest.importorskip("xarray")

import brdf_fit.dask  # noqa: E402


def assert_equal(found: Any, expected: bf.BatchFit) -> None:
    for name, column in expected.columns().items():
        assert found[name].dtype == column.dtype, name
        assert np.array_equal(np.asarray(found[name]), column, equal_nan=True), name


def test_chunks_have_the_bits_of_the_plain_call(geometry: bf.Geometry) -> None:
    cube = simulated(geometry, 60).reshape(6, 10, -1)
    cube[1, 2, 3] = np.nan
    expected = geometry.fit_many(cube, errors=True)
    for chunks in ((2, 5, -1), (6, 3, 50), (-1, -1, -1)):
        columns = bf.dask.fit_many(geometry, da.from_array(cube, chunks=chunks), errors=True)
        (found,) = dask.compute(columns)
        assert_equal(found, expected)
    one = bf.dask.fit_many(geometry, da.from_array(cube[0, 0]))
    assert one["k1"].compute() == expected.k1[0, 0]


def test_a_data_array_gives_a_lazy_dataset(geometry: bf.Geometry) -> None:
    cube = simulated(geometry, 20).reshape(4, 5, -1).astype(np.float32)
    scans = xarray.DataArray(
        cube.transpose(2, 0, 1),
        dims=("reading", "y", "x"),
        coords={"y": [1.0, 2.0, 3.0, 4.0], "psi": ("reading", geometry.psi)},
    )
    expected = geometry.fit_many(cube)
    lazy = bf.dask.fit_many(geometry, scans.chunk(y=2, reading=40))
    assert isinstance(lazy.k1.data, da.Array) and lazy.k1.chunks == ((2, 2), (5,))
    assert_equal(lazy.compute(), expected)
    assert list(lazy.coords) == ["y"] and lazy.k1.dims == ("y", "x")
    assert_equal(bf.dask.fit_many(geometry, scans).compute(), expected)
    assert_equal(geometry.fit_many(cube).to_dataset(("y", "x")), expected)
    with pytest.raises(ValueError, match="expected one of them to be 'view'"):
        bf.dask.fit_many(geometry, scans, dim="view")


def test_intervals_are_columns(geometry: bf.Geometry) -> None:
    scans = simulated(geometry, 6)
    scans[4] = np.nan
    expected = geometry.fit_many(scans, errors=True, intervals=True)
    columns = bf.dask.fit_many(
        geometry, da.from_array(scans, chunks=(4, -1)), errors=True, intervals=True
    )
    assert list(columns) == list(expected.columns())
    assert_equal(dask.compute(columns)[0], expected)
    table = xarray.DataArray(scans, dims=("scan", "reading"))
    assert_equal(bf.dask.fit_many(geometry, table, errors=True, intervals=True).compute(), expected)
    assert_equal(expected.to_dataset(["scan"]), expected)
    with pytest.raises(ValueError, match="weights and intervals=True are both given"):
        bf.dask.fit_many(geometry, da.from_array(scans), weights=np.ones(112), intervals=True)


def test_weights_of_all_shapes(geometry: bf.Geometry) -> None:
    scans = simulated(geometry, 6)
    weights = np.random.default_rng(1).uniform(0.5, 2.0, scans.shape)
    lazy = da.from_array(scans, chunks=(2, -1))
    for given in (weights, da.from_array(weights), weights[0], da.from_array(weights[0])):
        found = dask.compute(bf.dask.fit_many(geometry, lazy, weights=given))[0]
        assert_equal(found, geometry.fit_many(scans, weights=np.asarray(given)))
    named = xarray.DataArray(weights[0], dims="reading")
    table = xarray.DataArray(lazy, dims=("scan", "reading"))
    found = bf.dask.fit_many(geometry, table, weights=named).compute()
    assert_equal(found, geometry.fit_many(scans, weights=weights[0]))


def test_errors_have_the_words_of_the_library(geometry: bf.Geometry) -> None:
    with pytest.raises(ValueError, match=r"the shape \(4, 5\): expected \(\.\.\., 112\)"):
        bf.dask.fit_many(geometry, da.ones((4, 5)))
    lazy = bf.dask.fit_many(geometry, da.ones((4, 112)), weights=-np.ones(112))
    with pytest.raises(ValueError, match="scan 0, reading 0: weight -1"):
        lazy["k1"].compute()


def test_the_same_work_has_the_same_name(geometry: bf.Geometry) -> None:
    scans = da.from_array(simulated(geometry, 4))
    other = bf.Geometry(geometry.psi, geometry.theta, geometry.phi, n=1.5)
    names = [bf.dask.fit_many(each, scans)["k1"].name for each in (geometry, other)]
    assert names[0] == names[1]
    other = bf.Geometry(geometry.psi, geometry.theta, geometry.phi, n=1.6)
    assert bf.dask.fit_many(other, scans)["k1"].name != names[0]


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    distributed = pytest.importorskip("distributed")
    with (
        distributed.LocalCluster(
            n_workers=2,
            threads_per_worker=1,
            processes=True,
            dashboard_address=None,
            local_directory=str(tmp_path_factory.mktemp("workers")),
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        yield client


def slowly(block: np.ndarray) -> np.ndarray:
    """The block after a while, so that a worker is lost in the middle of the work."""
    time.sleep(0.15)
    return block


def kill_one(client: Any) -> None:
    """Ends a worker as the system does where memory is short."""
    time.sleep(1.5)
    workers = client.run(os.getpid)
    os.kill(next(iter(workers.values())), signal.SIGKILL)


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="this system has no SIGKILL")
@pytest.mark.parametrize("store", [False, True], ids=["in memory", "zarr"])
def test_a_lost_worker_changes_nothing(
    geometry: bf.Geometry, client: Any, tmp_path: Path, store: bool
) -> None:
    scans = np.tile(simulated(geometry, 100), (40, 1)).astype(np.float32)
    scans *= np.linspace(1.0, 2.0, len(scans), dtype=np.float32)[:, None]
    lazy = da.from_array(scans, chunks=(100, -1))
    table = xarray.DataArray(
        lazy.map_blocks(slowly, dtype=lazy.dtype, meta=np.empty((0, 0), lazy.dtype)),
        dims=("scan", "reading"),
    )
    fits = bf.dask.fit_many(geometry, table)
    killer = threading.Thread(target=kill_one, args=(client,))
    killer.start()
    if store:
        pytest.importorskip("zarr")
        fits.to_zarr(tmp_path / "fits.zarr")
        found = xarray.open_zarr(tmp_path / "fits.zarr").compute(scheduler="synchronous")
    else:
        found = fits.compute()
    killer.join()
    assert_equal(found, geometry.fit_many(scans))
