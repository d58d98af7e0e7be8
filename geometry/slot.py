"""A block with a narrow slot: its two walls face each other across a gap of 0.01."""

import step


def build():
    """The box [0, 2] × [0, 1] × [0, 1] less [1, 1.01] × [0, 1] × [0.4, 1]: two blocks on a common base."""
    import cadquery

    block = cadquery.Workplane().box(2, 1, 1, centered=False)
    return block.cut(cadquery.Workplane().box(0.01, 1, 0.6, centered=False).translate((1, 0, 0.4)))


if __name__ == "__main__":
    step.main(build, "slot")
