"""Booleans: edges that are curves of intersection, most of them B-splines that lie on their faces only within a tolerance."""

def cylinder(radius, length, axis):
    """A cylinder about the origin along an axis, as a Workplane."""
    import cadquery

    return cadquery.Workplane({"x": "YZ", "y": "XZ", "z": "XY"}[axis]).circle(radius).extrude(length / 2, both=True)


def cones_cut():
    """A cone, and out of it a second one that lies across: the model on which gmsh's mesher of volumes fails."""
    import cadquery

    upright = cadquery.Workplane().add(cadquery.Solid.makeCone(0.6, 0.1, 1))
    across = cadquery.Solid.makeCone(0.35, 0.05, 1.4, cadquery.Vector(-0.7, 0, 0.45), cadquery.Vector(1, 0, 0))
    return upright.cut(cadquery.Workplane().add(across))


def crossing_cylinders():
    """Two cylinders of radii 0.3 and 0.2 that go through each other: four curves of intersection of fourth degree."""
    return cylinder(0.3, 2, "z").union(cylinder(0.2, 2, "x"))


def steinmetz():
    """What two equal cylinders have in common: four edges that cross in two corners, where all faces are tangent."""
    return cylinder(0.5, 2, "z").intersect(cylinder(0.5, 2, "x"))


def cross_drilled():
    """A block with three bores that meet in its middle."""
    import cadquery

    block = cadquery.Workplane().box(1.4, 1.2, 1)
    return block.cut(cylinder(0.25, 3, "x")).cut(cylinder(0.3, 3, "y")).cut(cylinder(0.2, 3, "z"))


def bored_sphere():
    """A ball of radius 0.6 less a cylinder of radius 0.25 through the middle: the poles are gone, the seam is not."""
    import cadquery

    return cadquery.Workplane().sphere(0.6).cut(cylinder(0.25, 2, "z"))


def three_tori():
    """Three tori about the axes, of R = 0.6 and r = 0.18, in one solid: curves of intersection of eighth degree."""
    import cadquery

    tori = [cadquery.Workplane().add(cadquery.Solid.makeTorus(0.6, 0.18, dir=cadquery.Vector(*axis)))
            for axis in [(1, 0, 0), (0, 1, 0), (0, 0, 1)]]
    return tori[0].union(tori[1]).union(tori[2])


def perforated_plate():
    """A plate of 1.2 × 0.9 × 0.1 with twelve round holes: many closed edges and seams."""
    import cadquery

    return cadquery.Workplane().box(1.2, 0.9, 0.1).faces(">Z").workplane().rarray(0.3, 0.3, 4, 3).hole(0.2)


def bridged_plate():
    """A plate of 1 × 1 × 0.01 whose round hole leaves bridges of 0.0002 at its sides."""
    import cadquery

    return cadquery.Workplane().box(1, 1, 0.01).cut(cylinder(0.4998, 1, "z").rotate((0, 0, 0), (0, 0, 1), 30))


def sphere_in_cube():
    """A ball of radius 0.65 cut by the sides of a cube of 1: one spherical face with six round openings, its poles cut off."""
    import cadquery

    return cadquery.Workplane().box(1, 1, 1).intersect(cadquery.Workplane().sphere(0.65))


def drilled_torus():
    """A torus of R = 1 and r = 0.3 with a bore of radius 0.12 across its tube: a face that is periodic twice, with two holes in it."""
    import cadquery

    torus = cadquery.Workplane().add(cadquery.Solid.makeTorus(1, 0.3))
    return torus.cut(cadquery.Workplane("YZ").center(0, 0).circle(0.12).extrude(2))


MODELS = {
    "cones-cut": cones_cut,
    "crossing-cylinders": crossing_cylinders,
    "steinmetz": steinmetz,
    "cross-drilled": cross_drilled,
    "bored-sphere": bored_sphere,
    "three-tori": three_tori,
    "perforated-plate": perforated_plate,
    "bridged-plate": bridged_plate,
    "sphere-in-cube": sphere_in_cube,
    "drilled-torus": drilled_torus,
}
