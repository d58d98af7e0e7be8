"""Fillets and chamfers: faces that meet smoothly, faces that are narrow, radii that change."""

def filleted_tee():
    """Two cylinders, one on the other, with a fillet of radius 0.06 along the curve in which they meet."""
    import cadquery

    run = cadquery.Workplane("YZ").circle(0.3).extrude(0.7, both=True)
    both = run.union(cadquery.Workplane().circle(0.2).extrude(0.8))
    return both.edges(cadquery.selectors.BoxSelector((-0.3, -0.3, 0.1), (0.3, 0.3, 0.5))).fillet(0.06)


def variable_fillet():
    """A block with a fillet along one edge whose radius grows from 0.05 to 0.3."""
    import cadquery
    from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet

    block = cadquery.Workplane().box(1, 1.2, 0.8)
    fillet = BRepFilletAPI_MakeFillet(block.val().wrapped)
    fillet.Add(0.05, 0.3, block.edges(">X and >Z").val().wrapped)
    return cadquery.Workplane().add(cadquery.Shape.cast(fillet.Shape()).Solids())


def chamfered_block():
    """Chamfers of 0.1, and along four edges of 0.05 by 0.2: angles other than right ones, triangles at the corners."""
    import cadquery

    block = cadquery.Workplane().box(1, 0.8, 0.6).edges("|Z").chamfer(0.05, 0.2)
    return block.faces(">Z").edges().chamfer(0.1)


def bracket():
    """An L of sheet 0.12 thick with a rounded bend, round ends and three bores."""
    import cadquery

    profile = cadquery.Workplane("XZ").polyline([(0, 0), (1, 0), (1, 0.12), (0.12, 0.12), (0.12, 0.8), (0, 0.8)]).close().extrude(-0.5)
    profile = profile.edges(cadquery.selectors.BoxSelector((0.05, -0.1, 0.05), (0.2, 0.6, 0.2))).fillet(0.15)
    profile = profile.edges("|Z and >X").fillet(0.2).edges("|X and >Z").fillet(0.15)
    drilled = profile.cut(cadquery.Workplane().pushPoints([(0.5, 0.25), (0.8, 0.25)]).circle(0.07).extrude(0.5))
    return drilled.cut(cadquery.Workplane("YZ").center(0.25, 0.6).circle(0.1).extrude(0.3))


def rounded_pocket():
    """A block with a pocket, all edges of the pocket rounded by 0.05: concave eighths of spheres."""
    import cadquery

    block = cadquery.Workplane().box(1, 0.8, 0.5)
    pocket = cadquery.Workplane().box(0.6, 0.4, 0.6).edges().fillet(0.05).translate((0, 0, 0.25))
    return block.cut(pocket)


MODELS = {
    "filleted-tee": filleted_tee,
    "variable-fillet": variable_fillet,
    "chamfered-block": chamfered_block,
    "bracket": bracket,
    "rounded-pocket": rounded_pocket,
}
