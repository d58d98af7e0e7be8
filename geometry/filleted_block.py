"""A block with all edges rounded and a bore: planes, quarter cylinders, eighths of spheres, and edges along which faces meet smoothly."""

import step


def build():
    """The box [0, 3] × [0, 2] × [0, 1] with fillets of radius 0.2 and a bore of radius 0.4 through the middle."""
    import cadquery

    block = cadquery.Workplane().box(3, 2, 1, centered=False).edges().fillet(0.2)
    return block.cut(cadquery.Workplane().center(1.5, 1).circle(0.4).extrude(1))


if __name__ == "__main__":
    step.main(build, "filleted-block")
