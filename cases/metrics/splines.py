"""Faces of a STEP file on planes, spheres and B-splines: points and principal curvatures at given parameters, with numpy alone.

No CAD kernel and nothing of geo-adapt's: what it finds judges both. Rational, trimmed and other surfaces are not read.
"""

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np


class StepError(Exception):
    """A STEP file that has not what is asked for."""


def basis(knots, degree, t, derivative):
    """Values of the B-splines of this degree on these knots, or of their derivatives, shape (number of splines,) (de Boor)."""
    count = len(knots) - degree - 1
    t = min(max(t, knots[degree]), knots[count])
    # The last span that is not empty belongs to its end as well.
    span = min(int(np.searchsorted(knots, t, side="right")), count) - 1
    values = np.zeros(len(knots) - 1)
    values[span] = 1
    for k in range(1, degree + 1):
        differ = k > degree - derivative
        new = np.zeros(len(knots) - 1 - k)
        for i in range(max(span - k, 0), min(span, len(new) - 1) + 1):
            left, right = knots[i + k] - knots[i], knots[i + k + 1] - knots[i + 1]
            a, b = ((k, -k) if differ else (t - knots[i], knots[i + k + 1] - t))
            new[i] = (a * values[i] / left if left else 0) + (b * values[i + 1] / right if right else 0)
        values = new
    return values


@dataclass
class Plane:
    """Flat: the parameters do not matter."""

    def curvatures(self, _u, _v, _point):
        return np.zeros(2), np.eye(3)


@dataclass
class Sphere:
    """Curved alike everywhere."""

    centre: np.ndarray
    radius: float

    def curvatures(self, _u, _v, point):
        normal = (point - self.centre) / np.linalg.norm(point - self.centre)
        first = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
        first /= np.linalg.norm(first)
        return np.full(2, 1 / self.radius), np.stack([first, np.cross(normal, first), normal])


@dataclass
class Spline:
    """Σ N_i(u) N_j(v) P_ij; poles of shape (nu, nv, 3)."""

    degrees: tuple
    knots: tuple
    poles: np.ndarray

    def derivative(self, u, v, a, b):
        """∂^(a+b) S/∂u^a ∂v^b."""
        along_u = basis(self.knots[0], self.degrees[0], u, a)
        along_v = basis(self.knots[1], self.degrees[1], v, b)
        return np.einsum("i,j,ijk->k", along_u, along_v, self.poles)

    def curvatures(self, u, v, _point):
        """Both principal curvatures, the greater in absolute value first, and rows of directions: theirs and the normal's."""
        su, sv = self.derivative(u, v, 1, 0), self.derivative(u, v, 0, 1)
        normal = np.cross(su, sv)
        area = np.linalg.norm(normal)
        if area < 1e-10 * max(np.linalg.norm(su), np.linalg.norm(sv)) ** 2:
            raise StepError(f"no normal at ({u}, {v})")
        normal /= area
        second = [self.derivative(u, v, *order) @ normal for order in ((2, 0), (1, 1), (0, 2))]
        e1 = su / np.linalg.norm(su)
        e2 = np.cross(normal, e1)
        # Coordinates of the plane as combinations of the derivatives: the second form in an orthonormal frame.
        to = np.linalg.inv(np.stack([[su @ e1, su @ e2], [sv @ e1, sv @ e2]]))
        form = to @ np.array([[second[0], second[1]], [second[1], second[2]]]) @ to.T
        values, vectors = np.linalg.eigh((form + form.T) / 2)
        order = np.argsort(-np.abs(values))
        return values[order], np.stack([*(vectors[:, order].T @ np.stack([e1, e2])), normal])


def faces(path):
    """The surfaces of the faces in the order of their shell, a list; numbers of CAD faces count from 1."""
    text = Path(path).read_text(encoding="ascii", errors="replace")
    table = {int(key): body for key, body in re.findall(r"#(\d+)\s*=\s*(.*?);\s*\n", text, re.S)}
    shells = [body for body in table.values() if body.startswith("CLOSED_SHELL")]
    if len(shells) != 1:
        raise StepError(f"{path}: {len(shells)} closed shells, not one")
    found = []
    for face in _references(shells[0]):
        surface = _references(table[face].split(")", 1)[1])[0]
        found.append(_surface(path, table, surface))
    return found


def _references(text):
    return [int(word) for word in re.findall(r"#(\d+)", text)]


def _numbers(text):
    return [float(word) for word in text.strip("()").split(",")]


def _point(table, key):
    return np.array(_numbers(re.search(r"\(([^()]*)\)\s*\)$", table[key]).group(1)))


def _surface(path, table, key):
    body = re.sub(r"\s+", "", table[key])
    if body.startswith("PLANE"):
        return Plane()
    if body.startswith("SPHERICAL_SURFACE"):
        place, radius = body[:-1].split(",")[1:]
        return Sphere(_point(table, _references(table[int(place[1:])])[0]), float(radius))
    if not body.startswith("B_SPLINE_SURFACE_WITH_KNOTS"):
        raise StepError(f"{path}: #{key} is neither plane, sphere nor B-spline: {body[:40]}")
    poles = re.search(r"\(\((#.*?)\)\)", body)
    rows = np.array([[_point(table, pole) for pole in _references(row)] for row in poles.group(1).split("),(")])
    degrees = tuple(int(word) for word in body[body.index("'',") + 3 :].split(",")[:2])
    lists = [_numbers(part) for part in re.findall(r"\(([-+0-9.,E]+)\)", body[poles.end() :])]
    knots = tuple(np.repeat(values, np.array(times, int)) for times, values in ((lists[0], lists[2]), (lists[1], lists[3])))
    return Spline(degrees, knots, rows)
