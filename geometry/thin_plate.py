"""A thin plate: top and bottom come near each other and do not touch; the four sides are thin faces."""

import step


def build():
    """The box [0, 2] × [0, 1] × [0, 0.02]."""
    import cadquery

    return cadquery.Workplane().box(2, 1, 0.02, centered=False)


if __name__ == "__main__":
    step.main(build, "thin-plate")
