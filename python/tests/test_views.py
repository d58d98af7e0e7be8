"""pyvista and meshio."""

import numpy as np
import pytest

import geo_adapt


def cube():
    mesh = geo_adapt.examples.cube(3)
    mesh.fields = {"p": mesh.points[:, 0].copy(), "u": mesh.points.copy()}
    return mesh


def same(a, b):
    assert (a.points == b.points).all() and (a.tets == b.tets).all()
    assert (a.fields["p"] == b.fields["p"]).all() and (a.fields["u"] == b.fields["u"]).all()


def test_meshio_there_and_back():
    pytest.importorskip("meshio")
    mesh = cube()
    again = geo_adapt.Mesh.from_meshio(mesh.to_meshio())
    same(mesh, again)
    assert (again.triangles == mesh.triangles).all() and (again.references == mesh.references).all()


def test_pyvista_there_and_back():
    pytest.importorskip("pyvista")
    mesh = cube()
    again = geo_adapt.Mesh.from_pyvista(mesh.to_pyvista(triangles=True))
    same(mesh, again)
    assert (again.triangles == mesh.triangles).all() and (again.references == mesh.references).all()


def test_pyvista_finds_readers_writers_and_the_accessor(tmp_path):
    """By the entry points of the installed package."""
    pyvista = pytest.importorskip("pyvista")
    from importlib.metadata import PackageNotFoundError, distribution

    try:
        distribution("geo-adapt")
    except PackageNotFoundError:
        pytest.skip("geo-adapt is not installed, but run from its sources")
    mesh = cube()
    grid = mesh.to_pyvista()
    grid.save(tmp_path / "a.meshb")
    found = pyvista.read(tmp_path / "a.meshb")
    assert found.n_cells == len(mesh.tets) and (np.asarray(found.points) == mesh.points).all()
    new = found.geo_adapt.adapt(np.tile(np.eye(3) * 40, (found.n_points, 1, 1)))
    assert new.n_points > found.n_points


def test_a_page_is_written(tmp_path):
    cube().write_page(tmp_path / "page.html", "p")
    assert b"<html" in (tmp_path / "page.html").read_bytes()[:400].lower()
    assert "27" not in repr(cube()) and "<table>" in cube()._repr_html_()
