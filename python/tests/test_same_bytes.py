"""What comes of Python is what comes of the program, byte for byte, on one thread and on two."""

import numpy as np
import pytest

import geo_adapt
from geo_adapt import metric

THREADS = [1, 2]


@pytest.fixture
def files(tmp_path, mesh):
    """The mesh, a field and a metric as files, with a rather anisotropic metric."""
    plain = geo_adapt.Mesh.read(_written(tmp_path / "mesh.meshb", mesh))
    x = plain.points
    u = np.tanh(8 * (x[:, 0] / x[:, 0].max())) + x[:, 2] ** 2
    geo_adapt.write_sol(tmp_path / "u.solb", u)
    m = metric.multiscale(plain, u, 800, threads=1)
    geo_adapt.write_sol(tmp_path / "m.solb", m)
    return plain, u, m


def _written(path, mesh):
    geo_adapt.Mesh(
        mesh.points, mesh.tets, mesh.triangles, mesh.references, edges=mesh.edges, edge_references=mesh.edge_references
    ).write(path)
    return path


def _same(tmp_path, *names):
    for name in names:
        ours, theirs = (tmp_path / f"{who}{name}" for who in ("ours", "theirs"))
        assert ours.read_bytes() == theirs.read_bytes(), name


@pytest.mark.parametrize("threads", THREADS)
@pytest.mark.parametrize("on_cad", [True, False])
@pytest.mark.parametrize("asked", [{}, {"complexity": 1500.0}, {"vertices": 2500.0}])
def test_adapt(tmp_path, typed, step, model, files, threads, on_cad, asked):
    mesh, _, m = files
    result = geo_adapt.adapt(mesh, m, model if on_cad else None, threads=threads, order="medit", **asked)
    result.mesh.write(tmp_path / "ours.meshb")
    geo_adapt.write_sol(tmp_path / "ours.solb", result.metric)
    options = [f"--{name}={value}" for name, value in asked.items()]
    if on_cad:
        options += ["--cad", step]
    typed("adapt", "mesh.meshb", "--metric", "m.solb", "-o", "theirs.meshb", "--threads", threads, *options)
    _same(tmp_path, ".meshb", ".solb")


@pytest.mark.parametrize("asked", [{"complexity": 700.0}, {"vertices": 1500.0}])
def test_sizes_along_a_curved_wall_are_cut(tmp_path, typed, step, model, files, asked):
    """Sizes of 0.2 about the cylinder of radius 0.25, where cells are 1e-4 thick: unit edges would dive through 200 layers."""
    mesh, _, _ = files
    radius = np.maximum(np.hypot(*mesh.points[:, :2].T), 1e-6)
    out = np.column_stack([mesh.points[:, 0] / radius, mesh.points[:, 1] / radius, 0 * radius])
    thin = (1e-4 + 0.5 * np.maximum(0.25 - radius, 0)) ** -2.0 - 0.2**-2.0
    whole = 0.2**-2.0 * np.eye(3) + np.maximum(thin, 0)[:, None, None] * out[:, :, None] * out[:, None, :]
    m = whole[:, [0, 0, 1, 0, 1, 2], [0, 1, 1, 2, 2, 2]]
    geo_adapt.write_sol(tmp_path / "wall.solb", m)
    with pytest.warns(UserWarning, match="along curved walls"):
        result = geo_adapt.adapt(mesh, m, model, threads=1, order="medit", **asked)
    share, points, factor = result.chords
    assert share == 0.5 and 0 < points <= len(mesh.points) and factor > 2
    assert result.report["chords"] == {"share": share, "vertices": points, "greatest": factor}
    result.mesh.write(tmp_path / "ours.meshb")
    geo_adapt.write_sol(tmp_path / "ours.solb", result.metric)
    options = [f"--{name}={value}" for name, value in asked.items()]
    typed("adapt", "mesh.meshb", "--metric", "wall.solb", "--cad", step, "-o", "theirs.meshb", "--threads", 1, *options)
    _same(tmp_path, ".meshb", ".solb")
    asked_for = geo_adapt.adapt(mesh, m, model, threads=1, order="medit", limit_chords=0.5, **asked)
    assert (asked_for.mesh.points == result.mesh.points).all()
    left = geo_adapt.adapt(mesh, m, model, order="medit", limit_chords="off", max_vertices=500, **asked)
    assert left.chords is None
    for wrong in (0, 1.5, "much"):
        with pytest.raises(geo_adapt.InputError, match="limit_chords"):
            geo_adapt.adapt(mesh, m, model, order="medit", limit_chords=wrong)


@pytest.mark.parametrize("threads", THREADS)
def test_bootstrap(tmp_path, typed, step, model, threads):
    mesh = geo_adapt.bootstrap(model, size=0.3, threads=threads)
    size = mesh.fields.pop("metric")
    mesh.write(tmp_path / "ours.meshb")
    geo_adapt.write_sol(tmp_path / "ours.solb", size)
    typed("bootstrap", step, "-o", "theirs.meshb", "--size", 0.3, "--threads", threads)
    _same(tmp_path, ".meshb", ".solb")


@pytest.mark.parametrize("threads", THREADS)
def test_metric(tmp_path, typed, step, model, files, threads):
    mesh, u, m = files
    sizes = 0.1 + abs(mesh.points[:, 0])
    cloud = np.random.default_rng(5).normal(size=(300, 3))
    geo_adapt.write_sol(tmp_path / "h.solb", sizes)
    np.savetxt(tmp_path / "cloud.txt", cloud, fmt="%.17g")
    iso, n = metric.isotropic(sizes), {"threads": threads}
    adjoint = np.exp(-4 * (mesh.points**2).sum(1))
    geo_adapt.write_sol(tmp_path / "adjoint.solb", adjoint)
    (tmp_path / "terms.toml").write_text(
        "[[terms]]\nfield = 'u.solb'\nadjoint = 'adjoint.solb'\nderivatives = { x = 1, yz = 0.1 }\n[[terms]]\nfield = 'u.solb'\nweight = 'h.solb'\n"
    )
    geo_adapt.write_sol(tmp_path / "iso.solb", iso)
    made = {
        "multiscale mesh.meshb u.solb --complexity 700 --norm 4 --hessian jumps --hmin 0.01": metric.multiscale(
            mesh, u, 700, norm=4, hessian="jumps", hmin=0.01, **n
        ),
        "goal mesh.meshb --terms terms.toml --complexity 600": metric.goal(
            mesh, [(u, adjoint, {"x": 1, "yz": 0.1}), (u, sizes)], 600, **n
        ),
        f"geometry mesh.meshb --cad {step}": metric.geometry(mesh, model, **n),
        "geometry mesh.meshb": metric.geometry(mesh, **n),
        "isotropic mesh.meshb h.solb": iso,
        "intersect m.solb iso.solb": metric.intersect(m, iso, order="medit", **n),
        "grade mesh.meshb m.solb --ratio 1.2": metric.grade(mesh, m, 1.2, order="medit", **n),
        "limit m.solb --hmin 0.05 --hmax 0.4 --aspect-ratio 3": metric.limit(
            m, hmin=0.05, hmax=0.4, aspect_ratio=3, order="medit", **n
        ),
        "scale mesh.meshb m.solb --complexity 321": metric.scale(mesh, m, 321, order="medit", **n),
        "implied mesh.meshb": metric.implied(mesh, **n),
        "from-points mesh.meshb cloud.txt": metric.from_points(mesh, cloud, **n),
    }
    for words, ours in made.items():
        geo_adapt.write_sol(tmp_path / "ours.solb", ours)
        typed("metric", *words.split(), "-o", "theirs.solb", "--threads", threads)
        assert (tmp_path / "ours.solb").read_bytes() == (tmp_path / "theirs.solb").read_bytes(), words


@pytest.mark.parametrize("threads", THREADS)
def test_transfer(tmp_path, typed, files, threads):
    mesh, u, m = files
    new = geo_adapt.adapt(mesh, m, order="medit", complexity=500, threads=threads).mesh
    new.write(tmp_path / "new.meshb")
    for options, found in {
        "": geo_adapt.transfer(mesh, u, new, threads=threads),
        "--conservative": geo_adapt.transfer(mesh, u, new, conservative=True, threads=threads),
        "--conservative=mass": geo_adapt.transfer(mesh, u, new, conservative="mass", threads=threads),
    }.items():
        geo_adapt.write_sol(tmp_path / "ours.solb", found)
        typed("transfer", "mesh.meshb", "u.solb", "new.meshb", "-o", "theirs.solb", "--threads", threads, *options.split())
        _same(tmp_path, ".solb")
    geo_adapt.write_sol(tmp_path / "ours.solb", geo_adapt.transfer(mesh, m, new, metric=True, order="medit", threads=threads))
    typed("transfer", "mesh.meshb", "m.solb", "new.meshb", "-o", "theirs.solb", "--metric", "--threads", threads)
    _same(tmp_path, ".solb")


def test_inspect_tells_what_the_program_tells(tmp_path, typed, step, model, files):
    import json

    mesh, _, m = files
    told = json.loads(typed("inspect", "mesh.meshb", "--cad", step, "--metric", "m.solb", "--json").stdout)
    assert geo_adapt.inspect(mesh, m, model, order="medit") == told


@pytest.mark.parametrize("threads", THREADS)
@pytest.mark.parametrize("on_cad", [True, False])
def test_walls(tmp_path, typed, step, model, files, threads, on_cad):
    mesh, _, _ = files
    wall = int(mesh.references[0])
    with_model = model if on_cad else None
    cad = ["--cad", step] if on_cad else []
    made = metric.wall(mesh, {wall: {"h": 1e-3, "growth": 1.3}}, with_model, threads=threads)
    geo_adapt.write_sol(tmp_path / "ours.solb", made)
    words = ["--wall", f"{wall}:h=0.001,growth=1.3", "-o", "theirs.solb", "--threads", threads]
    typed("metric", "wall", "mesh.meshb", *cad, *words)
    _same(tmp_path, ".solb")
    geo_adapt.write_sol(tmp_path / "ours.solb", metric.distance(mesh, wall, with_model, threads=threads))
    typed("field", "distance", "mesh.meshb", *cad, "--faces", wall, "-o", "theirs.solb", "--threads", threads)
    _same(tmp_path, ".solb")


def test_walls_that_are_not_there(mesh):
    with pytest.raises(geo_adapt.InputError, match="no surface is called"):
        metric.wall(mesh, {"nothing": {"h": 1e-3}})
    with pytest.raises(geo_adapt.InputError, match="no triangle with reference"):
        metric.distance(mesh, 12345)
    with pytest.raises(geo_adapt.InputError, match="give a positive number"):
        metric.wall(mesh, {int(mesh.references[0]): {"h": 0}})
