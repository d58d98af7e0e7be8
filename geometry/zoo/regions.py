"""Several solids in one file: regions that share faces, and an assembly with names and colours."""

def shared(*solids):
    """The solids with their common faces made one (each once in the file's topology), as a list."""
    import cadquery
    from OCP.BOPAlgo import BOPAlgo_Builder

    builder = BOPAlgo_Builder()
    for solid in solids:
        builder.AddArgument(solid.wrapped)
    builder.Perform()
    return cadquery.Shape.cast(builder.Shape()).Solids()


def two_regions():
    """A box of two halves with a wavy interface between them."""
    import cadquery

    box = cadquery.Workplane().box(1, 0.8, 0.8)
    wave = cadquery.Workplane("XZ", origin=(0, 1, 0)).moveTo(-1, -1).lineTo(0.1, -1)
    wave = wave.spline([(-0.1, -0.2), (0.1, 0.2), (-0.1, 1)], includeCurrent=True)
    left = box.intersect(wave.lineTo(-1, 1).close().extrude(2))
    return shared(left.val(), box.cut(left).val())


def inclusion():
    """A ball in a box, both there: an interface that is closed, with seam and poles, and touches nothing."""
    import cadquery

    box = cadquery.Workplane().box(1, 0.9, 0.8)
    ball = cadquery.Workplane().sphere(0.25)
    return shared(box.cut(ball).val(), ball.val())


def three_regions():
    """Three sectors of a cylinder: interfaces that meet in an edge along the axis."""
    import cadquery

    sectors = [cadquery.Workplane().add(cadquery.Solid.makeCylinder(0.5, 0.7, angleDegrees=120)).rotate((0, 0, 0), (0, 0, 1), 120 * i).val()
               for i in range(3)]
    return shared(*sectors)


def coated_pipe():
    """A pipe in a thin coat (0.02) in a block: nested regions, layers that end on the same sides."""
    import cadquery

    block = cadquery.Workplane("XZ").rect(1, 1).circle(0.32).extrude(0.8)
    coat = cadquery.Workplane("XZ").circle(0.32).circle(0.3).extrude(0.8)
    core = cadquery.Workplane("XZ").circle(0.3).circle(0.15).extrude(0.8)
    return shared(block.val(), coat.val(), core.val())


def named_assembly():
    """Two parts with names and colours, each with a face that has its own: what XCAF reads."""
    import cadquery

    base = cadquery.Workplane().box(1, 0.8, 0.3)
    pin = cadquery.Workplane().circle(0.2).extrude(0.5)
    assembly = cadquery.Assembly(name="mount")
    assembly.add(base, name="base", color=cadquery.Color(0.8, 0.1, 0.1))
    assembly.add(pin, name="pin", loc=cadquery.Location(cadquery.Vector(0, 0, 0.15)), color=cadquery.Color(0.1, 0.2, 0.8))
    assembly["base"].addSubshape(base.faces("<Z").val(), name="floor", color=cadquery.Color(0.1, 0.7, 0.2))
    assembly["pin"].addSubshape(pin.faces(">Z").val(), name="inlet", color=cadquery.Color(0.9, 0.8, 0.1))
    return assembly


def rolling():
    """A shaft with a cap on it and two balls in its groove, which they touch along half circles. The surfaces are tangent there: cut by each
    other, off the origin and with the groove in several faces, they meet in a chain of edges down to 1e-3 of a ball."""
    import cadquery

    whole = cadquery.Workplane().circle(0.425).extrude(0.6).translate((0, 0, -0.3))
    whole = whole.cut(cadquery.Workplane().add(cadquery.Solid.makeTorus(0.475, 0.1)))
    wedge = cadquery.Workplane().add(cadquery.Solid.makeCylinder(1, 1, angleDegrees=120))
    shaft = None
    for bottom, turn in ((-1, 0), (-1, 120), (-1, 240), (0, 0), (0, 120), (0, 240)):
        part = whole.intersect(wedge.rotate((0, 0, 0), (0, 0, 1), turn).translate((0, 0, bottom)), clean=False)
        shaft = shaft.union(part, clean=False) if shaft else part
    cap = cadquery.Workplane().circle(0.25).extrude(0.2).translate((0, 0, 0.3))
    ball = cadquery.Workplane().sphere(0.1).translate((0.475, 0, 0))
    parts = [shaft, cap, *(ball.rotate((0, 0, 0), (0, 0, 1), turn) for turn in (60, 180))]
    return [part.translate((-3.6, -1.66, 0.07)).val() for part in parts]


def knife_edge():
    """A block with a step, and on the step another one, whose side leans over until it touches the step's wall along a line."""
    import cadquery

    stairs = cadquery.Workplane("XZ").polyline([(0, 0), (2, 0), (2, 1), (1, 1), (1, 0.5), (0, 0.5)]).close().extrude(1)
    leaning = cadquery.Workplane("XZ").polyline([(0.2, 0.5), (0.8, 0.5), (1, 0.8), (0.2, 0.8)]).close().extrude(1)
    return [stairs.val(), leaning.val()]


MODELS = {
    "two-regions": two_regions,
    "inclusion": inclusion,
    "three-regions": three_regions,
    "coated-pipe": coated_pipe,
    "named-assembly": named_assembly,
    "rolling": rolling,
    "knife-edge": knife_edge,
}
