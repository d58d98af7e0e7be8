"""Primitives: one or two kinds of surface each, with the poles, apices, seams and rims that they bring."""

def wedge():
    """Five planes: a box of 1 × 1 × 0.5 whose top is 0.25 wide, the walls beside it inclined."""
    import cadquery

    return cadquery.Workplane().add(cadquery.Solid.makeWedge(1, 0.5, 1, 0.375, 0.25, 0.625, 0.75))


def tetrahedron():
    """Four planes that meet under 39° to 90°: the corner of a box with legs 1, 0.8 and 0.5."""
    from zoo.polyhedra import polyhedron

    return polyhedron([(0, 0, 0), (1, 0, 0), (0, 0.8, 0), (0, 0, 0.5)], [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])


def hexagonal_prism():
    """Angles of 120° between the walls."""
    import cadquery

    return cadquery.Workplane().polygon(6, 1).extrude(0.6)


def ellipsoid():
    """Semi-axes 0.8, 0.5 and 0.3: a B-spline with two poles and a seam, and nothing of revolution."""
    import cadquery

    stretch = cadquery.Matrix([[0.8, 0, 0, 0], [0, 0.5, 0, 0], [0, 0, 0.3, 0]])
    return cadquery.Workplane().add(cadquery.Solid.makeSphere(1, angleDegrees1=-90, angleDegrees2=90).transformGeometry(stretch))


def capsule():
    """A cylinder between two half-spheres of its radius, 0.3: edges where faces meet smoothly, each face with a pole or a seam."""
    import cadquery

    half = cadquery.Workplane("XZ").moveTo(0, -0.8).threePointArc((0.3 * 0.5**0.5, -0.5 - 0.3 * 0.5**0.5), (0.3, -0.5)).lineTo(0.3, 0.5)
    half = half.threePointArc((0.3 * 0.5**0.5, 0.5 + 0.3 * 0.5**0.5), (0, 0.8)).close()
    return half.revolve(360, (0, 0, 0), (0, 1, 0))


def partial_torus():
    """A quarter of a torus, R = 1 and r = 0.3, between two flat discs."""
    import cadquery

    return cadquery.Workplane("XZ").center(1, 0).circle(0.3).revolve(90, (-1, 0, 0), (-1, 1, 0))


def frustum():
    """A cone without its apex: radius 0.5 at z = 0, 0.2 at z = 0.6."""
    import cadquery

    return cadquery.Workplane().add(cadquery.Solid.makeCone(0.5, 0.2, 0.6))


def half_sphere():
    """Radius 0.5; one pole, and a rim at a right angle."""
    import cadquery

    return cadquery.Workplane().add(cadquery.Solid.makeSphere(0.5, angleDegrees1=0, angleDegrees2=90))


def ball_octant():
    """An eighth of a ball of radius 0.7: a face with a degenerate side, without a seam; its pole is a corner of three faces."""
    import cadquery

    return cadquery.Workplane().add(cadquery.Solid.makeSphere(0.7, angleDegrees1=0, angleDegrees2=90, angleDegrees3=90))


def lens():
    """Two caps of spheres of radius 1 that meet in a sharp rim of radius 0.6."""
    import cadquery

    ball = cadquery.Workplane().sphere(1)
    return ball.translate((0, 0, -0.8)).intersect(ball.translate((0, 0, 0.8)))


MODELS = {
    "wedge": wedge,
    "tetrahedron": tetrahedron,
    "hexagonal-prism": hexagonal_prism,
    "ellipsoid": ellipsoid,
    "capsule": capsule,
    "partial-torus": partial_torus,
    "frustum": frustum,
    "half-sphere": half_sphere,
    "ball-octant": ball_octant,
    "lens": lens,
}
