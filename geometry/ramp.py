"""The channel of a supersonic ramp: a wedge of 15° from x = 0 on, whose shock at Mach 2 leaves by the outlet, below the top.

x from −0.25 to 1, y up to 1.15, and a slab of WIDTH in z between two planes of symmetry: the flow is plane.
"""

import math

import step

ANGLE, BEFORE, LENGTH, HEIGHT, WIDTH = 15.0, 0.25, 1.0, 1.15, 0.05


def build():
    """7 planes: inlet, floor (before the ramp), ramp, outlet, top, left and right (the planes of symmetry)."""
    import cadquery

    end = LENGTH * math.tan(math.radians(ANGLE))
    outline = cadquery.Workplane().polyline([(-BEFORE, 0), (0, 0), (LENGTH, end), (LENGTH, HEIGHT), (-BEFORE, HEIGHT)]).close()
    channel = outline.extrude(WIDTH)
    assembly = cadquery.Assembly(name="ramp")
    assembly.add(channel, name="gas")
    places = {"inlet": "<X", "outlet": ">X", "top": ">Y", "left": "<Z", "right": ">Z"}
    for name, place in places.items():
        assembly.addSubshape(channel.faces(place).val(), name=name)
    floor, ramp = sorted(channel.faces("#Z").faces("not |X").faces("not >Y").vals(), key=lambda face: face.Center().x)
    assembly.addSubshape(floor, name="floor")
    assembly.addSubshape(ramp, name="ramp")
    return assembly


if __name__ == "__main__":
    step.main(build, "ramp", step.write_assembly)
