"""The plot of the study: the error against the vertices, one picture a scalar (matplotlib, no display needed)."""

from .study import COUNTED


def draw(path, results):
    """Writes it, from {scalar: Study.result()}."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, places = pyplot.subplots(1, len(results), figsize=(5.2 * len(results), 4.8), squeeze=False)
    for axes, (name, result) in zip(places[0], results.items()):
        _panel(axes, name, result)
    figure.tight_layout()
    figure.savefig(path, dpi=130)
    pyplot.close(figure)


def _panel(axes, name, result):
    steps, cycles = result["steps"], result["cycles"]
    counted = [cycle for step in steps for cycle in [c for c in cycles if c["complexity"] == step["complexity"]][-COUNTED:]]
    axes.loglog([s["uniform_vertices"] for s in steps], [s["uniform_error"] for s in steps], "s--", color="tab:gray", label="uniform")
    axes.loglog([c["vertices"] for c in counted], [c["error"] for c in counted], ".", color="tab:blue", alpha=0.5)
    order = result["order"]
    label = "adapted" if order is None else f"adapted: error ∝ N^-{order:.3f} at last"
    axes.loglog([s["vertices"] for s in steps], [s["error"] for s in steps], "o-", color="tab:blue", label=label)
    if result["finest_order"] is not None:
        label = f"adapted, against the finest mesh: N^-{result['finest_order']:.3f}"
        axes.loglog([s["vertices"] for s in steps], [s["finest_error"] for s in steps], "^-", color="tab:green", label=label)
    # The slope of second order, through the last point.
    last, first = steps[-1], steps[0]
    line = [last["error"] * (s["vertices"] / last["vertices"]) ** (-2 / 3) for s in (first, last)]
    axes.loglog([first["vertices"], last["vertices"]], line, ":", color="black", label="second order: N^(-2/3)")
    axes.set(title=name, xlabel="vertices N", ylabel="L2 interpolation error")
    axes.grid(True, which="both", alpha=0.25)
    axes.legend()
