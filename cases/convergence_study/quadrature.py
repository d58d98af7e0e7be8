"""The L2 norm of a function minus its linear interpolant on a mesh, by a rule that is refined where it is not sure.

Each tetrahedron is integrated by two rules of degree 5, which differ from degree 6 on. Where they differ most the tetrahedron is halved in all
directions, until what they differ by, summed, is a small part of the whole. So fronts and jumps within a tetrahedron count as they are.
"""

import itertools

import numpy as np

# Σ |first rule - second rule| over the integral of the squares; half of it for the norm, and in truth far less, since signs differ.
TOLERANCE = 0.02
# Halvings at most, tetrahedra at a time, and tetrahedra halved at most in a level.
LEVELS, CHUNK, MOST = 10, 4_000, 200_000
# Coarser meshes are halved first: few rules may agree by chance.
LEAST = 40_000


def _orbit(place, weight):
    """A point and its images under all permutations of the corners, each with the weight."""
    places = sorted(set(itertools.permutations(place)))
    return [(weight, image) for image in places]


def _rule(*orbits):
    points = [point for orbit in orbits for point in orbit]
    return np.array([weight for weight, _ in points]), np.array([place for _, place in points])


def _near(b):
    return (b, b, b, 1 - 3 * b)


def _between(b):
    return (b, b, 0.5 - b, 0.5 - b)


# Weights (m,), of sum 1, and barycentric coordinates (m, 4). Walkington 2000, 14 points; Keast 1986, 15 points. Both of degree 5.
FIRST = _rule(
    _orbit(_near(0.31088591926330060980), 0.11268792571801585080),
    _orbit(_near(0.092735250310891226402), 0.073493043116361949544),
    _orbit(_between(0.045503704125649649492), 0.042546020777081466438),
)
SECOND = _rule(
    _orbit((0.25, 0.25, 0.25, 0.25), 6544 / 36015),
    _orbit((1 / 3, 1 / 3, 1 / 3, 0.0), 81 / 2240),
    _orbit((1 / 11, 1 / 11, 1 / 11, 8 / 11), 161051 / 2304960),
    _orbit(_between((13 - 91**0.5) / 52), 338 / 5145),
)

# Corners of the eight halves in terms of those of the whole, (8, 4, 4): four at the corners, four about a diagonal of the octahedron between.
_PAIRS = [
    *([(i, j) for j in range(4)] for i in range(4)),
    [(0, 1), (2, 3), (0, 2), (0, 3)], [(0, 1), (2, 3), (0, 3), (1, 3)], [(0, 1), (2, 3), (1, 3), (1, 2)], [(0, 1), (2, 3), (1, 2), (0, 2)],
]
HALVES = np.array([[(np.eye(4)[i] + np.eye(4)[j]) / 2 for i, j in pairs] for pairs in _PAIRS])


def _squares(corners, values, function):
    """∫ (function - linear)² over tetrahedra by both rules, each (n,), from corners (n, 4, 3) and the linear function's values there (n, 4)."""
    edges = corners[:, 1:] - corners[:, :1]
    volumes = np.abs(np.linalg.det(edges)) / 6
    found = []
    for weights, places in (FIRST, SECOND):
        points = places @ corners
        exact = function(points.reshape(-1, 3)).reshape(len(corners), -1)
        found.append(volumes * ((exact - values @ places.T) ** 2 @ weights))
    return found


def _halves(corners, values):
    """The eight halves of tetrahedra, corners (8n, 4, 3) and values (8n, 4)."""
    return (HALVES[None] @ corners[:, None]).reshape(-1, 4, 3), (values @ HALVES.reshape(32, 4).T).reshape(-1, 4)


def _level(corners, values, function):
    parts = [_squares(corners[at : at + CHUNK], values[at : at + CHUNK], function) for at in range(0, len(corners), CHUNK)]
    first, second = (np.concatenate(part) for part in zip(*parts))
    return (first + second) / 2, np.abs(first - second)


def interpolation_error(points, tets, function):
    """The norm, and what it may be off by as a part of it; from points (n, 3), tets (m, 4), and the function from (k, 3) to (k,)."""
    corners, values = points[tets], function(points)[tets]
    while len(corners) < LEAST:
        corners, values = _halves(corners, values)
    total, doubt = 0.0, 0.0
    for level in range(LEVELS + 1):
        integral, differ = _level(corners, values, function)
        order = np.argsort(differ)
        # What may stay: the surest, while their doubt is within what is allowed for this level.
        whole = total + integral.sum()
        allowed = TOLERANCE * whole * (1 - 0.5 ** (level + 1)) - doubt
        count = int(np.searchsorted(np.cumsum(differ[order]), allowed, side="right"))
        count = len(order) if level == LEVELS else max(count, len(order) - MOST)
        stay, go = order[:count], order[count:]
        total, doubt = total + integral[stay].sum(), doubt + differ[stay].sum()
        if len(go) == 0:
            break
        corners, values = _halves(corners[go], values[go])
    return float(np.sqrt(total)), float(doubt / (2 * total)) if total else 0.0
