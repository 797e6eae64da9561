"""A million scans through Dask on two worker processes, one of which is killed in the middle.

``python dask_million.py`` writes the scans with zarr, one chunk a block, and fits them from there: by the plain call,
block after block, by Dask without a loss, and by Dask while one worker is killed by its process id as soon as a
third of the tasks is done. All results must have the bits of the plain call.
"""

from __future__ import annotations

import argparse
import logging
import os
import signal
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import dask
import dask.array as da
import distributed
import numpy as np
import zarr
from scans import Columns, draw, measured_geometry

import brdf_fit as bf
import brdf_fit.dask

SCANS = 1_000_000


def write_scans(path: str, geometry: bf.Geometry, block: int) -> None:
    """Drawn scans in float32, each block with factors of its own."""
    drawn = draw(Columns.at(geometry), block)
    readings = len(geometry)
    stored = zarr.create_array(
        path, shape=(SCANS, readings), chunks=(block, readings), dtype="f4", compressors=None
    )
    for first in range(0, SCANS, block):
        factor = np.random.default_rng(first).uniform(0.5, 2.0, (block, 1))
        stored[first : first + block] = drawn * factor


def plain(path: str, geometry: bf.Geometry, block: int) -> dict[str, Any]:
    """The columns of the plain call on one thread, a block in memory at a time."""
    stored = zarr.open_array(path, mode="r")
    parts = [
        geometry.fit_many(stored[first : first + block], threads=1).columns()
        for first in range(0, SCANS, block)
    ]
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


@contextmanager
def worker_killed(client: distributed.Client, said: list[str]) -> Iterator[None]:
    """Kills a worker once a third of the tasks has its result in memory."""
    ended = threading.Event()

    def kill() -> None:
        deadline = time.monotonic() + 300.0
        while not ended.is_set() and time.monotonic() < deadline:
            done, all_tasks = client.run_on_scheduler(progress)
            if done > all_tasks / 3:
                pid = min(client.run(os.getpid).values())
                os.kill(pid, signal.SIGKILL)
                said.append(f"killed process {pid}, with {done} of {all_tasks} tasks in memory")
                return
            time.sleep(0.01)

    killer = threading.Thread(target=kill)
    killer.start()
    try:
        yield
    finally:
        ended.set()
        killer.join()


def progress(dask_scheduler: Any) -> tuple[int, int]:
    """The number of tasks whose results are in the memory of a worker, and that of all."""
    tasks = dask_scheduler.tasks.values()
    return sum(task.state == "memory" for task in tasks), len(tasks)


def same(found: dict[str, Any], expected: dict[str, Any]) -> bool:
    return found.keys() == expected.keys() and all(
        found[name].dtype == column.dtype and np.array_equal(found[name], column, equal_nan=True)
        for name, column in expected.items()
    )


def report(what: str, seconds: float, beside: float | None = None) -> None:
    more = "" if beside is None else f", {seconds / beside:.1f} times the plain call"
    print(f"{what}: {seconds:.1f} s, {SCANS / seconds:,.0f} scans/s{more}", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--block", type=int, default=20_000, help="scans in a chunk; divides a million")
    parser.add_argument("--runs", type=int, default=3)
    options = parser.parse_args()
    block: int = options.block
    if SCANS % block:
        parser.error(f"--block {block}: expected a divisor of {SCANS}")
    geometry = measured_geometry()
    with TemporaryDirectory() as folder:
        path = str(Path(folder) / "scans.zarr")
        write_scans(path, geometry, block)
        run(path, geometry, block, options.runs, folder)


def run(path: str, geometry: bf.Geometry, block: int, runs: int, folder: str) -> None:
    expected, shortest = None, np.inf
    for _ in range(runs):
        start = time.perf_counter()
        expected = plain(path, geometry, block)
        shortest = min(shortest, time.perf_counter() - start)
    assert expected is not None
    print(f"{SCANS:,} scans of {len(geometry)} readings, zarr of float32, blocks of {block:,}; shortest of {runs} runs")
    report("plain call, one thread", shortest)
    start = time.perf_counter()
    with (
        distributed.LocalCluster(
            n_workers=2,
            threads_per_worker=1,
            processes=True,
            dashboard_address=None,
            # It warns of the lost worker with a list of all its tasks.
            silence_logs=logging.ERROR,
            local_directory=folder,
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        print(f"starting two workers: {time.perf_counter() - start:.1f} s")
        columns = bf.dask.fit_many(geometry, da.from_zarr(path))
        times = []
        for _ in range(runs):
            start = time.perf_counter()
            (found,) = dask.compute(columns)
            times.append(time.perf_counter() - start)
            assert same(found, expected), "the result differs from the plain call"
        report("Dask, no loss, bits of the plain call", min(times), shortest)
        said: list[str] = []
        start = time.perf_counter()
        with worker_killed(client, said):
            (found,) = dask.compute(columns)
        taken = time.perf_counter() - start
        assert said, "no worker was killed"
        print(said[0])
        assert same(found, expected), "the result differs from the plain call"
        report("Dask, a worker killed, complete with the bits of the plain call", taken, shortest)


if __name__ == "__main__":
    main()
