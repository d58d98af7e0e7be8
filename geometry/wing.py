"""A swept and tapered wing: two B-spline faces between a nose and a sharp trailing edge, and flat ends."""

import step

# Stations along the chord, closer at the nose.
STATIONS = [0.0, 0.01, 0.04, 0.1, 0.2, 0.35, 0.5, 0.7, 0.85, 1.0]


def thickness(x):
    """Half of a NACA 0012's thickness, with a closed trailing edge: 0 there, and not what rounding leaves of it."""
    return 0.0 if x == 1.0 else 0.6 * (0.2969 * x**0.5 - 0.1260 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4)


def build():
    """Chord 1 at y = 0 and 0.5 at y = 2, the nose swept back by 0.6."""
    import cadquery

    sections = []
    for chord, nose, y in [(1.0, 0.0, 0.0), (0.5, 0.6, 2.0)]:
        points = [cadquery.Vector(nose + chord * x, y, 0.0 - chord * thickness(x)) for x in reversed(STATIONS)]
        # The lower side, from the trailing edge to the nose, which it leaves straight up; and its mirror image.
        tangents = [cadquery.Vector(-1, 0, -0.15), cadquery.Vector(0, 0, 1)]
        lower = cadquery.Edge.makeSpline(points, tangents=tangents)
        upper = lower.mirror("XY")
        sections.append(cadquery.Wire.assembleEdges([lower, upper]))
    return cadquery.Workplane().add(cadquery.Solid.makeLoft(sections, True))


if __name__ == "__main__":
    step.main(build, "wing")
