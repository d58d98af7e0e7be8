"""A cone with its apex, where the curvature is infinite: at the distance s from it 1/(s tan a), a the half angle."""

import step


def build():
    """Radius 0.5 at z = 0, apex at z = 1."""
    import cadquery

    return cadquery.Workplane().add(cadquery.Solid.makeCone(0.5, 0, 1))


if __name__ == "__main__":
    step.main(build, "cone")
