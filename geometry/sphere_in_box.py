"""A box with a spherical hole inside: two shells, and a sphere that has a seam and two degenerate edges (its poles)."""

import step


def build():
    """The box [0, 2] × [0, 1.6] × [0, 1.2] less a sphere of radius 0.3 about (0.9, 0.8, 0.6): 6 planes and a sphere."""
    import cadquery

    box = cadquery.Workplane().box(2, 1.6, 1.2, centered=False)
    return box.cut(cadquery.Workplane().sphere(0.3).translate((0.9, 0.8, 0.6)))


if __name__ == "__main__":
    step.main(build, "sphere-in-box")
