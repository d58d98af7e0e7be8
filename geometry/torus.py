"""A torus: one face, periodic in both parameters. Across the tube the curvature is 1/r, along it cos v / (R + r cos v)."""

import step


def build():
    """R = 1, r = 0.3 about z."""
    import cadquery

    return cadquery.Workplane().add(cadquery.Solid.makeTorus(1, 0.3))


if __name__ == "__main__":
    step.main(build, "torus")
