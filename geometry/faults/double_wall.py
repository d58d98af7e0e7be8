"""Two halves of a wing that were sewn where they touch, each with its own wall there: the faces of the two walls lie on each other."""


def sewn(*parts):
    """Parts as one shape, joined where edges with one face alone lie on each other."""
    import cadquery
    from OCP.BRepBuilderAPI import BRepBuilderAPI_Sewing

    sewing = BRepBuilderAPI_Sewing(1e-6)
    for part in parts:
        sewing.Add(part.wrapped)
    sewing.Perform()
    return cadquery.Shape.cast(sewing.SewedShape())


def build():
    """One shell of 10 faces, 14 edges, 6 vertices. The lower part of a wall shares its curved edge with the skin of one half, the upper part with
    that of the other; both walls are like that, so the shell bounds both halves, one of them inside out."""
    import cadquery

    ends = [cadquery.Vector(0, 0, 0), cadquery.Vector(1, 0, 0)]
    chord = cadquery.Edge.makeLine(*ends)
    arc = {z: cadquery.Edge.makeThreePointArc(ends[0], cadquery.Vector(0.5, 0, z), ends[1]) for z in (-0.1, 0.1)}
    wall = {z: cadquery.Face.makeFromWires(cadquery.Wire.assembleEdges([arc[z], chord])) for z in arc}
    skin, tip = {}, {}
    for y in (-2, 2):
        away = cadquery.Vector(0, y, 0)
        for z in arc:
            skin[y, z] = cadquery.Face.makeRuledSurface(arc[z], arc[z].translate(away))
        outline = cadquery.Wire.assembleEdges([arc[z].translate(away) for z in arc])
        tip[y] = cadquery.Face.makeFromWires(outline)
    crossed = [
        sewn(sewn(skin[-2, -0.1], wall[-0.1]), sewn(skin[2, 0.1], wall[0.1])),
        sewn(sewn(skin[2, -0.1], wall[-0.1]), sewn(skin[-2, 0.1], wall[0.1])),
    ]
    shell = sewn(*crossed, *tip.values()).Shells()[0]
    return cadquery.Workplane(cadquery.Solid.makeSolid(shell))
