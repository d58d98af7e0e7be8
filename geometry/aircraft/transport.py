"""A transport aircraft of 36 m in one solid: fuselage, fairing, wings with slotted flaps, tails, and nacelles that air flows through.

Lengths are metres; x goes aft, y to the right wing's tip, z up. All is made for y >= 0; the other side is its mirror image, sewn to it.
"""

import functools
import math

# Bodies: control points (x, half-width, top, height of the greatest width, bottom) of Bézier curves, one list a segment.
NOSE = [
    [(0, 0, -0.55, -0.55, -0.55), (0, 0.62, 0.1, -0.55, -1.15), (1.0, 1.1, 0.6, -0.45, -1.5), (2.0, 1.4, 1.1, -0.3, -1.7)],
    [(2.0, 1.4, 1.1, -0.3, -1.7), (3.2, 1.76, 1.7, -0.12, -1.94), (4.6, 1.95, 2.0, 0, -2.0), (6.5, 1.95, 2.0, 0, -2.0)],
]
CABIN = [[(x, 1.95, 2.0, 0, -2.0) for x in ends] for ends in [(6.5, 12.0), (12.0, 20.5), (20.5, 24.0)]]
TAIL = [
    [(24.0, 1.95, 2.0, 0, -2.0), (26.0, 1.95, 2.0, 0, -2.0), (28.0, 1.78, 1.95, 0.2, -1.55), (30.0, 1.45, 1.85, 0.4, -1.0)],
    [(30.0, 1.45, 1.85, 0.4, -1.0), (32.0, 1.12, 1.75, 0.6, -0.45), (34.0, 0.6, 1.55, 0.85, 0.2), (36.0, 0.25, 1.35, 1.1, 0.85)],
]
FAIRING = [
    [(10.0, 0, -1.5, -1.5, -1.5), (10.0, 1.0, -1.2, -1.5, -1.8), (11.0, 2.35, -0.6, -1.5, -2.45), (13.0, 2.35, -0.5, -1.5, -2.45)],
    [(13.0, 2.35, -0.5, -1.5, -2.45), (20.0, 2.35, -0.15, -1.5, -2.45)],
    [(20.0, 2.35, -0.15, -1.5, -2.45), (21.6, 2.35, -0.07, -1.5, -2.45), (23.4, 1.0, -1.0, -1.5, -1.9), (23.4, 0, -1.5, -1.5, -1.5)],
]
# A flap's bracket, in chords of the wing.
BRACKET = [
    [(0.45, 0, -0.045, -0.045, -0.045), (0.45, 0.01, -0.035, -0.045, -0.055), (0.52, 0.025, -0.02, -0.06, -0.095), (0.62, 0.025, -0.015, -0.06, -0.095)],
    [(0.62, 0.025, -0.015, -0.06, -0.095), (0.82, 0.025, -0.005, -0.06, -0.095), (0.97, 0.01, -0.05, -0.06, -0.07), (0.97, 0, -0.06, -0.06, -0.06)],
]

# Wings: stations (nose x, y, z, chord, thickness in chords, turn about x in degrees) from the root to the tip.
WING = [(12.5, 0.6, -1.15, 7.0, 0.14, 0), (15.3, 5.6, -0.71, 4.2, 0.12, 0), (20.5, 16.0, 0.2, 1.7, 0.105, 0)]
WINGLET = [(20.95, 16.55, 0.5, 1.35, 0.095, 50), (21.75, 16.95, 1.7, 0.75, 0.09, 75)]
TAILPLANE = [(31.0, 0.15, 0.9, 3.9, 0.1, 0), (34.1, 5.5, 1.3, 1.7, 0.09, 0), (34.75, 6.0, 1.34, 1.05, 0.09, 0)]
FIN = [(24.6, 0, 1.2, 9.4, 0.085, -90), (29.3, 0, 2.8, 5.0, 0.1, -90), (33.2, 0, 7.4, 2.5, 0.09, -90), (34.2, 0, 8.0, 1.5, 0.09, -90)]
PYLON = [(12.4, 5.2, -1.42, 4.2, 0.09, -90), (15.4, 5.2, -0.8, 2.6, 0.1, -90)]

# Flaps: from y to y, with brackets at y. The wing ends before them along a curve (x, z), the flap's nose is moved away from it; in chords.
FLAPS = [(2.75, 5.4, [3.9]), (5.8, 11.2, [7.2, 9.9])]
COVE = [(0.74, -0.07), (0.706, -0.03), (0.7, -0.01), (0.708, 0.008), (0.735, 0.025), (0.775, 0.041), (0.85, 0.065)]
BEHIND = [(1.3, 0.2), (1.3, -0.2)]
SLOT = (0.02, -0.005)
HINGE = (0.735, 0.0)
SIDE_GAP, DEFLECTION = 0.06, 8.0

# Nacelles: the front end of the axis; control points (x, radius) of lip and cowl, duct, and the end between them.
ENGINE = (11.5, 5.2, -2.35)
NACELLE = [
    [(0, 0.86), (0, 0.96), (0.25, 1.0), (0.6, 1.05)],
    [(0.6, 1.05), (1.3, 1.15), (2.6, 1.05), (4.0, 0.8)],
    [(4.0, 0.8), (4.0, 0.77)],
    [(4.0, 0.77), (2.8, 0.87), (1.8, 0.77), (0.6, 0.77)],
    [(0.6, 0.77), (0.25, 0.77), (0, 0.79), (0, 0.86)],
]


def aerofoil(s, thick):
    """Half of a NACA section's thickness, with a blunt trailing edge, at x = s² of a chord of 1; and its slope in s."""
    half = 0.2969 * s - 0.126 * s**2 - 0.3516 * s**4 + 0.2843 * s**6 - 0.1015 * s**8
    slope = 0.2969 - 0.252 * s - 1.4064 * s**3 + 1.7058 * s**5 - 0.812 * s**7
    return 5 * thick * half + 0.0025 * s**2, 5 * thick * slope + 0.005 * s


def station_at(stations, y):
    """The station at `y`, between two of the list."""
    a, b = next(pair for pair in zip(stations, stations[1:]) if pair[0][1] <= y <= pair[1][1])
    part = (y - a[1]) / (b[1] - a[1])
    return tuple((1 - part) * p + part * q for p, q in zip(a, b))


def direction(station, x, z):
    """The vector in space from (0, 0) to (x, z) in the plane of a station, in its chords."""
    import cadquery

    _, _, _, chord, _, turn = station
    angle = math.radians(turn)
    return chord * cadquery.Vector(x, -z * math.sin(angle), z * math.cos(angle))


def point(station, x, z):
    """The point in space at (x, z) of a station, in chords from its nose."""
    import cadquery

    return cadquery.Vector(*station[:3]) + direction(station, x, z)


def side(station, sign):
    """The upper (1) or lower (-1) side of a section, from the nose, which it leaves upright."""
    import cadquery

    parameters = [i / 7 for i in range(8)]
    points = [point(station, s * s, sign * aerofoil(s, station[4])[0]) for s in parameters]
    tangents = [direction(station, 2 * s, sign * aerofoil(s, station[4])[1]) for s in (0, 1)]
    return cadquery.Edge.makeSpline(points, tangents=tangents, parameters=parameters, scale=False)


def section(station):
    """Both sides of a section, and its trailing edge."""
    import cadquery

    lower, upper = side(station, -1), side(station, 1)
    return cadquery.Wire.assembleEdges([lower, cadquery.Edge.makeLine(lower.endPoint(), upper.endPoint()), upper])


def half_section(station):
    """The upper side of a section, half of its trailing edge, and the chord."""
    import cadquery

    upper, nose, end = side(station, 1), point(station, 0, 0), point(station, 1, 0)
    return cadquery.Wire.assembleEdges([upper, cadquery.Edge.makeLine(upper.endPoint(), end), cadquery.Edge.makeLine(end, nose)])


def loft(stations, outline=section):
    """The solid with straight generators through the outlines at the stations."""
    import cadquery

    return cadquery.Solid.makeLoft([outline(station) for station in stations], True)


def patch(segment, end, sign, y, handle):
    """A quarter of a body's segment: the upper (`end` 2) or lower (4) one, on one side of the plane at `y`."""
    import cadquery
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
    from OCP.Geom import Geom_BezierSurface
    from OCP.GeomConvert import GeomConvert
    from OCP.gp import gp_Pnt
    from OCP.TColgp import TColgp_Array2OfPnt

    poles = TColgp_Array2OfPnt(1, len(segment), 1, 4)
    for i, row in enumerate(segment, 1):
        x, wide, middle, far = row[0], sign * row[1], row[3], row[end]
        across = [(0, far), (handle * wide, far), (wide, middle + handle * (far - middle)), (wide, middle)]
        for j, (b, z) in enumerate(across, 1):
            poles.SetValue(i, j, gp_Pnt(x, y + b, z))
    surface = GeomConvert.SurfaceToBSplineSurface_s(Geom_BezierSurface(poles))
    return cadquery.Face(BRepBuilderAPI_MakeFace(surface, 1e-7).Face())


def body(segments, y=0.0, signs=(1,), handle=0.5523):
    """The quarter faces of a body about a line along x: `handle` 0.5523 makes circles and ellipses, a greater one squarer sections."""
    return [patch(segment, end, sign, y, handle) for segment in segments for sign in signs for end in (2, 4)]


def end_face(row):
    """The flat half of an end of the fuselage."""
    import cadquery

    upper, lower = (patch([row, (row[0] + 1, *row[1:])], end, 1, 0.0, 0.5523) for end in (2, 4))
    arcs = [next(edge for edge in face.Edges() if edge.BoundingBox().xmax < row[0] + 1e-3) for face in (upper, lower)]
    side_line = cadquery.Edge.makeLine(cadquery.Vector(row[0], 0, row[2]), cadquery.Vector(row[0], 0, row[4]))
    return cadquery.Face.makeFromWires(cadquery.Wire.assembleEdges([arcs[0], arcs[1], side_line]))


def solid(faces):
    """The solid inside closed faces."""
    import cadquery
    from OCP.ShapeFix import ShapeFix_Solid

    return cadquery.Solid(ShapeFix_Solid().SolidFromShell(cadquery.Shell.makeShell(faces).wrapped))


def plane_side(faces):
    """The flat face in the hole that the faces leave in y = 0."""
    import cadquery
    from OCP.ShapeAnalysis import ShapeAnalysis_FreeBounds

    holes = cadquery.Compound(ShapeAnalysis_FreeBounds(cadquery.Shell.makeShell(faces).wrapped).GetClosedWires())
    (outline,) = holes.Wires()
    return cadquery.Face.makeFromWires(outline)


def half_body(faces):
    """The solid between faces and y = 0."""
    return solid([*faces, plane_side(faces)])


def behind(shift):
    """The outline at a station of all that is behind the wing's end, or behind the flap's nose."""
    import cadquery

    def outline(station):
        x, z = shift
        curve = cadquery.Edge.makeSpline([point(station, a + x, b + z) for a, b in COVE])
        corners = [curve.endPoint(), *(point(station, a, b) for a, b in BEHIND), curve.startPoint()]
        return cadquery.Wire.assembleEdges([curve, *(cadquery.Edge.makeLine(p, q) for p, q in zip(corners, corners[1:]))])

    return outline


def flap(wing, begin, end):
    """The part of the whole wing behind the slot, turned down about its hinge."""
    ends = [station_at(WING, y) for y in (begin + SIDE_GAP, end - SIDE_GAP)]
    inner, outer = (point(station, *HINGE) for station in ends)
    return wing.intersect(loft(ends, behind(SLOT))).rotate(inner, outer, DEFLECTION)


def bracket(y):
    """The body under the wing at `y` that holds the flap."""
    nose, _, height, chord, _, _ = station_at(WING, y)
    place = [[(nose + chord * x, chord * wide, *(height + chord * z for z in heights)) for x, wide, *heights in part] for part in BRACKET]
    return solid(body(place, y, (1, -1)))


def wing_parts():
    """The wing without what is behind the flaps' slots, the flaps, and their brackets."""
    whole = loft(WING + WINGLET)
    wing, others = whole, []
    for begin, end, brackets in FLAPS:
        wing = wing.cut(loft([station_at(WING, y) for y in (begin, end)], behind((0, 0))))
        others += [flap(whole, begin, end), *map(bracket, brackets)]
    return [wing, *others]


def nacelle():
    """Four quarters about the axis, round at the lip and blunt behind."""
    import cadquery

    x, y, z = ENGINE
    axis = cadquery.Vector(x, y, z), cadquery.Vector(x + 1, y, z)
    curves = [cadquery.Edge.makeBezier([cadquery.Vector(x + a, y, z + r) for a, r in part]) for part in NACELLE]
    starts = [curve.rotate(*axis, angle) for angle in (45, 135, 225, 315) for curve in curves]
    return solid([cadquery.occ_impl.shapes.revolve(start, axis[0], axis[1] - axis[0], 90) for start in starts])


@functools.cache
def skin():
    """The faces of the half y >= 0, without those in y = 0."""
    fuselage = body(NOSE + CABIN + TAIL)
    bodies = [half_body(body(FAIRING, handle=0.7)), loft(FIN, half_section), loft(TAILPLANE), *wing_parts(), loft(PYLON), nacelle()]
    whole = half_body([*fuselage, end_face(TAIL[-1][-1])]).fuse(*bodies)
    return [face for face in whole.Faces() if face.BoundingBox().ymax > 1e-4]


def half():
    """The half y >= 0: its plane side is one face."""
    import cadquery

    return cadquery.Workplane().add(half_body(skin()))


def build():
    """Both halves in one solid."""
    import cadquery

    faces = skin()
    return cadquery.Workplane().add(solid(faces + [face.mirror("XZ") for face in faces]))
