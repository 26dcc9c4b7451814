"""Distributions of a metric, one histogram a cell, as static SVG: readable without JavaScript, in the dark and on paper."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from markupsafe import Markup, escape

from testbed.results.columns import BY_NAME
from testbed.show.words import number

FEWEST = 20  # flights in a cell below which a histogram says less than the numbers
MOST_CELLS = 150  # are pictured: of more the pictures would be half of the page
BINS, WIDTH, HEIGHT = 24, 320, 96
BINNED = ("cross_track_rms_m", "least_clearance_m")


def histograms(cells: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """For each metric its pictures over one common range, which ends at the 99th percentile of all: what lies beyond is counted."""
    every = [cell for cell in cells if cell["n"] >= FEWEST]
    crowded = every[:MOST_CELLS]
    made = []
    for key in BINNED:
        known = [np.array(cell["values"][key]) for cell in crowded]
        if not any(len(values) for values in known):
            continue
        low, high = np.percentile(np.concatenate(known), [1.0 if key == "least_clearance_m" else 0.0, 99.0])
        edges = np.linspace(min(low, 0.0), high if high > min(low, 0.0) else low + 1.0, BINS + 1)
        pictures = [
            {"title": " ".join(filter(None, (cell["circumstances"], cell["flyer"], cell["method"]))), "svg": _svg(values, edges, key)}
            for cell, values in zip(crowded, known, strict=True)
            if len(values)
        ]
        made.append({"column": BY_NAME[key], "pictures": pictures, "left_out": len(every) - len(crowded)})
    return made


def _svg(values: np.ndarray, edges: np.ndarray, key: str) -> Markup:
    counts, _ = np.histogram(values, edges)
    beyond = int(np.sum(values > edges[-1]) + np.sum(values < edges[0]))
    digits, step = BY_NAME[key].digits, WIDTH / BINS
    tallest = max(int(counts.max()), 1)
    parts = [f'<svg viewBox="0 0 {WIDTH} {HEIGHT + 18}" role="img" aria-label="{escape(BY_NAME[key].heading)}: {len(values)} flights">']
    for k, count in enumerate(counts.tolist()):
        if count:
            tall = max(1.0, HEIGHT * count / tallest)
            parts.append(f'<rect class="bar" x="{k * step + 0.5:.1f}" y="{HEIGHT - tall:.1f}" width="{step - 1:.1f}" height="{tall:.1f}"/>')
    for name, level in (
        ("median", float(np.median(values))),
        ("95 %", float(np.percentile(values, 5 if BY_NAME[key].worse == "low" else 95))),
    ):
        x = WIDTH * (level - edges[0]) / (edges[-1] - edges[0])
        if 0.0 <= x <= WIDTH:
            parts.append(
                f'<line class="mark" x1="{x:.1f}" y1="0" x2="{x:.1f}" y2="{HEIGHT}"><title>{name}: {number(level, digits)}</title></line>'
            )
    parts.append(f'<line class="axis" x1="0" y1="{HEIGHT}" x2="{WIDTH}" y2="{HEIGHT}"/>')
    parts.append(f'<text x="0" y="{HEIGHT + 13}">{number(float(edges[0]), digits)}</text>')
    parts.append(f'<text x="{WIDTH}" y="{HEIGHT + 13}" text-anchor="end">{number(float(edges[-1]), digits)}</text>')
    if beyond:
        parts.append(f'<text x="{WIDTH}" y="10" text-anchor="end">{beyond} beyond</text>')
    return Markup("".join([*parts, "</svg>"]))
