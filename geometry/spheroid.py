"""A spheroid: a surface of revolution with two poles, where the curvature is a/b² in every direction (no closed form in OCCT)."""

import step


def build():
    """Semi-axes b = 0.5 across z and a = 1 along it."""
    import cadquery

    half = cadquery.Workplane("XZ").ellipseArc(0.5, 1, -90, 90, startAtCurrent=False).close()
    return half.revolve(360, (0, 0, 0), (0, 1, 0))


if __name__ == "__main__":
    step.main(build, "spheroid")
