"""Our multiscale metric of the UGAWG's ONERA M6 wing beside the one another code made from the same Mach number: where they differ, and why.

The metric in the file is more than multiscale: the README beside it at the UGAWG names its recipe (metrics/recipe.py), which is written
anew here in numpy, with the curvature of the CAD faces from a small B-spline evaluator of its own (metrics/splines.py). Then one step after the
other is ours: the recovery of Hessians (what `metric multiscale` is asked to make before gradation), the gradation, the metric of the curvature.
Printed is for each how far the metric is from the file's, vertex by vertex: |ln(M1^-1/2 M2 M1^-1/2)|; 0.35 is a tenth in all sizes.

Held is issue 5's bound: with our L2 recovery in the recipe no vertex is off by more than our recoveries (l2, fit, jumps) differ from each other
there, up to RESOLUTION: a sweep of gradation intersects the metrics of all neighbours, which depends on their order (by up to 0.5 here, see
the row of the table), and the file does not tell theirs. Exit code 0 when all is held, 1 when not; 0 where the shared files are not there.
"""

import argparse
import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from comparing.expected import Bound  # noqa: E402
from judging import cycles, meshfile, metric, on_cad  # noqa: E402
from metrics import recipe, spread, splines  # noqa: E402

NAMES = ("onera_curvAdapt.meshb", "onera_curvAdapt-mach.solb", "onera_curvAdapt-metric.solb", "onera-m6-sharp-te.stp",
         "onera-m6-sharp-te.egads")
RECOVERIES = ("l2", "fit", "jumps")
RESOLUTION = 0.25
# (target, floor of today)
BOUNDS = [
    Bound("rms_recipe", "≤", 0.05, 0.05),
    Bound("rms_l2", "≤", 0.05, 0.05),
    Bound("greatest_l2", "≤", RESOLUTION, RESOLUTION),
    Bound("beyond_recoveries", "≤", 0, 0),
    Bound("curvature_off", "≤", 1e-5, 1e-5),
    Bound("complexity_ratio_off", "≤", 0.01, 0.01),
]


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    program = cycles.ROOT / "target/release/geo-adapt"
    parser.add_argument("--program", type=Path, default=program, help="the built program (default %(default)s)")
    options = parser.parse_args()
    if not options.program.is_file():
        sys.exit(f"{options.program} is not there: cargo build --release, or cases/run, which does it")
    return options


class Ours:
    """Metrics by the program."""

    def __init__(self, program, mesh, field, model, folder):
        self.program, self.mesh, self.field, self.model, self.folder = program, mesh, field, model, Path(folder)

    def _made(self, subcommand, *words):
        path = self.folder / "metric.solb"
        on_cad.tool(self.program, "metric", subcommand, self.mesh, *words, "-o", path, "-q")
        return meshfile.read_metric(path)

    def multiscale(self, hessian, *gradation):
        """Without gradation the complexity does not matter: the recipe scales it."""
        return self._made("multiscale", self.field, "--hessian", hessian, "--complexity", recipe.COMPLEXITY, "--norm", recipe.NORM,
                          "--aspect-ratio", recipe.ASPECT_RATIO, "--gradation", *gradation)

    def curvature(self, hmax, gradation):
        return self._made("geometry", "--cad", self.model, "--segments", recipe.SEGMENTS, "--feature-cells", "off", "--hmax", hmax,
                          "--hmin", 1e-6, "--aspect-ratio", recipe.CURVATURE_RATIO, "--gradation", gradation)


def zones(mesh, on_boundary):
    """The wing (all CAD faces but sphere and symmetry), the rest of the boundary, and the volume, near (20 root chords) and far."""
    wing = np.zeros(len(mesh.points), bool)
    wing[mesh.triangles[mesh.triangle_refs > 2].ravel()] = True
    near = np.linalg.norm(mesh.points, axis=1) < 20
    return {"wing": wing, "outer boundary": on_boundary & ~wing, "volume near": ~on_boundary & near, "volume far": ~on_boundary & ~near}


def on_faces(mesh, surfaces, raw, ours, hmax):
    """At the vertices on one curved face: how far our curvature's metric is from the recipe's in the tangent plane, the greatest; and ours at all
    vertices, there with the recipe's size along the normal (ours is the least tangential one, not five times that)."""
    alone = np.bincount(mesh.on_faces[:, 0], minlength=len(ours)) == 1
    far, wide = [0.0], ours.copy()
    for (vertex, face), (u, v, *_) in zip(mesh.on_faces, mesh.parameters_on_faces):
        if alone[vertex] and not isinstance(surfaces[face - 1], splines.Plane):
            _, directions = surfaces[face - 1].curvatures(u, v, mesh.points[vertex])
            plane, normal = directions[:2], directions[2]
            theirs, own = (plane @ metrics[vertex] @ plane.T for metrics in (raw, ours))
            far.append(float(spread.distance(theirs[None], own[None])[0]))
            size = min(hmax, recipe.NORMAL_RATIO * np.linalg.eigvalsh(own)[-1] ** -0.5)
            wide[vertex] = plane.T @ own @ plane + np.outer(normal, normal) / size**2
    return max(far), wide


def measured(options, folder):
    """Prints the tables; returns the figures that are held."""
    path, field, given_path, step, model = on_cad.shared("onera-m6", *NAMES)
    mesh, given = meshfile.read_mesh(path), meshfile.read_metric(given_path)
    mach = meshfile.read_fields(field)[1][:, 0]
    domain, ours = recipe.Domain(mesh), Ours(options.program, path, field, model, folder)
    hmax = np.linalg.norm(np.ptp(mesh.points, axis=0)) / 10
    surfaces = splines.faces(step)
    raw = recipe.curvature(mesh, surfaces, hmax)
    parts = zones(mesh, domain.on_boundary)

    def told(name, metrics, other=given):
        far = spread.distance(metrics, other)
        cycles.say(spread.row(name, far, parts))
        return far

    cycles.say("Distance from the file's metric\n" + spread.head(parts))
    magnitudes = domain.from_inside(recipe.magnitude(domain.hessians(mach)))
    solution = recipe.solution_metric(domain, magnitudes)
    anew = recipe.with_geometry(domain, solution, raw)
    far_recipe = told("the recipe, in numpy", anew)
    turned = recipe.Domain(mesh)
    turned.edges = domain.edges[::-1]
    told("  its edges in the opposite order", recipe.with_geometry(turned, recipe.solution_metric(turned, magnitudes), raw))
    told("  without the curvature", solution)
    made = {}
    for hessian in RECOVERIES:
        made[hessian] = recipe.with_geometry(domain, recipe.graded_at_complexity(domain, ours.multiscale(hessian, "off")), raw)
    off = {hessian: told(f"our recovery: {hessian}", made[hessian]) for hessian in RECOVERIES}
    graded = ours.multiscale("l2", recipe.GRADATION)
    told("our recovery (l2) and gradation", recipe.with_geometry(domain, graded, raw))
    curved = ours.curvature(hmax, "off")
    tangential, wide = on_faces(mesh, surfaces, raw, curved, hmax)
    told("our recovery (l2), gradation and curvature", recipe.with_geometry(domain, graded, curved))
    told("  its size along the normal as in the recipe", recipe.with_geometry(domain, graded, wide))
    all_ours = recipe.intersection(graded, ours.curvature(hmax, recipe.GRADATION))
    told("all ours: the curvature's metric graded as well", all_ours)
    told("  without the curvature", graded)
    told("  fit instead of l2, without the curvature", ours.multiscale("fit", recipe.GRADATION))

    cycles.say("\nDistance between two of our recoveries, the other steps as in the recipe\n" + spread.head(parts))
    pairs = [("l2", "fit"), ("l2", "jumps"), ("fit", "jumps")]
    apart = {pair: told(" and ".join(pair), made[pair[0]], made[pair[1]]) for pair in pairs}

    allowed = np.maximum.reduce([apart[pair] for pair in pairs])
    cycles.say("\nVertices where the file is farther from ours than our recoveries are apart, and by more than a resolution (%)")
    cycles.say(f"{'':<28}" + "".join(f"{f'> {least}':>10}" for least in (0, 0.05, 0.1, RESOLUTION)))
    for hessian in RECOVERIES:
        shares = [100 * ((off[hessian] > allowed) & (off[hessian] > least)).mean() for least in (0, 0.05, 0.1, RESOLUTION)]
        cycles.say(f"  {hessian:<26}" + "".join(f"{share:10.2f}" for share in shares))
    volumes = [metric.complexity(mesh.points, mesh.tets, metrics) for metrics in (given, anew, made["l2"], all_ours)]
    cycles.say("\ncomplexity: file {:.0f}, recipe {:.0f}, with our l2 {:.0f}, all ours {:.0f}".format(*volumes))
    return {
        "rms_recipe": spread.rms(far_recipe),
        "rms_l2": spread.rms(off["l2"]),
        "greatest_l2": float(off["l2"].max()),
        "beyond_recoveries": int(((off["l2"] > allowed) & (off["l2"] > RESOLUTION)).sum()),
        "curvature_off": tangential,
        "complexity_ratio_off": abs(volumes[2] / volumes[0] - 1),
    }


def main():
    options = arguments()
    with tempfile.TemporaryDirectory() as folder:
        figures = measured(options, folder)
    lost = 0
    cycles.say("")
    for bound in BOUNDS:
        value = figures[bound.figure]
        lost += not bound.held(value)
        cycles.say(("" if bound.held(value) else "LOST  ") + bound.line(value))
    return 1 if lost else 0


if __name__ == "__main__":
    sys.exit(main())
