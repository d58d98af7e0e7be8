"""Two cubes side by side, as an assembly of two parts: each has a face of its own where they touch. Names and colours."""

import step


def build():
    """copper, red: [0, 1]³; steel, blue: [1, 2] × [0, 1]². The ends are called inlet (green) and outlet."""
    import cadquery

    copper = cadquery.Workplane().box(1, 1, 1, centered=False)
    steel = cadquery.Workplane().box(1, 1, 1, centered=False).translate((1, 0, 0))
    assembly = cadquery.Assembly(name="two-materials")
    assembly.add(copper, name="copper", color=cadquery.Color("red"))
    assembly.add(steel, name="steel", color=cadquery.Color("blue"))
    assembly.addSubshape(copper.faces("<X").val(), name="inlet", color=cadquery.Color("green"))
    assembly.addSubshape(steel.faces(">X").val(), name="outlet")
    return assembly


if __name__ == "__main__":
    step.main(build, "two-materials", step.write_assembly)
