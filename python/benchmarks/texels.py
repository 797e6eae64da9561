"""Fits the texels of a 4K material, 3840 x 2160 with 112 readings each in float32, piece by piece.

``python texels.py`` makes the scans of a band of rows, fits them and keeps the parameters of all texels: never are
all readings (3.7 GB) in memory, as with a file that is read in pieces. The time of making the scans is told apart.
"""

from __future__ import annotations

import argparse
import resource
from dataclasses import dataclass
from time import perf_counter, process_time

import numpy as np
from numpy.typing import NDArray
from scans import Columns, draw, measured_geometry

WIDTH, HEIGHT = 3840, 2160
BAND = 40
"""Rows of the image that are in memory at a time."""
KEPT = "k2", "kd", "k1", "e_percent"


@dataclass(slots=True)
class Clock:
    """Wall time and processor time of all threads in s, summed over pieces of work."""

    wall: float = 0.0
    processor: float = 0.0

    def __enter__(self) -> None:
        self.wall -= perf_counter()
        self.processor -= process_time()

    def __exit__(self, *_: object) -> None:
        self.wall += perf_counter()
        self.processor += process_time()

    def __str__(self) -> str:
        return f"{self.wall:.1f} s wall, {self.processor:.1f} s of processor time"


class Texels:
    """Bands of scans in float32: the scans of one band, drawn once, each with a factor and in an order of the
    band's own, since drawing all would take minutes."""

    def __init__(self, columns: Columns) -> None:
        self.drawn = draw(columns, WIDTH * BAND).astype(np.float32)

    def band(self, number: int) -> NDArray[np.float32]:
        random = np.random.default_rng(number)
        factor = random.uniform(0.5, 2.0, (len(self.drawn), 1)).astype(np.float32)
        scans = np.roll(self.drawn, int(random.integers(len(self.drawn))), axis=0)
        scans *= factor
        return scans.reshape(BAND, WIDTH, -1)


def peak_megabytes() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--threads", type=int, default=2)
    threads = parser.parse_args().threads
    making, fitting = Clock(), Clock()
    geometry = measured_geometry()
    with making:
        texels = Texels(Columns.at(geometry))
    image = {name: np.empty((HEIGHT, WIDTH), np.float32) for name in KEPT}
    status = np.empty((HEIGHT, WIDTH), np.uint8)
    for top in range(0, HEIGHT, BAND):
        with making:
            scans = texels.band(top)
        with fitting:
            fits = geometry.fit_many(scans, threads=threads)
            for name, kept in image.items():
                kept[top : top + BAND] = getattr(fits, name)
            status[top : top + BAND] = fits.status
        del scans, fits
    count = WIDTH * HEIGHT
    print(f"{count} texels of {len(geometry)} readings in float32, {threads} thread(s)")
    print(f"fitting: {fitting}, {1e6 * fitting.processor / count:.2f} us of it a texel")
    print(f"making the scans: {making}")
    print(f"largest memory: {peak_megabytes():.0f} MB")
    fitted = np.isfinite(image["e_percent"]).sum()
    print(f"fitted: {fitted}; by status: {np.bincount(status.ravel()).tolist()}")


if __name__ == "__main__":
    main()
