//! What is written comes back, through every pair of formats.
use crate::sample::{Place, dataset, labels, read, sorted, surface};
use geo_adapt::formats::{self, Dataset};

/// Files that carry meshes, whether as text, and what of a dataset comes back.
const MESHES: &[(&str, bool)] = &[
    ("a.meshb", false),
    ("a.mesh", false),
    ("a.su2", false),
    ("a.vtu", false),
    ("a.vtu", true),
    ("a.vtk", false),
    ("a.vtk", true),
    ("a.xdmf", false),
    ("a.xdmf", true),
    ("a.xmf", false),
    ("a.xmf", true),
    ("a.cgns", false),
    ("a.inp", false),
    ("a.msh", false),
    ("a.msh", true),
    ("a.msh2", false),
    ("a.msh2", true),
    ("a.ugrid", false),
    ("a.b8.ugrid", false),
    ("a.lb8.ugrid", false),
    ("a.lb8l.ugrid", false),
];

/// What a format keeps of a dataset.
fn kept(name: &str, mut data: Dataset) -> Dataset {
    if name.ends_with("su2") || name.ends_with("ugrid") {
        data.mesh.edges = Default::default();
        data.mesh.tets.refs.fill(1);
        data.names.edges.clear();
        data.names.tetrahedra.clear();
        data.fields.clear();
    }
    if name.ends_with("inp") {
        data.fields.clear();
    }
    data.mesh = sorted(data.mesh);
    data
}

fn back(name: &str, text: bool, data: &Dataset) -> Dataset {
    let place = Place::new();
    let (path, _) = place.write(name, data, text);
    let mut read = read(&path);
    read.mesh = sorted(read.mesh);
    read
}

#[test]
fn every_format_brings_back_what_it_carries() {
    for data in [dataset(), surface()] {
        for &(name, text) in MESHES {
            assert_eq!(back(name, text, &data), kept(name, data.clone()), "{name}, text {text}");
        }
    }
}

#[test]
fn every_pair_of_formats_brings_back_what_both_carry() {
    let data = dataset();
    for &(first, first_text) in MESHES {
        let once = back(first, first_text, &data);
        for &(second, second_text) in MESHES {
            let twice = back(second, second_text, &once);
            assert_eq!(twice, kept(second, kept(first, data.clone())), "{first} {first_text}, {second} {second_text}");
        }
    }
}

#[test]
fn fields_alone_come_back() {
    let data = dataset();
    let place = Place::new();
    for name in ["f.csv", "f.dat", "f.sol", "f.solb"] {
        let (path, notices) = place.write(name, &data, false);
        assert!(notices[0].contains("fields alone"), "{notices:?}");
        let mut bare = Dataset { fields: Vec::new(), ..data.clone() };
        assert!(formats::read_fields(&path, &mut bare).unwrap().is_empty());
        assert_eq!(bare, data, "{name}");
        bare.mesh.vertices.pop();
        assert!(formats::read_fields(&path, &mut bare).is_err());
    }
    let empty = Dataset { fields: Vec::new(), ..data.clone() };
    for name in ["g.csv", "g.dat", "g.sol"] {
        assert!(formats::write(&place.path(name), &empty).is_err() && !place.path(name).exists());
    }
    let mut long = data;
    long.fields[0].name = "a".repeat(40);
    assert!(formats::write(&place.path("g.dat"), &long).unwrap_err().to_string().contains("the name has 40 bytes"));
}

#[test]
fn what_could_not_be_read_again_is_not_written() {
    let place = Place::new();
    for name in ["a.su2", "a.vtu", "a.vtk", "a.xdmf", "a.cgns", "a.inp", "a.bdf", "a.csv", "a.meshb"] {
        let refused = |change: fn(&mut Dataset)| {
            let mut data = dataset();
            change(&mut data);
            let message = formats::write(&place.path(name), &data).unwrap_err().to_string();
            assert!(message.contains(name) && !place.path(name).exists(), "{message}");
        };
        refused(|data| data.mesh.vertices[3][1] = f64::NAN);
        refused(|data| data.mesh.tets.nodes[7][2] = 1000);
        refused(|data| data.fields[1].values[4] = f64::INFINITY);
        refused(|data| data.fields[1].values.truncate(5));
        refused(|data| *data = Dataset::default());
    }
    let message = formats::write(&place.path("a.xyz"), &dataset()).unwrap_err().to_string();
    assert!(message.contains("a.xyz: extension: the format is not known; these are: .mesh"), "{message}");
}

#[test]
fn a_mesh_numbered_the_other_way_is_turned() {
    let place = Place::new();
    let data = dataset();
    let mut turned = data.clone();
    turned.mesh.tets.nodes.iter_mut().for_each(|nodes| nodes.swap(0, 1));
    for name in [
        "a.vtu",
        "a.vtk",
        "a.xdmf",
        "a.xmf",
        "a.cgns",
        "a.inp",
        "a.bdf",
        "a.su2",
        "a.meshb",
        "a.msh",
        "a.msh2",
        "a.b8.ugrid",
    ] {
        let (path, _) = place.write(name, &turned, false);
        let found = formats::read(&path).unwrap();
        assert_eq!(found.content.mesh.tets.nodes, data.mesh.tets.nodes, "{name}");
        assert!(found.notices.iter().any(|notice| notice.contains("all were turned")), "{:?}", found.notices);
    }
}

#[test]
fn both_kinds_of_xdmf_of_one_name_keep_their_arrays_apart() {
    let place = Place::new();
    let data = dataset();
    let mut moved = data.clone();
    moved.mesh.vertices.iter_mut().for_each(|vertex| vertex[0] += 1.0);
    let (first, _) = place.write("a.xdmf", &data, false);
    let (second, _) = place.write("a.xmf", &moved, false);
    assert_eq!(formats::read(&first).unwrap().content.mesh.vertices, data.mesh.vertices);
    assert_eq!(formats::read(&second).unwrap().content.mesh.vertices, moved.mesh.vertices);
}

#[test]
fn a_file_without_a_known_extension_is_known_by_its_content() {
    let place = Place::new();
    let data = Dataset { fields: Vec::new(), names: Default::default(), ..dataset() };
    for name in ["a.meshb", "a.mesh", "a.su2", "a.vtu", "a.vtk", "a.xdmf", "a.msh"] {
        let (path, _) = place.write(name, &data, false);
        let other = place.path("out.1");
        std::fs::rename(path, &other).unwrap();
        assert_eq!(read(&other).mesh.vertices, data.mesh.vertices, "{name}");
    }
    assert!(formats::read(&place.text("out.2", "hello")).is_err());
}

/// Its coordinates have 16 characters.
#[test]
fn nastran_brings_back_all_but_the_last_digits() {
    for data in [dataset(), surface()] {
        let mut found = back("a.bdf", false, &data);
        let mut wanted = data;
        wanted.fields.clear();
        wanted.mesh = sorted(wanted.mesh);
        for (found, wanted) in found.mesh.vertices.iter_mut().zip(&wanted.mesh.vertices) {
            assert!((0..3).all(|k| (found[k] - wanted[k]).abs() <= 1e-11 * wanted[k].abs()), "{found:?} {wanted:?}");
            *found = *wanted;
        }
        assert_eq!(found, wanted);
    }
}

/// The same name on several references is one name, and they stay what they are where the format can tell them apart.
#[test]
fn a_name_of_several_references_stays_one_name() {
    let mut data = Dataset { fields: Vec::new(), ..dataset() };
    data.names.triangles = labels(&[(3, "farfield"), (7, "farfield"), (21, "farfield")]);
    for name in
        ["a.vtu", "a.vtk", "a.xdmf", "a.xmf", "a.cgns", "a.msh", "a.msh2", "a.inp", "a.bdf", "a.b8.ugrid", "a.meshb"]
    {
        assert_eq!(back(name, false, &data).names.triangles, data.names.triangles, "{name}");
    }
    // A marker of SU2 has one reference.
    assert_eq!(back("a.su2", false, &data).names.triangles, labels(&[(3, "farfield")]));
    let text = |name: &str| {
        let place = Place::new();
        let (path, _) = place.write(name, &data, true);
        String::from_utf8(std::fs::read(path).unwrap()).unwrap()
    };
    for name in ["a.inp", "a.su2", "a.msh"] {
        assert!(text(name).contains("farfield") && !text(name).contains("farfield_"), "{name}");
    }
}

/// The surface, with normals outward: its volume is that of the mesh.
#[test]
fn a_surface_is_written_with_a_solid_or_group_for_each_reference() {
    let data = dataset();
    let place = Place::new();
    for (name, text) in [("a.stl", false), ("a.obj", false), ("a.ply", false), ("b.ply", true)] {
        let (path, notices) = place.write(name, &data, text);
        assert!(notices.iter().any(|notice| notice.contains("48 tetrahedra")), "{notices:?}");
        let found = read(&path).mesh;
        assert_eq!((found.vertices.len(), found.triangles.len()), (26, 48), "{name}");
        let volume: f64 = found
            .triangles
            .nodes
            .iter()
            .map(|nodes| {
                let [a, b, c] = nodes.map(|v| found.vertices[v as usize]);
                (0..3).map(|k| a[k] * (b[(k + 1) % 3] * c[(k + 2) % 3] - b[(k + 2) % 3] * c[(k + 1) % 3])).sum::<f64>()
                    / 6.0
            })
            .sum();
        assert!((volume - 1.0 / 27.0).abs() < 1e-6, "{name}: {volume}");
        let bytes = std::fs::read(&path).unwrap();
        let words = String::from_utf8_lossy(&bytes);
        for word in ["wing", "far-field", "symmetry"] {
            assert!(words.contains(word), "{name}");
        }
    }
}

/// What the solids of STL, the groups of OBJ and the comments of PLY say comes back; STL has no place for numbers.
#[test]
fn names_of_surfaces_come_back() {
    let mut data = surface();
    data.fields.clear();
    data.names.triangles = labels(&[(3, "wing"), (7, "far-field"), (21, "far-field"), (11, "42")]);
    let wanted = sorted(data.mesh.clone());
    for (name, text) in [("a.obj", false), ("a.ply", false), ("a.ply", true)] {
        let found = back(name, text, &data);
        assert_eq!(found.mesh.triangles.refs, wanted.triangles.refs, "{name}");
        assert_eq!(found.names.triangles, data.names.triangles, "{name}");
    }
    let found = back("a.stl", false, &data);
    let mut of_name = std::collections::BTreeMap::new();
    for &reference in &found.mesh.triangles.refs {
        let name = found.names.triangles.get(&reference).and_then(|label| label.name.clone());
        *of_name.entry((name.clone(), if name.is_none() { reference } else { 0 })).or_insert(0) += 1;
    }
    let count = |references: &[i32]| wanted.triangles.refs.iter().filter(|at| references.contains(at)).count();
    let called = |name: &str| (Some(name.to_owned()), 0);
    let expected = [
        ((None, 6), count(&[6])),
        ((None, 8), count(&[8])),
        (called("42"), count(&[11])),
        (called("far-field"), count(&[7, 21])),
        (called("wing"), count(&[3])),
    ];
    assert_eq!(of_name, expected.into());
}
