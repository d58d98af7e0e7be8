"""The cube-cylinder of the UGAWG benchmark: the unit cube [0, 1]³ less the cylinder r ≤ 0.5 about z.

Of the cylinder a quarter lies in the cube, so its wall is one face without a seam. Volume 1 − π/16.
"""

import step


def build():
    """6 planes and a cylinder, 15 edges, 10 vertices."""
    import cadquery

    cube = cadquery.Workplane().box(1, 1, 1, centered=False)
    return cube.cut(cadquery.Workplane().circle(0.5).extrude(1))


if __name__ == "__main__":
    step.main(build, "cube-cylinder")
