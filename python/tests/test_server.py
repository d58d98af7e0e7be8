"""On a service the calls of the package make what they make here, and what goes wrong is told as here."""

import hashlib
import http.server
import os
import signal
import socket
import threading
import time

import numpy as np
import pytest

import geo_adapt
from geo_adapt import metric, transport

MEDIT = {"order": "medit"}


@pytest.fixture
def field():
    """A mesh, a field with a layer, and a metric of it."""
    mesh = geo_adapt.examples.cube(5)
    u = np.tanh(12 * (mesh.points[:, 0] - 0.4)) + mesh.points[:, 2] ** 2
    return mesh, u, metric.multiscale(mesh, u, 400)


def same(a, b):
    """Whether two meshes are the same to the bit."""
    names = ("points", "tets", "triangles", "triangle_references", "tet_references", "edges", "edge_references", "corners")
    return all(np.array_equal(getattr(a, name), getattr(b, name)) for name in names) and a.names == b.names


# The same as here.


@pytest.mark.parametrize("asked", [{}, {"complexity": 500.0}, {"vertices": 600.0}, {"max_vertices": 300}, {"freeze": ["x=0", 4]}])
def test_adapt(server, field, asked):
    mesh, _, m = field
    here, there = geo_adapt.adapt(mesh, m, **asked, **MEDIT), server.adapt(mesh, m, **asked, **MEDIT)
    assert same(here.mesh, there.mesh) and np.array_equal(here.metric, there.metric)
    assert (there.complete, there.growth_end, there.overgrown) == (here.complete, here.growth_end, here.overgrown)
    assert there.report["statistics"]["mean_ratios"] == here.report["statistics"]["mean_ratios"]
    assert (there.complexity, there.deviating, there.crossings) == (here.complexity, here.deviating, here.crossings)
    assert there.off_model.tolist() == here.off_model.tolist()


def test_on_cad(server, step, model, mesh):
    m = metric.isotropic(np.full(len(mesh.points), model.diagonal / 12))
    here = geo_adapt.adapt(mesh, m, model, **MEDIT)
    # By its path, its bytes, the package's model, and the service's.
    for given in (step, model, server.upload(step), server.Model(step)):
        assert same(here.mesh, server.adapt(mesh, m, given, **MEDIT).mesh), given
    assert same(geo_adapt.bootstrap(model, size=0.4), server.bootstrap(step, size=0.4))
    assert np.array_equal(mesh.fields["metric"], server.bootstrap(step).fields["metric"])
    plain = geo_adapt.Mesh(mesh.points, mesh.tets)
    assert same(geo_adapt.classify(plain, model), server.classify(plain, step))
    assert np.array_equal(metric.geometry(mesh, model), server.metric.geometry(mesh, step))
    assert server.inspect(mesh, model=step) == geo_adapt.inspect(mesh, model=model)


def test_a_model_on_the_service_lists_its_faces(server, step, model, tmp_path):
    there = server.Model(step)
    assert [face.kind for face in there.faces] == [face.kind for face in model.faces]
    assert there.diagonal == model.diagonal and len(there.edges) == len(model.edges) and len(there.vertices) == len(model.vertices)
    there.name({"wall": [1]})
    assert there.names == {"wall": [1]} and server.bootstrap(there).names == {"wall": [1]}
    there.write_brep(tmp_path / "a.brep")
    assert len(geo_adapt.Model(tmp_path / "a.brep").faces) == 3
    with pytest.raises(geo_adapt.InputError, match="on a service"):
        geo_adapt.adapt(geo_adapt.examples.cube(2), np.tile(np.eye(3), (27, 1, 1)), there)
    with pytest.raises(geo_adapt.InputError, match="face 9"):
        there.name({"inlet": [9]})
    assert len(server.Model(geo_adapt.examples.cylinder()).faces) == 3


def test_nothing_here_reads_cad(server, step, monkeypatch):
    def none(*_):
        raise AssertionError("a model is read here")

    monkeypatch.setattr(geo_adapt.program, "run", none)
    monkeypatch.setattr(geo_adapt.program, "read_model", none)
    monkeypatch.setattr(geo_adapt.model._kernel, "Model", none)
    mesh = server.bootstrap(step, heal=True)
    m = metric.isotropic(np.full(len(mesh.points), 0.3))
    for model in (step, server.Model(step), mesh.domain or step):
        result = server.adapt(mesh, m, model, **MEDIT)
        assert server.inspect(result.mesh, result.metric, model, **MEDIT)["valid"]


def test_names_beside_a_model_go_with_it(server, tmp_path, step):
    copy = tmp_path / "part.step"
    copy.write_bytes(step.read_bytes())
    (tmp_path / "part.step.names.json").write_text('{"triangles": {"2": {"name": "lid"}}}')
    assert server.Model(copy).names == {"lid": [2]} and server.bootstrap(copy).names == {"lid": [2]}
    assert server.bootstrap(geo_adapt.Model(step, labels={"wall": [1]})).names == {"wall": [1]}


def test_a_far_field_is_a_model_on_the_service(server, step):
    mesh = server.bootstrap(step, far_field="box:3", complexity=3000)
    assert set(mesh.names) == {"farfield", "wall"} and "farfield" in mesh.domain.names
    result = server.adapt(mesh, metric.implied(mesh), mesh.domain, complexity=800, **MEDIT)
    assert server.inspect(result.mesh, model=mesh.domain)["valid"]


def test_metrics(server, field):
    mesh, u, m = field
    there, other = server.metric, metric.isotropic(np.linspace(0.05, 0.3, len(mesh.points)))
    v = mesh.points[:, 1] ** 3
    cloud = np.random.default_rng(1).random((300, 3))
    for ours, theirs in [
        (metric.multiscale(mesh, u, 700, norm=np.inf, hessian="l2", gradation=None, hmin=0.01, hmax=0.5, aspect_ratio=20),
         there.multiscale(mesh, u, 700, norm=np.inf, hessian="l2", gradation=None, hmin=0.01, hmax=0.5, aspect_ratio=20)),
        (metric.multiscale(mesh, [u, v], vertices=900, combine="intersect"), there.multiscale(mesh, [u, v], vertices=900, combine="intersect")),
        (metric.geometry(mesh, cells=None, gradation=None), there.geometry(mesh, cells=None, gradation=None)),
        (metric.intersect(m, other, **MEDIT), there.intersect(m, other, **MEDIT)),
        (metric.grade(mesh, m, 1.2, **MEDIT), there.grade(mesh, m, 1.2, **MEDIT)),
        (metric.limit(m, hmin=0.05, hmax=0.4, **MEDIT), there.limit(m, hmin=0.05, hmax=0.4, **MEDIT)),
        (metric.scale(mesh, m, 200, **MEDIT), there.scale(mesh, m, 200, **MEDIT)),
        (metric.implied(mesh), there.implied(mesh)),
        (metric.from_points(mesh, cloud, 9), there.from_points(mesh, cloud, 9)),
    ]:
        assert np.array_equal(ours, theirs)
    for between in (False, True):
        assert metric.complexity(mesh, m, between=between, **MEDIT) == there.complexity(mesh, m, between=between, **MEDIT)
    full = geo_adapt.full(m)
    assert np.array_equal(there.grade(mesh, full), metric.grade(mesh, full))


@pytest.mark.parametrize("how", [{}, {"conservative": True}, {"conservative": "mass"}])
def test_transfer(server, how):
    old, new = geo_adapt.examples.cube(4), geo_adapt.examples.cube(5)
    x = old.points
    for values in (x[:, 0] ** 2, x, np.column_stack([x, x**2, x[:, :1]]), x[:, :, None] * x[:, None, :]):
        ours, theirs = geo_adapt.transfer(old, values, new, **how), server.transfer(old, values, new, **how)
        assert ours.shape == theirs.shape and np.array_equal(ours, theirs)


def test_transfer_of_a_metric(server, field):
    mesh, _, m = field
    new = geo_adapt.examples.cube(3)
    ours = geo_adapt.transfer(mesh, m, new, metric=True, **MEDIT)
    assert np.array_equal(ours, server.transfer(mesh, m, new, metric=True, **MEDIT))


def test_inspect(server, field):
    mesh, _, m = field
    assert server.inspect(mesh, m, **MEDIT) == geo_adapt.inspect(mesh, m, **MEDIT)
    flat = geo_adapt.Mesh(mesh.points * [1, 1, -1], mesh.tets)
    found = server.inspect(flat)
    assert not found["valid"] and found["flaws"] == geo_adapt.inspect(flat)["flaws"]


def test_other_formats_and_pictures(server, tmp_path, field):
    mesh, u, _ = field
    mesh.fields = {"u": u}
    path = server.convert(mesh, tmp_path / "a.vtu")
    again = geo_adapt.Mesh.read(path)
    assert np.array_equal(again.points, mesh.points) and np.array_equal(again.fields["u"], u)
    assert server.convert(path, tmp_path / "b.meshb", translate=[-1, 0, 0.5]) == tmp_path / "b.meshb"
    moved = geo_adapt.Mesh.read(tmp_path / "b.meshb")
    assert np.allclose(moved.points, mesh.points + [-1, 0, 0.5]) and (tmp_path / "b.solb").is_file()
    server.write_page(mesh, tmp_path / "a.png", "u", size="320x240", cut="x=0.5", no_wire=True)
    assert (tmp_path / "a.png").read_bytes()[1:4] == b"PNG"
    server.write_page(mesh, tmp_path / "a.html")
    assert "<html" in (tmp_path / "a.html").read_text()[:1000].lower()
    with pytest.raises(geo_adapt.InputError, match="colour"):
        server.write_page(mesh, tmp_path / "b.png", colour="u")


# Any command.


def test_run(server, tmp_path, field):
    mesh, u, m = field
    words = ["in.meshb", "-o", "out.meshb", "--metric", "m.solb", "--report", "r.json"]
    named = {"mesh": "in.meshb", "output": "out.meshb", "metric": "m.solb", "report": "r.json", "complexity": np.float64(400)}
    for arguments in ([*words, "--complexity", 400], named):
        job = server.run("adapt", arguments, {"in.meshb": mesh, "m.solb": m}, label="a test")
        seen = list(job.progress())
        assert job.wait(30) is job and job.state == "done" and job.exit_code == 0 and job.reason is None
        assert seen and seen[0].state in ("queued", "running") and all(0 <= at.done <= at.items for at in seen)
        assert job.label == "a test" and job.command == "adapt" and job.request["command"] == "adapt"
        assert job.seconds is not None and job.seconds >= 0
        assert {"out.meshb", "out.solb", "out.names.json", "r.json"} <= set(job.results)
        assert same(job.result("out.meshb").mesh(), geo_adapt.adapt(mesh, m, complexity=400, **MEDIT).mesh)
        assert job.result("r.json").json()["statistics"]["tets"] == len(job.result("out.meshb").mesh().tets)
    assert [path.name for path in job.save(tmp_path / "all")] == sorted(path.name for path in (tmp_path / "all").iterdir())
    file = job.result("out.solb")
    assert hashlib.sha256(file.read()).hexdigest() == file.id and len(file.read()) == file.size
    assert file.save(tmp_path).read_bytes() == file.read() == file.save(tmp_path / "b.solb").read_bytes()
    with pytest.raises(geo_adapt.InputError, match="no 'x'; there are: out"):
        job.result("x")
    # What one job has made is the input of the next: nothing goes up.
    sent = len(server.files())
    figures = server.run("inspect", ["a.meshb", "--json"], {"a.meshb": job.result("out.meshb")}).wait()
    assert '"valid": true' in figures.printed and len(server.files()) == sent
    # It is found again, and forgotten.
    assert server.job(job.id).state == "done" and job.id in [one.id for one in server.jobs(limit=5)]
    job.remove()
    with pytest.raises(geo_adapt.ServerError, match="no such job") as caught:
        server.job(job.id)
    assert caught.value.status == 404


def test_what_is_there_is_not_sent_again(server, monkeypatch):
    mesh = geo_adapt.examples.cube(4)
    mesh.points[0] *= 1.0 + 1e-9
    first = server.upload(mesh, "a.meshb")
    assert first.mesh().names == mesh.names and first.id in [file.id for file in server.files("mesh")]
    monkeypatch.setattr(server._transport, "upload", None)
    assert server.upload(mesh, "b.meshb").id == first.id
    m = metric.implied(mesh)
    # A new metric goes up, which is what cannot be now.
    with pytest.raises(TypeError):
        server.adapt(mesh, m, **MEDIT)
    monkeypatch.undo()
    result = server.adapt(mesh, m, **MEDIT)
    monkeypatch.setattr(server._transport, "upload", None)
    # What a job has made is there, though it was not uploaded, and so is a mesh that is written just so.
    assert server.inspect(result.mesh, result.metric, **MEDIT)["valid"]
    assert server.adapt(result, result.job.result("out.solb")).complete
    first.remove()
    with pytest.raises(geo_adapt.ServerError, match="no such file"):
        first.remove()


def test_large_files_go_in_pieces_and_go_on(server, tmp_path, monkeypatch):
    contents = np.random.default_rng(os.getpid()).bytes(300_000)
    monkeypatch.setattr(transport, "PIECE", 65536)
    monkeypatch.setattr(transport, "PAUSE", 0.01)
    given, broken = server._transport.ask, []

    def ask(method, path, body=None, headers=None):
        """Breaks off in the middle of a piece."""
        if method == "PATCH" and not broken and headers["Upload-Offset"] == "65536":
            broken.append(path)
            half = headers | {"Content-Length": str(len(body))}
            host, port = server.url.removeprefix("http://").split(":")
            with socket.create_connection((host, int(port))) as wire:
                head = f"PATCH {path} HTTP/1.1\r\nHost: {host}:{port}\r\n" + "".join(f"{k}: {v}\r\n" for k, v in half.items())
                wire.sendall(head.encode() + b"\r\n" + body[:1000])
                time.sleep(0.1)
            raise transport.Broken("the wire was cut")
        return given(method, path, body, headers)

    monkeypatch.setattr(server._transport, "ask", ask)
    path = tmp_path / "large.dat"
    path.write_bytes(contents)
    file = server.upload(path)
    assert len(broken) == 1 and file.read() == contents and not server._transport._begun
    assert file.id == hashlib.sha256(contents).hexdigest()
    # One that was given up goes on at the next call.
    monkeypatch.setattr(transport, "TRIES", 0)
    broken.clear()
    other = contents[::-1]
    with pytest.raises(geo_adapt.ServerError, match="cut"):
        server.upload(other, "other.dat")
    begun = dict(server._transport._begun)
    monkeypatch.setattr(server._transport, "ask", given)
    assert len(begun) == 1 and server.upload(other, "other.dat").read() == other


# What goes wrong.


def test_errors(server, tmp_path, field):
    mesh, _, m = field
    with pytest.raises(geo_adapt.ProgramError, match="vertex 4.*not positive definite") as caught:
        server.adapt(mesh, np.where(np.arange(len(m))[:, None] == 3, -1.0, m), **MEDIT)
    assert caught.value.code == 2
    with pytest.raises(geo_adapt.InputError, match="order"):
        server.adapt(mesh, m)
    with pytest.raises(geo_adapt.InputError, match="not both"):
        server.adapt(mesh, m, complexity=1, vertices=1, **MEDIT)
    with pytest.raises(geo_adapt.InputError, match="there is no such command"):
        server.run("rm")
    with pytest.raises(geo_adapt.InputError, match="no such argument"):
        server.run("adapt", {"mush": "a.meshb"})
    with pytest.raises(geo_adapt.InputError, match="threads"):
        server.run("adapt", ["a.meshb", "-o", "b.meshb", "--size", 1, "--threads", 1], {"a.meshb": mesh})
    with pytest.raises(geo_adapt.InputError, match="plain name"):
        server.run("inspect", ["../a.meshb"], {"../a.meshb": b"x"})
    with pytest.raises(geo_adapt.ProgramError, match="a.step"):
        server.bootstrap(server.upload(b"nothing", "a.step"))
    with pytest.raises(geo_adapt.FileError, match="No such file"):
        server.inspect(tmp_path / "a.meshb")
    with pytest.raises(geo_adapt.InputError, match="a folder"):
        server.inspect(tmp_path)
    with pytest.raises(geo_adapt.InputError, match="is no mesh"):
        server.run("inspect", ["a.solb"], {"a.solb": object()})
    job = server.run("inspect", ["a.meshb"], {"a.meshb": b"nothing"})
    with pytest.raises(geo_adapt.ProgramError, match="a.meshb"):
        job.wait()
    assert job.wait(check=False).state == "failed" and "a.meshb" in job.reason and "a.meshb" in job.log()


def test_who_is_not_there(server):
    with socket.socket() as unused:
        unused.bind(("127.0.0.1", 0))
        with pytest.raises(geo_adapt.ServerError, match="is a `geo-adapt serve` at work there") as caught:
            geo_adapt.connect(f"http://127.0.0.1:{unused.getsockname()[1]}")
    assert caught.value.status is None
    for wrong in ("", "ftp://a", "http://", "http://a:b", "http://user:secret@a"):
        with pytest.raises(geo_adapt.InputError, match="address"):
            geo_adapt.connect(wrong)

    class Other(http.server.BaseHTTPRequestHandler):
        def do_GET(self):
            self.send_response(404)
            self.end_headers()

        def log_message(self, *_):
            pass

    with http.server.HTTPServer(("127.0.0.1", 0), Other) as other:
        threading.Thread(target=other.handle_request, daemon=True).start()
        with pytest.raises(geo_adapt.ServerError, match="404 Not Found: this is no service of geo-adapt"):
            geo_adapt.connect(f"http://127.0.0.1:{other.server_port}")


def test_a_token_is_given(tmp_path, monkeypatch, url):
    with geo_adapt.examples.service("--tokens-only", f"--data={tmp_path / 'data'}") as closed:
        with pytest.raises(geo_adapt.ServerError, match="token") as caught:
            geo_adapt.connect(closed)
        assert caught.value.status == 401
        data = f"--data={tmp_path / 'data'}"
        words = {who: geo_adapt.program.run(["serve", "token", "add", who, data]).strip() for who in ("ann", "ben")}
        ann = geo_adapt.connect(closed, words["ann"])
        monkeypatch.setenv("GEO_ADAPT_TOKEN", words["ben"])
        ben = geo_adapt.connect(closed)
        assert (ann.about()["owner"], ben.about()["owner"]) == ("ann", "ben")
        job = ann.run("inspect", ["a.meshb"], {"a.meshb": geo_adapt.examples.cube(2)}).wait()
        with pytest.raises(geo_adapt.ServerError, match="no such job"):
            ben.job(job.id)


def test_who_asks_too_often_waits():
    with geo_adapt.examples.service("--rate=20") as url:
        server = geo_adapt.connect(url)
        assert all(server.about()["owner"] == "local" for _ in range(260))


# Progress and stops.


def large():
    mesh = geo_adapt.examples.cube(10)
    return mesh, metric.isotropic(np.full(len(mesh.points), 0.015))


def test_a_job_is_cancelled(server):
    mesh, m = large()
    job = server.run("adapt", ["a.meshb", "--metric", "m.solb", "-o", "b.meshb"], {"a.meshb": mesh, "m.solb": m})
    with pytest.raises(TimeoutError, match=r"0\.2 s"):
        job.wait(0.2)
    for at in job.progress():
        if at.points > len(mesh.points):
            job.cancel()
    assert job.state == "cancelled" and job.exit_code is not None
    assert geo_adapt.inspect(job.result("b.meshb").mesh())["valid"]


def test_progress_stops(server):
    mesh, m = large()
    told = []

    def progress(at):
        told.append(at)
        return at.points <= len(mesh.points)

    result = server.adapt(mesh, m, progress=progress, **MEDIT)
    assert not result.complete and len(result.mesh.points) > len(mesh.points)
    assert told[-1].operation in {"insertion", "collapse", "reconnection", "smoothing", "projection", "repair"}
    assert geo_adapt.inspect(result.mesh)["valid"]


def test_ctrl_c_ends_the_job(server):
    mesh, m = large()
    threading.Timer(2.0, os.kill, (os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt) as caught:
        server.adapt(mesh, m, **MEDIT)
    assert server.jobs(limit=1)[0].state == "cancelled"
    partial = getattr(caught.value, "partial", None)
    assert partial is None or geo_adapt.inspect(partial.mesh)["valid"]


def test_threads_share_a_server(server, field):
    mesh, _, m = field
    wanted = {c: geo_adapt.adapt(mesh, m, complexity=c, **MEDIT).mesh for c in (150.0, 200.0, 250.0, 300.0)}
    found = {}
    threads = [threading.Thread(target=lambda c=c: found.update({c: server.adapt(mesh, m, complexity=c, **MEDIT).mesh})) for c in wanted]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(same(wanted[c], found[c]) for c in wanted)


def test_a_service_of_its_own_ends_with_the_block():
    with geo_adapt.examples.service() as url:
        geo_adapt.connect(url)
    with pytest.raises(geo_adapt.ServerError):
        geo_adapt.connect(url)
    with pytest.raises(geo_adapt.ProgramError, match="nonsense"):
        with geo_adapt.examples.service("--nonsense"):
            pass
