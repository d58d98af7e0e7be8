"""A cylinder with flat ends: curvature 1/r round it, none along it, and rims with the curvature of a circle."""

import step


def build():
    """Radius 0.25, from z = 0 to z = 1."""
    import cadquery

    return cadquery.Workplane().circle(0.25).extrude(1)


if __name__ == "__main__":
    step.main(build, "cylinder")
