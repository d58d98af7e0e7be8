//! Prisms, pyramids and hexahedra come back as they were.
use crate::sample::{Place, labels, read};
use geo_adapt::formats::{self, Dataset, NamedField, Options};
use geo_adapt::mesh::io::FieldKind;
use geo_adapt::mesh::io::slices::MeshReader;
use geo_adapt::mesh::samples::{of_all_kinds, on_prisms};
use geo_adapt::mesh::stack::{Kind, Stack};
use geo_adapt::tasks::Team;

/// Files that carry them, and whether as text.
const FILES: &[(&str, bool)] = &[
    ("a.mesh", false),
    ("a.meshb", false),
    ("a.su2", false),
    ("a.ugrid", false),
    ("a.b8.ugrid", false),
    ("a.lb8l.ugrid", false),
    ("a.vtu", false),
    ("a.vtu", true),
    ("a.msh", false),
    ("a.msh", true),
    ("a.msh2", false),
    ("a.msh2", true),
    ("a.cgns", false),
    ("case/", false),
    ("case/", true),
];

/// All kinds of cells, with coordinates that need all their digits.
fn all_kinds() -> Dataset {
    let (mut mesh, mut stack) = of_all_kinds();
    mesh.vertices.iter_mut().enumerate().for_each(|(v, p)| p.iter_mut().for_each(|x| *x = *x / 3.0 + 1e-9 * v as f64));
    stack.join(&mut mesh).unwrap();
    let mut data = Dataset { mesh, stack, ..Dataset::default() };
    data.names.triangles = labels(&[(5, "wall"), (2, "far")]);
    data
}

/// The coordinates of some nodes, to the bit.
type Corners = Vec<[u64; 3]>;

/// The cells of each kind with the corners of their nodes, and the boundary by reference; what may be in any order sorted.
fn shape(data: &Dataset) -> (Vec<Vec<Corners>>, Vec<(i32, Corners)>) {
    let bits = |v: &u32| data.mesh.vertices[*v as usize].map(f64::to_bits);
    let stack = &data.stack;
    let cells =
        Kind::ALL.map(|kind| stack.cells_of(kind).map(|cell| cell.nodes().iter().map(bits).collect()).collect());
    let quads = stack.quads.iter().map(|(nodes, reference)| (reference, nodes.iter().map(bits).collect()));
    let triangles = data.mesh.triangles.iter().take(if stack.is_empty() { usize::MAX } else { stack.own()[1] });
    let triangles = triangles.map(|(nodes, reference)| (reference, nodes.iter().map(bits).collect()));
    let mut faces: Vec<(i32, Corners)> = quads.chain(triangles).collect();
    faces.iter_mut().for_each(|(_, nodes)| nodes.sort_unstable());
    faces.sort();
    (cells.to_vec(), faces)
}

#[test]
fn every_format_brings_cells_back() {
    for data in [all_kinds(), prisms()] {
        for &(name, text) in FILES {
            let place = Place::new();
            let (path, _) = place.write(name, &data, text);
            let found = read(&path);
            assert_eq!(found.mesh.vertices, data.mesh.vertices, "{name}");
            assert_eq!(found.names.triangles, data.names.triangles, "{name}");
            let (mut found, mut wanted) = (shape(&found), shape(&data));
            if name == "case/" {
                // Cells are known by their faces there.
                let sort =
                    |cells: &mut Vec<Vec<Corners>>| cells.iter_mut().flatten().for_each(|nodes| nodes.sort_unstable());
                sort(&mut found.0);
                sort(&mut wanted.0);
            }
            assert_eq!(found, wanted, "{name}, text {text}");
        }
    }
}

fn prisms() -> Dataset {
    let (mut mesh, mut stack) = on_prisms(2, 0.1);
    stack.join(&mut mesh).unwrap();
    Dataset { mesh, stack, ..Dataset::default() }
}

#[test]
fn a_second_file_is_the_first_to_the_last_byte() {
    for &(name, text) in FILES.iter().filter(|(name, _)| *name != "case/") {
        let (place, again) = (Place::new(), Place::new());
        let (path, _) = place.write(name, &all_kinds(), text);
        let (second, _) = again.write(name, &read(&path), text);
        assert!(std::fs::read(path).unwrap() == std::fs::read(second).unwrap(), "{name}, text {text}");
    }
}

#[test]
fn fields_at_cells_come_to_the_vertices() {
    let mut data = all_kinds();
    let values: Vec<f64> = data.mesh.vertices.iter().map(|p| 1.0 + p[0]).collect();
    data.fields.push(NamedField { name: "p".into(), kind: FieldKind::Scalar, values });
    let place = Place::new();
    let (path, _) = place.write("case/", &data, true);
    let found = &read(&path).fields[0];
    assert_eq!(found.values.len(), data.mesh.vertices.len());
    assert!(found.values.iter().all(|&x| (0.7..1.4).contains(&x)), "{:?}", found.values);
}

#[test]
fn what_cannot_hold_them_says_so_and_what_to_do() {
    let (data, place) = (all_kinds(), Place::new());
    for name in ["a.vtk", "a.xdmf", "a.inp", "a.bdf"] {
        let path = place.path(name);
        let error = formats::write_on(Team::alone(), &path, &data, Options::default()).unwrap_err().to_string();
        let (told, remedy) =
            ("the mesh has 1 pyramid, 1 prism, 1 hexahedron, for which", "`geo-adapt convert --split`");
        assert!(
            error.starts_with(&path.display().to_string()) && error.contains(told) && error.contains(remedy),
            "{error}"
        );
        assert!(!path.exists());
        place.write(name, &Dataset { stack: Stack::default(), ..data.clone() }, false);
        assert_eq!(read(&path).mesh.tets.len(), 10 + 2 + 3 + 6, "{name}");
    }
}

/// A text of libMeshb with cells of all kinds, with one row or more changed.
fn changed(from: &str, to: &str) -> (Place, String) {
    let place = Place::new();
    let (path, _) = place.write("a.mesh", &all_kinds(), false);
    let text = std::fs::read_to_string(&path).unwrap();
    assert_eq!(text.matches(from).count(), 1, "{from}");
    std::fs::write(&path, text.replace(from, to)).unwrap();
    let error = formats::read(&path).unwrap_err().to_string();
    assert!(error.starts_with(&path.display().to_string()), "{error}");
    (place, error)
}

#[test]
fn damage_to_lists_of_libmeshb_is_told_with_its_place() {
    for (from, to, told) in [
        ("\nPrisms\n1\n", "\nPrisms\n2\n", "the list ends here, before its count is reached"),
        ("\nPyramids\n1\n1 2 3 4 9 1", "\nPyramids\n1\n1 2 3 4 99 1", "Pyramids 1 of 1: index 99 is out of range"),
        ("\nPrisms\n1\n1 14 10 4 15 13 1", "\nPrisms\n1\n1 14 10 4 14 13 1", "it has vertex 14 twice"),
        ("\nQuadrilaterals\n6\n10 13 12 11", "\nQuadrilaterals\n6\n10 13 12 9", "quadrilateral 1"),
        ("\nHexahedra\n1\n10 11 12 13 1 2 3 4 1\n", "", "quadrilateral 1"),
    ] {
        let (_, error) = changed(from, to);
        assert!(error.contains(told), "{error}");
    }
}

#[test]
fn what_is_read_by_slices_does_not_lose_them() {
    let place = Place::new();
    let (path, _) = place.write("a.meshb", &all_kinds(), false);
    let error = MeshReader::open(&path).unwrap_err().to_string();
    assert!(error.contains("Quadrilaterals: there are 6") && error.contains("`geo-adapt convert --split`"), "{error}");
}
