"""A block with a pocket, and the sketch that it was made of: curves and points of no face, as programs export them with the part."""


def build():
    """A block of 3 × 2 × 1 with a rounded pocket: 15 faces, 36 edges and 24 vertices that bound it, and the sketch in its top beside them."""
    import cadquery

    block = cadquery.Workplane().box(3, 2, 1, centered=(True, True, False)).faces(">Z").workplane()
    part = block.rect(1.5, 1).cutBlind(-0.4).edges("|Z and (not <X) and (not >X)").fillet(0.2)
    # The corners that the fillets took away lie in the midst of the top.
    sketch = cadquery.Workplane("XY", origin=(0, 0, 1)).rect(1.5, 1).wires().vals()
    return cadquery.Compound.makeCompound([part.val(), *sketch, cadquery.Vertex.makeVertex(1, 0.75, 1)])
