"""Sweeps: sections along paths of lines and arcs, along helices, and what they are joined to."""

from build123d import (
    Axis, BuildLine, BuildPart, BuildSketch, Circle, Cylinder, Ellipse, Helix, Locations, Mode, Plane, Polyline, RadiusArc, Rectangle,
    RectangleRounded, extrude, fillet, sweep,
)


def handle():
    """A grip of rounded rectangular section along a path with two bends, on two round plates with bores."""
    with BuildPart() as part:
        with BuildLine(Plane.XZ) as path:
            line = Polyline((0, 0), (0, 0.6), (1.8, 0.6), (1.8, 0))
            fillet(line.vertices()[1:3], 0.25)
        with BuildSketch(Plane.XY):
            RectangleRounded(0.2, 0.3, 0.07)
        sweep(path=path.line)
        with BuildSketch(Plane.XY):
            with Locations((0, 0), (1.8, 0)):
                Ellipse(0.3, 0.4)
        extrude(amount=-0.1)
        with BuildSketch(Plane.XY):
            with Locations((0, 0.28), (0, -0.28), (1.8, 0.28), (1.8, -0.28)):
                Circle(0.05)
        extrude(amount=-0.1, mode=Mode.SUBTRACT)
    return part.part


def auger():
    """A shaft with two turns of a flight, a rectangle swept along a helix: helical ruled faces that meet the shaft's cylinder."""
    with BuildPart() as part:
        Cylinder(0.15, 2.0)
        with BuildLine() as path:
            Helix(pitch=0.6, height=1.2, radius=0.14, center=(0, 0, -0.6))
        with BuildSketch(Plane(origin=path.line @ 0, x_dir=(1, 0, 0), z_dir=path.line % 0)):
            with Locations((0.14, 0)):
                Rectangle(0.28, 0.08)
        sweep(path=path.line, is_frenet=True)
    return part.part


def mug():
    """A cup with a wall of 0.06, rounded at its foot, and a handle of elliptic section swept along an arc."""
    with BuildPart() as part:
        Cylinder(0.4, 0.9)
        fillet(part.edges().sort_by(Axis.Z)[0], 0.12)
        with BuildLine(Plane.XZ) as path:
            RadiusArc((0.34, 0.25), (0.34, -0.25), 0.3)
        with BuildSketch(Plane(origin=path.line @ 0, z_dir=path.line % 0)):
            Ellipse(0.05, 0.08)
        sweep(path=path.line)
        with Locations((0, 0, 0.06)):
            Cylinder(0.34, 0.9, mode=Mode.SUBTRACT)
    return part.part


MODELS = {"handle": handle, "auger": auger, "mug": mug}
