"""What is seldom right in a mesher: slivers, cusps, apices inside, gaps closed by tolerances."""

def sliver_steps():
    """A cube with a step of 1e-3 on its top and a groove of 2e-3 in one side: faces far narrower than any mesh of it."""
    import cadquery

    block = cadquery.Workplane().box(1, 1, 1, centered=False)
    block = block.union(cadquery.Workplane().box(0.5, 1, 0.001, centered=False).translate((0, 0, 1)))
    return block.cut(cadquery.Workplane().box(0.002, 0.3, 1, centered=False).translate((0.8, 0, 0)))


def sliver_cut():
    """A box whose top is inclined by 0.3°, and a bar that comes out of it: faces 2e-3 high that run out into nothing."""
    import cadquery
    from zoo.polyhedra import polyhedron

    points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 0.5), (1, 0, 0.505), (1, 1, 0.505), (0, 1, 0.5)]
    base = polyhedron(points, [(0, 3, 2, 1), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7), (4, 5, 6, 7)])
    return base.union(cadquery.Workplane().box(0.9, 0.3, 0.5, centered=False).translate((0, 0.35, 0.002)))


def cusps():
    """A block with two conical dimples whose rims touch in a point: the face between has two angles of 0° and touches itself there."""
    import cadquery

    block = cadquery.Workplane().box(1.4, 0.8, 0.4)
    for x in (-0.25, 0.25):
        dimple = cadquery.Workplane().add(cadquery.Solid.makeCone(0.05, 0.25, 0.2)).rotate((0, 0, 0), (0, 0, 1), 90)  # the seam elsewhere
        block = block.cut(dimple.translate((x, 0, 0)))
    return block


def cone_in_box():
    """A box with a cone inside taken out: the apex is seen from outside, with more than a half-space about it."""
    import cadquery

    box = cadquery.Workplane().box(1.2, 1, 1)
    return box.cut(cadquery.Workplane().add(cadquery.Solid.makeCone(0.3, 0, 0.6, cadquery.Vector(0, 0, -0.3))))


def needle():
    """A cone of height 1 and radius 0.03 on a disc: a half angle of 1.7° at the apex."""
    import cadquery

    disc = cadquery.Workplane().circle(0.4).extrude(0.1)
    return disc.union(cadquery.Workplane().add(cadquery.Solid.makeCone(0.03, 0, 1, cadquery.Vector(0, 0, 0.1))))


def plate_in_box():
    """A sheet of 0.8 × 0.6 and a thickness of 1e-3 in the middle of a box: the domain about it."""
    import cadquery

    return cadquery.Workplane().box(2, 1.6, 1.2).cut(cadquery.Workplane().box(0.8, 0.6, 0.001))


def near_tangent():
    """A cylinder that lies on a block and goes 1e-3 deep into it: faces that meet under 3.6°."""
    import cadquery

    block = cadquery.Workplane().box(1, 0.8, 0.3, centered=(True, True, False)).translate((0, 0, -0.3))
    return block.union(cadquery.Workplane("YZ").center(0, 0.499).circle(0.5).extrude(0.6, both=True))


def loose_seams():
    """A box sewn from six faces with gaps: edges and vertices whose tolerance is up to 1e-3."""
    import cadquery
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeSolid, BRepBuilderAPI_Sewing

    sewing = BRepBuilderAPI_Sewing(4e-3)
    for i, face in enumerate(cadquery.Workplane().box(1, 1, 1, centered=False).faces().vals()):
        shift = 1.2e-3 * (i + 1) / 6
        sewing.Add(face.moved(cadquery.Location(cadquery.Vector(shift, -shift, shift))).wrapped)
    sewing.Perform()
    shell = cadquery.Shape.cast(sewing.SewedShape())
    shell = shell if isinstance(shell, cadquery.Shell) else shell.Shells()[0]
    return cadquery.Workplane().add(cadquery.Solid(BRepBuilderAPI_MakeSolid(shell.wrapped).Solid()))


MODELS = {
    "sliver-steps": sliver_steps,
    "sliver-cut": sliver_cut,
    "cusps": cusps,
    "cone-in-box": cone_in_box,
    "needle": needle,
    "plate-in-box": plate_in_box,
    "near-tangent": near_tangent,
    "loose-seams": loose_seams,
}
