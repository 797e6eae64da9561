"""Draws the picture of docs/planning.md: the error of a fit against the number of its readings.

    measure-planning FOLDER curves > curves.csv
    python tests/python/planning_picture.py curves.csv docs/planning.svg

A line is the median over the samples, each of which counts by the median over its wavelengths; its band reaches to
the sample at nine tenths. A grid exists for some numbers of readings only: between them its error is that of the
next smaller grid.
"""

import csv
import sys
from collections import defaultdict

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402

STRATEGIES = {
    "plan": "#0072b2",
    "uniform grid": "#d55e00",
    "grid by incidences": "#009e73",
    "random, median": "#777777",
}
COUNTS = range(5, 81)


def read(path):
    """The errors by strategy, sample and wavelength: pairs of readings and error."""
    curves = defaultdict(lambda: defaultdict(lambda: defaultdict(list)))
    with open(path, newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            point = (int(row["readings"]), float(row["error_over_full"]))
            sample, _, wavelength = row["scan"].rpartition(" ")
            curves[row["strategy"]][sample][wavelength].append(point)
    return curves


def at(points, count):
    """The error with at most this number of readings; infinite with fewer than any choice has."""
    errors = [error for readings, error in points if readings <= count]
    return errors[-1] if errors else float("inf")


def quantile(values, fraction):
    values = sorted(values)
    return values[round(fraction * (len(values) - 1))]


def of_sample(wavelengths, count):
    return quantile([at(sorted(points), count) for points in wavelengths.values()], 0.5)


def main(source, target):
    curves = read(source)
    plt.rcParams.update({"svg.hashsalt": "planning", "font.size": 10})
    figure, axes = plt.subplots(figsize=(7.2, 4.2))
    for strategy, colour in STRATEGIES.items():
        samples = curves[strategy].values()
        errors = [[of_sample(sample, count) for sample in samples] for count in COUNTS]
        median = [quantile(of_count, 0.5) for of_count in errors]
        high = [min(quantile(of_count, 0.9), 10.0) for of_count in errors]
        axes.plot(COUNTS, median, color=colour, label=strategy)
        axes.fill_between(COUNTS, median, high, color=colour, alpha=0.12, linewidth=0)
    axes.axhline(1.1, color="black", linewidth=0.6, linestyle=":")
    axes.set(xscale="log", yscale="log", xlim=(5, 80), ylim=(0.95, 3.0))
    axes.set_xticks([5, 7, 10, 14, 20, 30, 40, 60, 80], [5, 7, 10, 14, 20, 30, 40, 60, 80])
    axes.set_yticks([1, 1.1, 1.3, 1.5, 2, 3], ["1", "1.1", "1.3", "1.5", "2", "3"])
    axes.minorticks_off()
    axes.set_xlabel("readings")
    axes.set_ylabel("error over all readings / that of the fit to all")
    axes.legend(frameon=False)
    figure.tight_layout()
    figure.savefig(target, metadata={"Date": None})


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit("usage: planning_picture.py CURVES.csv PICTURE.svg")
    main(sys.argv[1], sys.argv[2])
