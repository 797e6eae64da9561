"""Results as tables of HTML, for notebooks."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ._batch import BatchFit
    from ._fit import Fit


def fit(result: Fit) -> str:
    """The parameters with their intervals, the rms error, and the warnings."""
    rows: list[tuple[str, ...]] = []
    for name in ("k2", "kd", "k1", "n", "p"):
        value = getattr(result.parameters, name)
        if name in result.intervals:
            low, high = result.intervals[name]
            rows.append((name, f"{value:.4g}", f"{low:.4g}", f"{high:.4g}"))
        elif name == "n":
            rows.append((name, f"{value:.4g}", "given", ""))
    title = f"{result.parameters.model}: rms error {100 * result.rms:.2g} %, {result.readings} readings"
    notes = "".join(f"<li>{escape(warning.text)}</li>" for warning in result.warnings)
    table = _table(("", "value", "from (95 %)", "to"), rows)
    return f"<p>{escape(title)}</p>{table}" + (f"<ul>{notes}</ul>" if notes else "")


def batch(result: BatchFit) -> str:
    """The median and the range of each column, and the number of scans of each status."""
    from ._batch import STATUS

    rows: list[tuple[str, ...]] = []
    for name in ("k2", "kd", "k1", "n", "e_percent"):
        column = getattr(result, name)
        known = column[np.isfinite(column)]
        if known.size:
            numbers = (np.median(known), known.min(), known.max())
            rows.append((name, *(f"{number:.4g}" for number in numbers)))
    codes, counts = np.unique(result.status, return_counts=True)
    states = ", ".join(f"{count} {STATUS[code]}" for code, count in zip(codes, counts))
    title = f"{result.k2.size} scans, shape {result.shape}: {states}"
    return f"<p>{escape(title)}</p>" + _table(("", "median", "least", "largest"), rows)


def _table(head: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    def line(tag: str, cells: tuple[str, ...]) -> str:
        return "<tr>" + "".join(f"<{tag}>{escape(cell)}</{tag}>" for cell in cells) + "</tr>"

    body = "".join(line("td", row) for row in rows)
    return f"<table><thead>{line('th', head)}</thead><tbody>{body}</tbody></table>"
