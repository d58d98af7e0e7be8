"""Pressure coefficients on the wing: measured ones, and a flow's at the same places."""

import csv
import math
from pathlib import Path

import numpy as np

TABLE = Path(__file__).resolve().parent / "test-2308.csv"
# The wing of geometry/zoo/flow.py (m), and the references of its faces.
ROOT, TAPER, SPAN, SWEEP = 0.8059, 0.562, 1.1963, 30.0
WING = (3, 4, 5)
# A digit that was read wrongly: (y/b, x/c).
DOUBTFUL = {("0.90", "0.00184")}
# A point is in the smearing of a shock where the pressure coefficient, measured or computed, falls by so much over so much of the chord on either
# side, downstream of the nose.
NOSE, STEEP, REACH = 0.08, 0.2, 0.05


def measured():
    """{(y/b, side): x/c and Cp, shape (n, 2), by x/c}; sides are `upper` and `lower`."""
    found = {}
    with open(TABLE, encoding="utf-8") as file:
        for row in csv.DictReader(line for line in file if not line.startswith("#")):
            if (row["y/b"], row["x/c"]) not in DOUBTFUL:
                found.setdefault((float(row["y/b"]), row["side"]), []).append((float(row["x/c"]), float(row["Cp"])))
    return {key: np.array(sorted(rows)) for key, rows in found.items()}


def coefficient(pressure, mach, gamma=1.4):
    """Cp of pressures in units of the free stream's."""
    return (pressure - 1) / (0.5 * gamma * mach**2)


def section(mesh, values, share):
    """{side: x/c and value, shape (n, 2), by x/c} where the plane y = share · SPAN cuts the wing's triangles."""
    y = share * SPAN
    nose, chord = y * math.tan(math.radians(SWEEP)), ROOT * (1 - (1 - TAPER) * share)
    triangles = mesh.triangles[np.isin(mesh.triangle_refs, WING)]
    edges = np.unique(np.sort(np.concatenate([triangles[:, pair] for pair in ([0, 1], [1, 2], [2, 0])]), 1), axis=0)
    a, b = mesh.points[edges[:, 0], 1] - y, mesh.points[edges[:, 1], 1] - y
    cut = (a < 0) != (b < 0)
    part = (a[cut] / (a[cut] - b[cut]))[:, None]
    points = mesh.points[edges[cut, 0]] * (1 - part) + mesh.points[edges[cut, 1]] * part
    value = values[edges[cut, 0]] * (1 - part[:, 0]) + values[edges[cut, 1]] * part[:, 0]
    rows = np.column_stack([(points[:, 0] - nose) / chord, value])
    sides = {"upper": points[:, 2] >= 0, "lower": points[:, 2] <= 0}
    return {side: rows[on][np.argsort(rows[on, 0])] for side, on in sides.items()}


def steep(rows, x):
    """Whether a curve changes by STEEP within REACH of x, downstream of the nose."""
    ends = np.clip([x - REACH, x + REACH], NOSE, 1)
    places = np.unique(np.r_[ends, rows[(rows[:, 0] > ends[0]) & (rows[:, 0] < ends[1]), 0]])
    return x > NOSE and np.ptp(np.interp(places, rows[:, 0], rows[:, 1])) > STEEP


def compared(mesh, values, tolerance=0.1):
    """A line a section: {"share", "within" (of the points outside shocks), "points", "left_out", "curves"}."""
    lines, table = [], measured()
    for share in sorted({key[0] for key in table}):
        curves, met, points, left = section(mesh, values, share), 0, 0, 0
        for side, curve in curves.items():
            rows = table[share, side]
            for x, wanted in rows:
                if steep(rows, x) or steep(curve, x):
                    left += 1
                    continue
                points += 1
                met += abs(np.interp(x, curve[:, 0], curve[:, 1]) - wanted) <= tolerance
        lines.append({"share": share, "within": met / points, "points": points, "left_out": left, "curves": curves})
    return lines


def draw(lines, path):
    """The sections, measured and computed, as a picture."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(2, 4, figsize=(16, 8), sharex=True, sharey=True)
    table = measured()
    for axis, line in zip(axes.flat, lines):
        for side, colour in [("upper", "tab:blue"), ("lower", "tab:orange")]:
            axis.plot(*line["curves"][side].T, "-", color=colour, linewidth=1)
            axis.plot(*table[line["share"], side].T, "o", color=colour, markersize=3, fillstyle="none")
        axis.set_title(f"y/b = {line['share']:.2f}: {line['within']:.0%} of {line['points']} within 0.1")
        axis.grid(alpha=0.3)
    axes[0, 0].set_ylim(1.2, -1.6)
    axes.flat[-1].axis("off")
    axes.flat[-1].text(0, 0.5, "ONERA M6, Mach 0.84, 3.06°\nlines: computed, inviscid\ncircles: AGARD AR-138, test 2308")
    for axis in axes[1]:
        axis.set_xlabel("x/c")
    for axis in axes[:, 0]:
        axis.set_ylabel("Cp")
    figure.tight_layout()
    figure.savefig(path, dpi=100)
