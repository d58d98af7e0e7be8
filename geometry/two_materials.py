"""Two cubes side by side, as an assembly of two parts: each has a face of its own where they touch. Names, and a face with a colour."""

import step


def build():
    """copper: [0, 1]³; steel: [1, 2] × [0, 1]². The ends are called inlet (green) and outlet. (OCCT writes several colours in any order.)"""
    import cadquery

    copper = cadquery.Workplane().box(1, 1, 1, centered=False)
    steel = cadquery.Workplane().box(1, 1, 1, centered=False).translate((1, 0, 0))
    assembly = cadquery.Assembly(name="two-materials")
    assembly.add(copper, name="copper")
    assembly.add(steel, name="steel")
    assembly.addSubshape(copper.faces("<X").val(), name="inlet", color=cadquery.Color("green"))
    assembly.addSubshape(steel.faces(">X").val(), name="outlet")
    return assembly


if __name__ == "__main__":
    step.main(build, "two-materials", step.write_assembly)
