"""The unit cube [0, 1]³."""

import step


def build():
    """6 planes, 12 edges, 8 vertices."""
    import cadquery

    return cadquery.Workplane().box(1, 1, 1, centered=False)


if __name__ == "__main__":
    step.main(build, "cube")
