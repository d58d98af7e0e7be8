"""A sphere: one face with a seam and two poles, curvature 1/r in every direction."""

import step


def build():
    """The sphere of radius 0.5 about (0.1, 0.2, 0.3), its axis along (1, 2, 2)."""
    import cadquery

    plane = cadquery.Plane(origin=(0.1, 0.2, 0.3), normal=(1, 2, 2))
    return cadquery.Workplane(plane).sphere(0.5)


if __name__ == "__main__":
    step.main(build, "sphere")
