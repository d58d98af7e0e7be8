"""Lofts, sweeps, shells and profiles revolved: surfaces without closed form."""

import math


def square_to_circle():
    """A duct from a square of side 1 to a circle of radius 0.3."""
    import cadquery

    return cadquery.Workplane().rect(1, 1).workplane(offset=1).circle(0.3).loft(combine=True)


def twisted_bar():
    """A bar whose rectangular section turns by 120°: ruled surfaces of both signs of curvature."""
    import cadquery

    return cadquery.Workplane().rect(0.6, 0.3).twistExtrude(1.2, 120)


def pipe_bend():
    """A pipe with a wall of 0.06 along an S: bends that are quarters of tori, inside and outside."""
    import cadquery

    path = cadquery.Workplane("XZ").lineTo(0, 0.5).radiusArc((0.5, 1), 0.5).lineTo(0.8, 1).radiusArc((1.3, 1.5), -0.5).lineTo(1.3, 1.8)
    return cadquery.Workplane().circle(0.2).circle(0.14).sweep(path)


def spring():
    """A helical spring: radius 0.5, two turns of pitch 0.35, wire of radius 0.1."""
    import cadquery

    helix = cadquery.Wire.makeHelix(0.35, 0.7, 0.5)
    return cadquery.Workplane("XZ").center(0.5, 0).circle(0.1).sweep(cadquery.Workplane().add(helix), isFrenet=True)


def vase():
    """A spline revolved: curvatures of both signs, a flat foot and a flat top."""
    import cadquery

    side = cadquery.Workplane("XZ").lineTo(0.25, 0).spline([(0.4, 0.3), (0.2, 0.7), (0.3, 1)], includeCurrent=True).lineTo(0, 1).close()
    return side.revolve(360, (0, 0, 0), (0, 1, 0))


def bottle():
    """An elliptic bottle with a wall of 0.03 and a neck, open at its top: thin everywhere, inside and outside near each other."""
    import cadquery

    def flask(wall):
        body = cadquery.Workplane().ellipse(0.5 - wall, 0.3 - wall).extrude(0.8 - 2 * wall).translate((0, 0, wall))
        return body.union(cadquery.Workplane().circle(0.15 - wall).extrude(0.25 + wall).translate((0, 0, 0.7)))

    return flask(0).cut(flask(0.03))


def open_box():
    """A box of walls 0.02, open on top."""
    import cadquery

    return cadquery.Workplane().box(1, 0.7, 0.5).faces(">Z").shell(-0.02)


def star_tower():
    """A closed uniform cubic B-spline like a star with five points, extruded: one periodic wall that waves, with a seam."""
    import cadquery
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge
    from OCP.Geom import Geom_BSplineCurve
    from OCP.gp import gp_Pnt
    from OCP.TColgp import TColgp_Array1OfPnt
    from OCP.TColStd import TColStd_Array1OfInteger, TColStd_Array1OfReal

    poles = TColgp_Array1OfPnt(1, 10)
    knots, multiplicities = TColStd_Array1OfReal(1, 11), TColStd_Array1OfInteger(1, 11)
    for i in range(10):
        r, angle = [0.7, 0.3][i % 2], math.pi * i / 5
        poles.SetValue(i + 1, gp_Pnt(r * math.cos(angle), r * math.sin(angle), 0.0))
    for i in range(11):
        knots.SetValue(i + 1, float(i))
        multiplicities.SetValue(i + 1, 1)
    curve = Geom_BSplineCurve(poles, knots, multiplicities, 3, True)
    wire = cadquery.Wire.assembleEdges([cadquery.Edge(BRepBuilderAPI_MakeEdge(curve).Edge())])
    return cadquery.Workplane().add(cadquery.Solid.extrudeLinear(wire, [], cadquery.Vector(0, 0, 0.8)))


MODELS = {
    "square-to-circle": square_to_circle,
    "twisted-bar": twisted_bar,
    "pipe-bend": pipe_bend,
    "spring": spring,
    "vase": vase,
    "bottle": bottle,
    "open-box": open_box,
    "star-tower": star_tower,
}
