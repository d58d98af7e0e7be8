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


MODELS = {
    "two-regions": two_regions,
    "inclusion": inclusion,
    "three-regions": three_regions,
    "coated-pipe": coated_pipe,
    "named-assembly": named_assembly,
}
