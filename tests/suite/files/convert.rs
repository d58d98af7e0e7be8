//! `geo-adapt convert`.
use geo_adapt::formats::{self, Dataset, NamedField};
use geo_adapt::geometry::Label;
use geo_adapt::mesh::io::{FieldKind, write_mesh};
use geo_adapt::mesh::samples::cube;
use geo_adapt::mesh::{OnFace, OnVertex};
use std::path::{Path, PathBuf};
use std::process::Output;

struct Place(tempfile::TempDir);

impl Place {
    /// A folder with a cube in in.su2, its marker 2 called wing.
    fn new() -> Self {
        let place = Self(tempfile::tempdir().unwrap());
        let mut data = Dataset { mesh: cube(2), ..Dataset::default() };
        data.names.triangles.insert(2, Label { name: Some("wing".into()), colour: None });
        formats::write(&place.path("in.su2"), &data).unwrap();
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn run(&self, arguments: &[&str]) -> Output {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_geo-adapt"));
        command.arg("convert").args(arguments).current_dir(self.0.path()).output().unwrap()
    }

    /// Runs it well: what it printed, and its notes.
    fn good(&self, arguments: &[&str]) -> [String; 2] {
        let done = self.run(arguments);
        let texts = [done.stdout, done.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
        assert_eq!(done.status.code(), Some(0), "{texts:?}");
        texts
    }

    /// Bad input: exit 2, one error, nothing else.
    fn refused(&self, arguments: &[&str], part: &str) {
        let done = self.run(arguments);
        let said = String::from_utf8(done.stderr).unwrap();
        assert_eq!((done.status.code(), done.stdout.len()), (Some(2), 0), "{said}");
        assert!(said.starts_with("geo-adapt: error: ") && said.lines().count() == 1 && said.contains(part), "{said}");
    }
}

fn density(vertices: usize) -> NamedField {
    NamedField {
        name: "Density".into(),
        kind: FieldKind::Scalar,
        values: (0..vertices).map(|v| v as f64 / 3.0).collect(),
    }
}

#[test]
fn a_restart_goes_with_its_mesh_and_the_names_into_another_format_and_back() {
    let place = Place::new();
    let mut data = formats::read(&place.path("in.su2")).unwrap().content;
    data.fields = vec![density(27)];
    formats::write(&place.path("restart.dat"), &data).unwrap();
    let [table, notes] = place.good(&["in.su2", "out.meshb", "--fields", "restart.dat"]);
    assert!(table.contains("tetrahedra                 48\n"), "{table}");
    assert!(
        table.contains("triangles                  48 (2: wing)\n") && table.contains("Density (scalar)"),
        "{table}"
    );
    assert!(
        notes.contains("the fields are in out.solb") && notes.contains("the names are in out.names.json"),
        "{notes}"
    );
    for name in ["1.vtu", "2.msh", "3.msh2", "4.vtu"] {
        place.good(&["out.meshb", name, if name == "4.vtu" { "--text" } else { "--fields=out.solb" }]);
        assert_eq!(formats::read(&place.path(name)).unwrap().content, data, "{name}");
    }
    let [_, notes] = place.good(&["1.vtu", "5.su2"]);
    assert!(notes.contains("5.su2: 1 fields (write them to a .csv, .dat or .solb)"), "{notes}");
    assert_eq!(std::fs::read(place.path("5.su2")).unwrap(), std::fs::read(place.path("in.su2")).unwrap());
    place.good(&["1.vtu", "again.dat"]);
    assert_eq!(std::fs::read(place.path("again.dat")).unwrap(), std::fs::read(place.path("restart.dat")).unwrap());
}

#[test]
fn names_can_be_given() {
    let place = Place::new();
    std::fs::write(place.path("n.json"), r##"{"triangles": {"3": {"name": "tail", "color": "#ff0000"}}}"##).unwrap();
    let [table, notes] = place.good(&["in.su2", "out.vtu", "--names", "n.json"]);
    assert!(table.contains("(3: tail)") && notes.contains("out.vtu: 1 colours"), "{table} {notes}");
    let names = formats::read(&place.path("out.vtu")).unwrap().content.names;
    assert_eq!(names.triangles[&3].name.as_deref(), Some("tail"));
}

#[test]
fn a_mesh_is_brought_into_another_unit_with_its_metric() {
    let place = Place::new();
    let mut data = formats::read(&place.path("in.su2")).unwrap().content;
    let values = data.mesh.vertices.iter().flat_map(|_| [4.0, 0.0, 9.0, 0.0, 0.0, 16.0]).collect();
    data.fields = vec![density(27), NamedField { name: "metric".into(), kind: FieldKind::SymmetricTensor, values }];
    formats::write(&place.path("a.vtu"), &data).unwrap();
    let [_, notes] = place.good(&["a.vtu", "b.vtu", "--scale", "10", "--translate", "-1,0,0.5"]);
    assert!(notes.contains("the field metric is in the new unit too"), "{notes}");
    assert!(notes.contains("the field Density keeps its values"), "{notes}");
    let found = formats::read(&place.path("b.vtu")).unwrap().content;
    for (found, [x, y, z]) in found.mesh.vertices.iter().zip(&data.mesh.vertices) {
        assert_eq!(*found, [10.0 * x - 1.0, 10.0 * y, 10.0 * z + 0.5]);
    }
    assert_eq!((&found.names, &found.fields[0]), (&data.names, &data.fields[0]));
    assert_eq!(found.fields[1].values[..6], [0.04, 0.0, 0.09, 0.0, 0.0, 0.16]);
    for wrong in [
        ["--scale", "0"],
        ["--scale", "-1"],
        ["--translate", "1,2"],
        ["--translate", "1,2,x"],
        ["--translate", "1,2,nan"],
    ] {
        let done = place.run(&[&["a.vtu", "c.vtu"][..], &wrong].concat());
        assert!(done.status.code() == Some(2) && !place.path("c.vtu").exists(), "{wrong:?}");
    }
}

#[test]
fn a_plain_mesh_has_no_association() {
    let place = Place::new();
    let mut mesh = cube(1);
    mesh.corners = vec![0];
    mesh.association.vertices.push(OnVertex { vertex: 0, id: 1 });
    mesh.association.faces.push(OnFace { vertex: 1, id: 2, uv: [0.0; 2], r: 0.0 });
    write_mesh(&place.path("a.mesh"), &mesh).unwrap();
    place.good(&["a.mesh", "b.mesh", "--plain"]);
    place.good(&["a.mesh", "c.mesh"]);
    let text = |name: &str| std::fs::read_to_string(place.path(name)).unwrap();
    assert!(text("c.mesh").contains("OnGeometric") && !text("b.mesh").contains("OnGeometric"));
    mesh.association = Default::default();
    assert_eq!(formats::read(&place.path("b.mesh")).unwrap().content.mesh, mesh);
    // Moved, it lies on another model.
    let [_, notes] = place.good(&["a.mesh", "d.mesh", "--translate", "0,0,1"]);
    assert!(
        notes.contains("the places on the model are left out") && !text("d.mesh").contains("OnGeometric"),
        "{notes}"
    );
}

#[test]
fn bad_input_is_one_error() {
    let place = Place::new();
    place.refused(&["none.su2", "out.vtu"], "none.su2: No such file");
    place.refused(&["in.su2", "out.xyz"], "out.xyz: extension: the format is not known; these are: .mesh");
    place.refused(&["in.su2", "in.su2"], "in.su2: is an input and would be overwritten");
    place.refused(&["in.su2", "none/out.vtu"], "there is no folder none; make it first");
    place.refused(&["in.su2", "out.csv"], "there is no field to write; give some by --fields");
    place.refused(&["in.su2", "out.vtu", "--fields", "in.su2"], "no file of fields; give .sol, .solb, .csv or .dat");
    place.refused(&["in.su2", "out.vtu", "--names", "in.su2"], "in.su2: line 1: no names of references");
    std::fs::write(place.path("f.csv"), "\"x\",\"y\",\"z\",\"p\"\n0,0,0,1\n").unwrap();
    place.refused(
        &["in.su2", "out.vtu", "--fields", "f.csv"],
        "f.csv: whole file: values at 1 points, and the mesh has 27",
    );
    place.refused(&["f.csv", "out.vtu"], "holds fields and no mesh");
    std::fs::write(place.path("hexa.su2"), "NDIME= 3\nNELEM= 1\n11 0 1 2 3 4 5 6 7\n").unwrap();
    place.refused(&["hexa.su2", "out.vtu"], "hexa.su2: line 3: an element of type 11 (voxel)");
    // A file of no bytes, of whatever format.
    for ending in "mesh meshb su2 vtu vtk xdmf xmf cgns msh msh2 inp bdf nas ugrid b8.ugrid stl obj ply".split(' ') {
        let name = format!("empty.{ending}");
        std::fs::write(place.path(&name), "").unwrap();
        place.refused(&[&name, "out.vtu"], &format!("{name}: byte 0: the file is empty; write it again"));
    }
    // What lies beside the input is an input too.
    write_mesh(&place.path("a.meshb"), &cube(1)).unwrap();
    let mut data = Dataset { mesh: cube(1), ..Dataset::default() };
    data.fields = vec![density(8)];
    formats::write(&place.path("a.solb"), &data).unwrap();
    place.refused(&["a.meshb", "a.mesh"], "a.solb: is an input and would be overwritten");
    assert!(!place.path("out.vtu").exists() && !Path::new("out.vtu").exists());
}
