"""Draws a picture of docs/viewer.md: lobes, and the viewer's surfaces beside Mitsuba's.

    SURFACE_PICTURES=FOLDER cargo test -p brdf-tests --test surface_mitsuba -- samples --nocapture
    python tests/python/surface_picture.py FOLDER docs/viewer-mitsuba.png

Both renderings have the same light, camera and exposures: those that the viewer chooses.
"""

import json
import sys
from pathlib import Path

import matplotlib

matplotlib.use("agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

# Pixels of an inch of the picture; the renderings are drawn pixel by pixel.
DPI = 100
# The part of the figure of a lobe that is shown: left, right, upper and lower edge.
LOBE = (120, 840, 60, 570)
GAP = 20
LINE = 20
TITLE = 2 * LINE + 10


def screen(linear):
    """The values of sRGB from 0 to 1 of linear ones; what is above white is white."""
    linear = np.clip(linear, 0, 1)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def developed(found, stops, width):
    """Mitsuba's picture at an exposure in stops, on white."""
    covered = np.array(found["covered"]).reshape(-1, width, 1)
    mean = np.array(found["mean"]).reshape(-1, width, 3) / np.maximum(covered, 1e-6)
    return screen(mean * 2.0**stops) * covered + (1 - covered)


def show(figure, picture, left, top, width):
    """Places a picture by its left upper corner and its width in pixels."""
    columns, rows = figure.get_size_inches() * DPI
    height = width * picture.shape[0] / picture.shape[1]
    axes = figure.add_axes([left / columns, 1 - (top + height) / rows, width / columns, height / rows])
    axes.imshow(picture, interpolation="antialiased", aspect="auto")
    axes.axis("off")


def main(folder, target):
    samples = json.loads((Path(folder) / "surfaces.json").read_text(encoding="utf-8"))
    width = samples[0]["width"]
    of_lobe = round(1.5 * width * (LOBE[1] - LOBE[0]) / (LOBE[3] - LOBE[2]))
    size = np.array([of_lobe + 2 * width + 4 * GAP, (1.5 * width + TITLE + GAP) * len(samples) + GAP])
    figure = plt.figure(figsize=size / DPI, dpi=DPI)
    for i, sample in enumerate(samples):
        top = GAP + i * (1.5 * width + TITLE + GAP)
        lobe = plt.imread(sample["lobe"])[LOBE[2] : LOBE[3], LOBE[0] : LOBE[1], :3]
        viewer = np.array(sample["viewer"], dtype=np.uint8).reshape(-1, width, 3) / 255
        both = [developed(sample[body], exposure, width) for body, exposure in zip(("ball", "plate"), sample["stops"])]
        places = [GAP, 2 * GAP + of_lobe, 3 * GAP + of_lobe + width]
        figure.text(GAP / size[0], 1 - top / size[1], sample["title"], va="top", fontsize=9, fontweight="bold")
        stops = "{:g} and {:g} stops".format(*sample["stops"])
        for name, left in zip((sample["caption"], f"viewer, {stops}", "Mitsuba, the same"), places):
            figure.text(left / size[0], 1 - (top + LINE) / size[1], name, va="top", fontsize=9)
        for picture, left, across in zip((lobe, viewer, np.vstack(both)), places, (of_lobe, width, width)):
            show(figure, picture, left, top + TITLE, across)
    figure.savefig(target, dpi=DPI, metadata={"Software": None})


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit("usage: surface_picture.py FOLDER PICTURE.png")
    main(sys.argv[1], sys.argv[2])
