"""Sketches on faces: text, patterns, features on faces that stand askew."""

from build123d import (
    Align, Axis, BuildPart, BuildSketch, Circle, CounterBoreHole, GridLocations, HexLocations, Mode, Plane, Rectangle, RectangleRounded,
    RegularPolygon, SlotOverall, Text, chamfer, extrude, fillet,
)
import typeface


def nameplate():
    """A plate with rounded corners; three letters stand out of it, and three are cut into its other side."""
    with BuildPart() as part:
        with BuildSketch():
            RectangleRounded(2.4, 1.0, 0.2)
        extrude(amount=0.2)
        with BuildSketch(part.faces().sort_by(Axis.Z)[-1]):
            Text("ADA", font_size=0.6, font_path=typeface.path())
        extrude(amount=0.1)
        with BuildSketch(part.faces().sort_by(Axis.Z)[0]):
            Text("PAD", font_size=0.6, font_path=typeface.path())
        extrude(amount=-0.08, mode=Mode.SUBTRACT)
    return part.part


def askew_features():
    """A block with two inclined sides: a hexagonal boss stands on one of them, a slot goes into the other, and four screws through the foot."""
    with BuildPart() as part:
        with BuildSketch(Plane.XZ):
            Rectangle(2.0, 1.0, align=(Align.CENTER, Align.MIN))
        extrude(amount=0.5, both=True)
        chamfer(part.faces().sort_by(Axis.Z)[-1].edges().filter_by(Axis.Y), length=0.6, length2=0.5)
        inclined = part.faces().filter_by(lambda face: 0.1 < face.normal_at().Z < 0.9).sort_by(Axis.X)
        with BuildSketch(inclined[-1]):
            RegularPolygon(0.2, 6)
        extrude(amount=0.25)
        with BuildSketch(inclined[0]):
            SlotOverall(0.6, 0.2)
        extrude(amount=-0.15, mode=Mode.SUBTRACT)
        with BuildSketch(part.faces().sort_by(Axis.Z)[0]):
            RectangleRounded(2.6, 1.4, 0.15)
        extrude(amount=-0.15)
        with BuildSketch(part.faces().sort_by(Axis.Z)[0]):
            with GridLocations(2.3, 1.15, 2, 2):
                Circle(0.06)
        extrude(amount=-0.15, mode=Mode.SUBTRACT)
    return part.part


def honeycomb():
    """A panel with twelve hexagonal cells and a bore at each corner: many walls of 0.06, and angles of 120°."""
    with BuildPart() as part:
        with BuildSketch():
            RectangleRounded(1.7, 1.5, 0.2)
            with HexLocations(0.2, 3, 4):
                RegularPolygon(0.165, 6, major_radius=False, rotation=30, mode=Mode.SUBTRACT)
            with GridLocations(1.5, 1.3, 2, 2):
                Circle(0.05, mode=Mode.SUBTRACT)
        extrude(amount=0.3)
    return part.part


def casting():
    """A hollow box with drafted walls, fillets, a flange and counterbored holes, as it comes out of a mould."""
    with BuildPart() as part:
        with BuildSketch():
            RectangleRounded(2.0, 1.4, 0.3)
        extrude(amount=0.6, taper=6)
        fillet(part.faces().sort_by(Axis.Z)[-1].edges(), 0.12)
        with BuildSketch():
            RectangleRounded(1.7, 1.1, 0.2)
        extrude(amount=0.45, taper=6, mode=Mode.SUBTRACT)
        with BuildSketch():
            RectangleRounded(2.5, 1.9, 0.35)
        extrude(amount=-0.12)
        with BuildSketch(Plane.XY.offset(-0.12)):
            RectangleRounded(1.7, 1.1, 0.2)
        extrude(amount=0.12, mode=Mode.SUBTRACT)
        with GridLocations(2.15, 1.55, 2, 2):
            CounterBoreHole(radius=0.06, counter_bore_radius=0.11, counter_bore_depth=0.05)
    return part.part


MODELS = {"nameplate": nameplate, "askew-features": askew_features, "honeycomb": honeycomb, "casting": casting}
