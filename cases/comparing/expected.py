"""What each case must reach: the target, and the floor that is held today.

A target that is not reached is said so; a floor that is lost ends the command with exit code 1. When the program gets
better, raise the floor. Floors of times have room for a busy machine; None: not held.
"""

import operator
from dataclasses import dataclass


@dataclass(frozen=True)
class Bound:
    """A figure, which side of the bounds is good, the target (issue 3) and today's floor."""

    figure: str
    sense: str
    target: float
    floor: float | None = None

    def met(self, value, bound):
        """Whether the value is on the good side."""
        return {"≥": operator.ge, "≤": operator.le}[self.sense](value, bound)

    def held(self, value):
        """Whether the floor is held; without one, always."""
        return self.floor is None or self.met(value, self.floor)

    def line(self, value):
        """The figure for people."""
        if value is None:
            return f"{self.figure}: not measured (target {self.sense} {self.target:g})"
        state = "reached" if self.met(value, self.target) else "not reached"
        lost = "" if self.held(value) else f"; LOST, the floor is {self.floor:g}"
        shown = f"{value:.0f}" if abs(value) >= 1000 else f"{value:.4g}"
        return f"{self.figure} {shown} {self.sense} {self.target:g} {state}{lost}"


def _quality(unit_edges, least, mean, vertices=None):
    """The usual four, each (target, floor)."""
    bounds = [Bound("unit_edges", "≥", *unit_edges), Bound("ratio_least", "≥", *least), Bound("ratio_mean", "≥", *mean)]
    return bounds + ([Bound("vertices_per_complexity", "≤", *vertices)] if vertices else [])


# case: bounds, each (target, floor of today)
EXPECTED = {
    "linear": [*_quality((0.992, 0.992), (0.47, 0.47), (0.90, 0.90), (2.15, 2.15)), Bound("time_ratio", "≤", 0.2, 0.22)],
    "polar-2": [*_quality((0.98, 0.98), (0.46, 0.46), (0.88, 0.88), (2.25, 2.25)), Bound("time_ratio", "≤", 0.2, 0.2)],
    "polar-1": [*_quality((0.92, 0.92), (0.20, 0.20), (0.75, 0.75), (3.0, 3.0)), Bound("time_ratio", "≤", 0.2, 0.2)],
    "cube-linear": _quality((0.992, 0.992), (0.50, 0.50), (0.90, 0.90)),
    "ten-cycles": [Bound("drift evaluated", "≤", 0.5, 0.5), Bound("drift at the vertices", "≤", 0.5, 0.5),
                   Bound("drift carried", "≤", 0.5, 0.5)],
    "large-25k": _quality((0.98, 0.98), (0.30, 0.30), (0.88, 0.88)),
    "large": [*_quality((0.98, 0.98), (0.30, 0.30), (0.88, 0.88)), Bound("rate_ratio", "≥", 5, 4.5),
              Bound("vertices_per_second", "≥", 40_000, 10_000), Bound("bytes_per_vertex", "≤", 1200, 1200)],
    "large-400k": [*_quality((0.98, 0.98), (0.30, 0.30), (0.88, 0.88)), Bound("bytes_per_vertex", "≤", 1200, 1200),
                   Bound("growth", "≤", 1.1, 1.15)],
    "coarsen": [Bound("unit_edges", "≥", 0.97, 0.97), Bound("ratio_least", "≥", 0.25, 0.25),
                Bound("input_vertices_per_second", "≥", 100_000, 70_000), Bound("bytes_per_vertex", "≤", 1200, 1200)],
}
