"""Parts of machines: many small faces, alike."""

import math


def involute(base, roll):
    """The point of the involute of a circle of radius `base` at the angle of roll `roll` (radians)."""
    return base * (math.cos(roll) + roll * math.sin(roll)), base * (math.sin(roll) - roll * math.cos(roll))


def turned(point, angle):
    """A point of the plane turned about the origin."""
    x, y = point
    return x * math.cos(angle) - y * math.sin(angle), x * math.sin(angle) + y * math.cos(angle)


def gear(teeth=14, module=0.1, thickness=0.25):
    """A spur gear with involute flanks (pressure angle 20°) and a bore: splines, arcs of head and root."""
    import cadquery

    pitch, alpha = module * teeth / 2, math.radians(20)
    base, head, root = pitch * math.cos(alpha), pitch + module, pitch - 1.25 * module
    # Half of the tooth at the base circle: what it is at the pitch circle, and the involute's angle there.
    half = math.pi / (2 * teeth) + math.tan(alpha) - alpha
    rolls = [math.sqrt((head / base) ** 2 - 1) * i / 6 for i in range(7)]
    flank = [turned(involute(base, roll), -half) for roll in rolls]
    mirrored = [(x, -y) for x, y in reversed(flank)]
    outline = cadquery.Workplane().moveTo(root * math.cos(-half), root * math.sin(-half))
    for tooth in range(teeth):
        angle = 2 * math.pi * tooth / teeth
        up = [turned(point, angle) for point in flank]
        down = [turned(point, angle) for point in mirrored]
        outline = outline.lineTo(*up[0]).spline(up[1:], includeCurrent=True)
        outline = outline.threePointArc(turned((head, 0), angle), down[0]).spline(down[1:], includeCurrent=True)
        outline = outline.lineTo(*turned((root, 0), angle + half))
        middle, end = (turned((root, 0), angle + step) for step in (math.pi / teeth, 2 * math.pi / teeth - half))
        outline = outline.threePointArc(middle, end)
    return outline.close().extrude(thickness).cut(cadquery.Workplane().circle(0.3).extrude(thickness))


def screw():
    """A rod of radius 0.3 with one and a half turns of a trapezoidal thread, and a hexagonal head."""
    import cadquery

    pitch, turns = 0.3, 1.5
    helix = cadquery.Wire.makeHelix(pitch, turns * pitch, 0.3)
    profile = cadquery.Workplane("XZ").polyline([(0.27, -0.08), (0.38, -0.03), (0.38, 0.03), (0.27, 0.08)]).close()
    thread = profile.sweep(cadquery.Workplane().add(helix), isFrenet=True).translate((0, 0, 0.2))
    rod = cadquery.Workplane().circle(0.3).extrude(0.9)
    head = cadquery.Workplane().polygon(6, 1).extrude(-0.25)
    return rod.union(thread).union(head)


def stepped_shaft():
    """Five cylinders and a cone on one axis: closed edges alone, no two faces share a corner."""
    import cadquery

    steps = [(0.1, 0), (0.1, 0.2), (0.2, 0.2), (0.2, 0.5), (0.35, 0.5), (0.35, 0.6), (0.2, 0.6), (0.15, 1), (0.05, 1), (0.05, 1.2)]
    profile = cadquery.Workplane("XZ").polyline([(0, 0), *steps, (0, 1.2)]).close()
    return profile.revolve(360, (0, 0, 0), (0, 1, 0))


def letters():
    """A plate with the letters G and A raised on it, drawn with lines and splines (no font is asked for)."""
    import cadquery

    plate = cadquery.Workplane().box(1.3, 0.8, 0.1, centered=(False, False, False))
    g = cadquery.Workplane().moveTo(0.55, 0.55).spline([(0.35, 0.65), (0.12, 0.4), (0.35, 0.15), (0.57, 0.25)], includeCurrent=True)
    g = g.lineTo(0.57, 0.42).lineTo(0.38, 0.42).lineTo(0.38, 0.34).lineTo(0.48, 0.34).lineTo(0.48, 0.29)
    g = g.spline([(0.36, 0.24), (0.22, 0.4), (0.35, 0.56), (0.48, 0.49)], includeCurrent=True).close()
    outline = [(0.68, 0.15), (0.78, 0.15), (0.82, 0.28), (1.04, 0.28), (1.08, 0.15), (1.18, 0.15), (0.98, 0.65), (0.88, 0.65)]
    a = cadquery.Workplane().polyline(outline)
    hole = cadquery.Workplane().polyline([(0.85, 0.36), (1.01, 0.36), (0.93, 0.57)]).close()
    return plate.union(g.extrude(0.2)).union(a.close().extrude(0.2).cut(hole.extrude(0.2).translate((0, 0, 0.1))))


MODELS = {"gear": gear, "screw": screw, "stepped-shaft": stepped_shaft, "letters": letters}
