"""Solids from their corners."""


def polyhedron(points, faces):
    """The solid whose flat faces are the given cycles of points, seen counter-clockwise from outside; a Workplane."""
    import cadquery

    corners = [cadquery.Vector(*point) for point in points]
    sides = [cadquery.Face.makeFromWires(cadquery.Wire.makePolygon([corners[i] for i in face], close=True)) for face in faces]
    return cadquery.Workplane().add(cadquery.Solid.makeSolid(cadquery.Shell.makeShell(sides)))
