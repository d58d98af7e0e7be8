"""Lofts between sections of different shape, and fillets along what comes of them."""

from build123d import (
    BuildPart, BuildSketch, Circle, Cylinder, Ellipse, GeomType, Mode, Plane, PolarLocations, RectangleRounded, Rot, SlotOverall, add, fillet,
    loft,
)


def transition_duct():
    """A duct with a wall of 0.05 from a rounded rectangle over an ellipse to a circle: two lofted walls beside each other, open at both ends."""
    with BuildPart() as part:
        for wall, mode in [(0.0, Mode.ADD), (0.05, Mode.SUBTRACT)]:
            with BuildSketch(Plane.XY):
                RectangleRounded(1.2 - 2 * wall, 0.8 - 2 * wall, 0.25 - wall)
            with BuildSketch(Plane.XY.offset(0.7)):
                Ellipse(0.5 - wall, 0.4 - wall)
            with BuildSketch(Plane.XY.offset(1.4)):
                Circle(0.3 - wall)
            loft(mode=mode)
    return part.part


def impeller():
    """A hub with a bore and six twisted blades, each lofted between two turned slots on planes that stand across the radius."""
    with BuildPart() as part:
        Cylinder(0.3, 0.5)
        with BuildPart(mode=Mode.PRIVATE) as blade:
            for radius, turn, length in [(0.2, 35, 0.4), (0.9, 65, 0.5)]:
                with BuildSketch(Plane(origin=(radius, 0, 0), x_dir=(0, 1, 0), z_dir=(1, 0, 0)) * Rot(0, 0, turn)):
                    SlotOverall(length, 0.07)
            loft(ruled=True)
        with PolarLocations(0, 6):
            add(blade.part)
        Cylinder(0.1, 0.5, mode=Mode.SUBTRACT)
    return part.part


def pipe_cross():
    """Two pipes of different bores that cross; fillets run along the curves in which they meet outside, and none inside."""
    with BuildPart() as part:
        Cylinder(0.35, 2.0)
        Cylinder(0.22, 2.0, rotation=(0, 90, 0))
        crossings = part.edges().filter_by(lambda edge: edge.geom_type not in (GeomType.CIRCLE, GeomType.LINE))
        fillet(crossings, 0.08)
        Cylinder(0.27, 2.0, mode=Mode.SUBTRACT)
        Cylinder(0.16, 2.0, rotation=(0, 90, 0), mode=Mode.SUBTRACT)
    return part.part


MODELS = {"transition-duct": transition_duct, "impeller": impeller, "pipe-cross": pipe_cross}
