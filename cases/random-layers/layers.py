"""Metrics of one to three thin layers, drawn by a seed: along planes, spheres, cylinders, and walls of the model."""

from dataclasses import dataclass

import numpy as np

from metrics.recipe import intersection

KINDS = ("plane", "sphere", "cylinder", "wall")
# Over the diagonal of the model's box: sizes across a layer and along it, as powers of ten; and complexities.
ACROSS, ALONG, COMPLEXITY = (-5, -2), (-1.5, -0.5), (3.5, 4.6)
GROWTH = (0.1, 0.5)


@dataclass
class Layer:
    """Sizes `across` where the distance is 0, growing by `growth` a length away from there up to `along`, which is the size in the layer's own directions.

    `middle` and `direction` tell where it is, `radius` that of a sphere or cylinder; `face` is the model's face of a wall, from 1.
    """

    kind: str
    across: float
    along: float
    growth: float
    middle: np.ndarray
    direction: np.ndarray
    radius: float
    face: int

    def wall(self):
        """The words of `geo-adapt metric wall`: edges whose chords rise by all of the first height, however coarse the mesh is."""
        layer = f"{self.face}:h={self.across:.6g},growth={1 + self.growth:.6g},tangential={self.along:.6g},chord=1"
        return ["--wall", layer, "--hmax", f"{self.along:.6g}", "--exact"]

    def metric(self, points):
        """The field of a plane, sphere or cylinder at `points`, shape (n, 3); returns (n, 3, 3)."""
        offset = points - self.middle
        along_axis = offset @ self.direction
        if self.kind == "plane":
            distance, normals = np.abs(along_axis), np.broadcast_to(self.direction, points.shape)
        else:
            from_middle = offset - (along_axis[:, None] * self.direction if self.kind == "cylinder" else 0)
            length = np.maximum(np.linalg.norm(from_middle, axis=1), 1e-300)
            distance, normals = np.abs(length - self.radius), from_middle / length[:, None]
        across = np.minimum(self.along, self.across + self.growth * distance)
        outer = normals[:, :, None] * normals[:, None, :]
        return self.along**-2 * np.eye(3) + (across**-2 - self.along**-2)[:, None, None] * outer


@dataclass
class Job:
    """What a seed asks for."""

    model: str
    layers: list
    complexity: float
    cycles: int

    def metric(self, points, of_wall):
        """All layers, intersected, at `points`; returns (n, 3, 3). `of_wall` gives the field of a layer along a wall."""
        first, *others = (of_wall(layer) if layer.kind == "wall" else layer.metric(points) for layer in self.layers)
        for other in others:
            first = intersection(first, other)
        return first

    def told(self):
        """In a few words."""
        kinds = " + ".join(f"{layer.kind} {layer.across:.1e}" for layer in self.layers)
        return f"{self.model} {kinds}, C {self.complexity:.0f}, {self.cycles} cycle{'s' * (self.cycles > 1)}"


def drawn(seed, models):
    """The job of a seed; `models` is {name: what `geo-adapt model --json` tells}."""
    rng = np.random.default_rng(seed)
    name = sorted(models)[rng.integers(len(models))]
    model = models[name]
    low, high = (np.array(bound) for bound in model["bounds"])
    layers = [one_layer(rng, low, high, model["diagonal"], len(model["faces"])) for _ in range(rng.integers(1, 4))]
    return Job(name, layers, float(10 ** rng.uniform(*COMPLEXITY)), int(rng.integers(1, 4)))


def one_layer(rng, low, high, diagonal, faces):
    """A layer about a point of the box from `low` to `high`. The chords of its edges rise by its size across at most."""
    direction = rng.normal(size=3)
    # Half of them along an axis: there layers meet planes of the model at no angle, and others at the right one.
    if rng.random() < 0.5:
        direction = np.eye(3)[rng.integers(3)]
    layer = Layer(
        kind=str(rng.choice(KINDS)),
        across=float(10 ** rng.uniform(*ACROSS) * diagonal),
        along=float(10 ** rng.uniform(*ALONG) * diagonal),
        growth=float(rng.uniform(*GROWTH)),
        middle=rng.uniform(low, high),
        direction=direction / np.linalg.norm(direction),
        radius=float(rng.uniform(0.05, 0.4) * diagonal),
        face=int(rng.integers(1, faces + 1)),
    )
    if layer.kind in ("sphere", "cylinder"):
        # Straight edges cannot be longer and lie in the layer.
        layer.along = min(layer.along, (8 * layer.across * layer.radius) ** 0.5)
    return layer
