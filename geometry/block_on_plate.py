"""A small block on a large plate, two parts: the bottom of the block lies inside the top of the plate."""

import step


def build():
    """plate: [0, 4] × [0, 4] × [0, 1]; block: [1, 2] × [1, 3] × [1, 2]."""
    import cadquery

    assembly = cadquery.Assembly(name="block-on-plate")
    assembly.add(cadquery.Workplane().box(4, 4, 1, centered=False), name="plate")
    assembly.add(cadquery.Workplane().box(1, 2, 1, centered=False).translate((1, 1, 1)), name="block")
    return assembly


if __name__ == "__main__":
    step.main(build, "block-on-plate", step.write_assembly)
