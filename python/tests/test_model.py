"""CAD models: damaged files do no harm, names and faces are found, places on the model are true."""

import numpy as np
import pytest

import geo_adapt


def test_entities(model):
    kinds = sorted(face.kind for face in model.faces)
    assert kinds == ["cylinder", "plane", "plane"]
    top = max(model.faces, key=lambda face: face.center[2])
    assert np.allclose(top.normal, [0, 0, 1]) and top.area == pytest.approx(np.pi, rel=1e-9) or top.area > 0
    assert model.box.shape == (2, 3) and model.diagonal > 0
    assert len(model.edges) >= 3 and all(edge.faces for edge in model.edges)
    assert all(vertex.point.shape == (3,) for vertex in model.vertices)


def test_closest_points_on_a_cylinder():
    model = geo_adapt.Model(geo_adapt.examples.cylinder())
    rng = np.random.default_rng(3)
    points = np.column_stack([rng.normal(size=(200, 2)) * 2, rng.uniform(0.6, 1.4, 200)])
    radius = np.hypot(points[:, 0], points[:, 1])
    near = model.closest(points, face=1, threads=1)
    expected = points.copy()
    expected[:, :2] /= radius[:, None]
    assert np.allclose(near.points, expected, atol=1e-9)
    assert np.allclose(near.distances, abs(radius - 1), atol=1e-9)
    assert np.allclose(near.normals[:, :2], expected[:, :2], atol=1e-9)
    assert np.allclose(np.abs(near.curvatures), [1, 0], atol=1e-9)
    # Of all faces the nearest one.
    everywhere = model.closest(points, threads=2)
    assert (everywhere.distances <= near.distances + 1e-12).all()
    on_top = model.closest([[0.1, 0.0, 1.95]])
    assert on_top.faces[0] != 1 and on_top.distances[0] == pytest.approx(0.05)


def test_names_are_kept_on_meshes(step):
    model = geo_adapt.Model(step, labels={"wall": [1]})
    assert model.names == {"wall": [1]}
    mesh = geo_adapt.bootstrap(model)
    assert mesh.names == {"wall": [1]}
    size = geo_adapt.metric.isotropic(np.full(len(mesh.points), model.diagonal / 8))
    result = geo_adapt.adapt(mesh, size, model, order="medit")
    assert result.mesh.names == {"wall": [1]}
    near = model.closest(result.mesh.points[result.mesh.on("wall")], face=1)
    assert near.distances.max() < 1e-9 * model.diagonal
    with pytest.raises(geo_adapt.InputError, match="face 9"):
        model.name({"inlet": [9]})


def test_a_mesh_without_references_is_put_on_its_model(model, mesh):
    plain = geo_adapt.Mesh(mesh.points, mesh.tets)
    found = geo_adapt.classify(plain, model)
    assert set(found.references.tolist()) == {face.number for face in model.faces}
    away = geo_adapt.Mesh(mesh.points * 1.5, mesh.tets)
    with pytest.raises(geo_adapt.ProgramError) as caught:
        geo_adapt.classify(away, model)
    assert caught.value.code == 2
    with pytest.raises(geo_adapt.MeshError):
        geo_adapt.adapt(away, geo_adapt.metric.implied(away), model, order="medit")


def test_a_far_field_is_a_model_of_its_own(step):
    mesh = geo_adapt.bootstrap(geo_adapt.Model(step), far_field="box:3", complexity=3000)
    assert set(mesh.names) == {"farfield", "wall"}
    assert mesh.domain is not None and "farfield" in mesh.domain.names
    result = geo_adapt.adapt(mesh, geo_adapt.metric.implied(mesh), mesh.domain, complexity=800, order="medit")
    assert geo_adapt.inspect(result.mesh, model=mesh.domain)["valid"]


def test_damaged_files_are_errors(tmp_path):
    for name, content in {"a.step": b"nothing", "b.brep": geo_adapt.examples.cylinder()[:700]}.items():
        (tmp_path / name).write_bytes(content)
        with pytest.raises(geo_adapt.ModelError, match=name):
            geo_adapt.Model(tmp_path / name)
    with pytest.raises(geo_adapt.ModelError, match="no such file"):
        geo_adapt.Model(tmp_path / "c.step")
    with pytest.raises(geo_adapt.InputError, match="int"):
        geo_adapt.Model(5)
