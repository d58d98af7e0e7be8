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
        return f"{self.figure} {value:.4g} {self.sense} {self.target:g} {state}{lost}"


def _quality(unit_edges, least, mean, vertices=None):
    """The usual four, each (target, floor)."""
    bounds = [Bound("unit_edges", "≥", *unit_edges), Bound("ratio_least", "≥", *least), Bound("ratio_mean", "≥", *mean)]
    return bounds + ([Bound("vertices_per_complexity", "≤", *vertices)] if vertices else [])


# case: bounds, each (target, floor of today)
EXPECTED = {
    "linear": [*_quality((0.992, None), (0.47, None), (0.90, None), (2.15, None)), Bound("time_ratio", "≤", 0.2, None)],
    "polar-2": [*_quality((0.98, None), (0.46, None), (0.88, None), (2.25, None)), Bound("time_ratio", "≤", 0.2, None)],
    "polar-1": [*_quality((0.92, None), (0.20, None), (0.75, None), (3.0, None)), Bound("time_ratio", "≤", 0.2, None)],
    "cube-linear": _quality((0.992, None), (0.50, None), (0.90, None)),
    "ten-cycles": [Bound("drift evaluated", "≤", 0.5, None), Bound("drift at the vertices", "≤", 0.5, None),
                   Bound("drift carried", "≤", 0.5, None)],
    "large-25k": _quality((0.98, None), (0.30, None), (0.88, None)),
    "large": [*_quality((0.98, None), (0.30, None), (0.88, None)), Bound("rate_ratio", "≥", 5, None),
              Bound("vertices_per_second", "≥", 40_000, None), Bound("bytes_per_vertex", "≤", 1200, None)],
    "large-400k": [*_quality((0.98, None), (0.30, None), (0.88, None)), Bound("bytes_per_vertex", "≤", 1200, None),
                   Bound("growth", "≤", 1.1, None)],
    "coarsen": [*_quality((0.97, None), (0.25, None), (0.75, None)), Bound("input_vertices_per_second", "≥", 100_000, None),
                Bound("bytes_per_vertex", "≤", 1200, None)],
}
