//! Every command reads and writes every format that `convert` knows, with the fields in the same file where that holds them.

use crate::common::program;
use geo_adapt::formats::{self, Dataset, NamedField};
use geo_adapt::geometry::Label;
use geo_adapt::mesh::io::{FieldKind, read_mesh, read_solution};
use geo_adapt::mesh::samples::cube;
use std::path::PathBuf;

/// Files that hold meshes with fields, and files of meshes alone.
const WITH_FIELDS: &[&str] = &["m.vtu", "m.msh", "m.msh2", "case"];
const ALONE: &[&str] = &["m.su2", "m.b8.ugrid", "m.ugrid"];

struct Place(tempfile::TempDir);

impl Place {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, data: &Dataset) {
        let name = if name == "case" { "case/" } else { name };
        formats::write(&self.path(name), data).unwrap();
    }

    fn read(&self, name: &str) -> Dataset {
        formats::read(&self.path(name)).unwrap().content
    }

    /// Runs a command well: what it printed, and its notes.
    fn good(&self, arguments: &str) -> [String; 2] {
        let done = program().args(arguments.split(' ')).current_dir(self.0.path()).output().unwrap();
        let texts = [done.stdout, done.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
        assert_eq!(done.status.code(), Some(0), "{arguments}: {texts:?}");
        texts
    }

    /// Bad input: what is said.
    fn refused(&self, arguments: &str) -> String {
        let done = program().args(arguments.split(' ')).current_dir(self.0.path()).output().unwrap();
        let said = String::from_utf8(done.stderr).unwrap();
        assert_eq!(done.status.code(), Some(2), "{arguments}: {said}");
        said
    }
}

/// A cube with a wall that has a name, a scalar, a vector and a metric.
fn data() -> Dataset {
    let mesh = cube(3);
    let field = |name: &str, kind, of: fn([f64; 3]) -> Vec<f64>| NamedField {
        name: name.into(),
        kind,
        values: mesh.vertices.iter().flat_map(|&p| of(p)).collect(),
    };
    let fields = vec![
        field("Mach", FieldKind::Scalar, |[x, y, z]| vec![(9.0 * (x - 0.4)).tanh() + y * z]),
        field("Velocity", FieldKind::Vector, |[x, y, z]| vec![x * x, y * y * y, z]),
    ];
    let mut data = Dataset { mesh, fields, ..Dataset::default() };
    data.names.triangles.insert(2, Label { name: Some("wing".into()), colour: None });
    data.names.triangles.insert(5, Label { name: Some("wing".into()), colour: None });
    data
}

fn named(data: &Dataset, name: &str) -> Vec<i32> {
    let is = |label: &Label| label.name.as_deref() == Some(name);
    data.names.triangles.iter().filter(|(_, label)| is(label)).map(|(&reference, _)| reference).collect()
}

#[test]
fn adapt_takes_the_fields_of_the_file_and_writes_what_the_ending_says() {
    for input in WITH_FIELDS {
        let place = Place::new();
        place.write(input, &data());
        place.good(&format!("adapt {input} --field Mach --complexity 60 -o out.vtu"));
        let found = place.read("out.vtu");
        assert!(found.mesh.vertices.len() > 60, "{input}: {}", found.mesh.vertices.len());
        assert_eq!(named(&found, "wing"), [2, 5], "{input}");
        assert!(!place.path("out.solb").exists() && !place.path("out.names.json").exists(), "{input}");
        // The metric is in the file, and the next run finds it there.
        let [metric] = &found.fields[..] else { panic!("{input}: {:?}", found.fields.len()) };
        assert_eq!((metric.name.as_str(), metric.kind), ("metric", FieldKind::SymmetricTensor));
        let [table, _] = place.good("inspect out.vtu --metric metric");
        assert!(table.contains("complexity"), "{table}");
        place.good("adapt out.vtu --metric metric -o again.msh");
        place.good("adapt out.vtu --metric out.vtu -o again.meshb");
        let (one, other) = (place.read("again.msh"), read_mesh(&place.path("again.meshb")).unwrap().content);
        assert_eq!(one.mesh.vertices.len(), other.vertices.len());
        assert_eq!(read_solution(&place.path("again.solb")).unwrap().content.vertices, other.vertices.len());
    }
}

#[test]
fn a_solvers_mesh_goes_through_adapt_into_every_format_with_its_names() {
    let place = Place::new();
    let mut bare = data();
    bare.fields.clear();
    for input in ALONE {
        place.write(input, &bare);
    }
    place.write("fields.csv", &data());
    place.good("adapt m.su2 --field fields.csv --component 1 --complexity 60 -o first.vtu");
    let first = place.read("first.vtu");
    for (input, output) in ALONE.iter().zip(["a.su2", "a.b8.ugrid", "a.lb8.ugrid"]) {
        let [table, _] =
            place.good(&format!("adapt {input} --field fields.csv --component 1 --complexity 60 -o {output}"));
        assert!(table.contains("a.solb") || table.contains("a.b8.solb") || table.contains("a.lb8.solb"), "{table}");
        let found = place.read(output);
        assert!(found.mesh.vertices == first.mesh.vertices && !named(&found, "wing").is_empty(), "{output}");
    }
    place.good("adapt m.su2 --analytic linear --complexity 60 --freeze wing -o new/");
    let case = place.read("new");
    assert!(!named(&case, "wing").is_empty());
    let side = |data: &Dataset| data.mesh.triangles.iter().filter(|(_, r)| named(data, "wing").contains(r)).count();
    assert_eq!(side(&case), side(&bare), "frozen by name");
}

#[test]
fn the_other_commands_do_so_too() {
    let place = Place::new();
    place.write("m.vtu", &data());
    place.write("m.msh", &Dataset { mesh: cube(4), ..data_without_fields() });
    place.good("metric multiscale m.vtu Mach --complexity 80 -o s.vtu");
    assert_eq!(place.read("s.vtu").mesh, place.read("m.vtu").mesh);
    place.good("metric multiscale m.vtu Mach --complexity 80 -o s.solb");
    for arguments in
        ["scale m.vtu s.vtu --complexity 50", "grade m.vtu s.solb", "limit s.vtu --hmax 0.2", "implied m.vtu"]
    {
        place.good(&format!("metric {arguments} -o t.vtu"));
        let found = place.read("t.vtu");
        assert_eq!((found.fields.len(), found.fields[0].name.as_str()), (1, "metric"), "{arguments}");
    }
    place.good("metric show s.vtu metric");
    place.good("metric intersect s.vtu s.solb -o both.solb");
    let values = |name: &str| read_solution(&place.path(name)).unwrap().content.fields.remove(0).values;
    assert!(values("both.solb").iter().zip(values("s.solb")).all(|(a, b)| (a - b).abs() <= 1e-9 * b.abs().max(1.0)));
    place.good("metric interpolate s.vtu metric m.msh -o there.msh");
    place.good("metric geometry m.msh -o g.msh");
    place.good("transfer m.vtu m.vtu m.msh --conservative -o there.vtu");
    let names: Vec<_> = place.read("there.vtu").fields.into_iter().map(|field| field.name).collect();
    assert_eq!(names, ["Mach", "Velocity"]);
    place.good("field pick there.vtu --take 1,norm:2-4 -o picked.vtu");
    let names: Vec<_> = place.read("picked.vtu").fields.into_iter().map(|field| field.name).collect();
    assert_eq!(names, ["Mach", "norm of Velocity"]);
    place.good("field evaluate m.msh --function sinfun3 -o e.msh");
    place.good("field error m.msh e.msh --truth e.msh sinfun3");
    let [table, _] = place.good("inspect m.msh");
    assert!(table.contains("valid"), "{table}");
    place.good("view m.vtu --color Mach --png p.png");
    let [_, notes] = place.good("classify m.msh --surface m.msh -o c.vtu");
    assert!(notes.contains("c.vtu: ") && notes.contains("places on the CAD model: left out"), "{notes}");
}

fn data_without_fields() -> Dataset {
    Dataset { fields: Vec::new(), ..data() }
}

#[test]
fn a_field_beside_a_mesh_is_known_by_its_name_too() {
    let place = Place::new();
    place.write("m.meshb", &data());
    place.good("adapt m.meshb --field Mach --complexity 60 -o out.meshb");
    let said = place.refused("adapt m.meshb --field Mach --complexity 60 -o m.mesh");
    assert!(said.contains("is an input and would be overwritten"), "{said}");
    let said = place.refused("adapt m.meshb --field Mach --complexity 60 -o other.mesh --report m.solb");
    assert!(said.contains("m.solb: is an input and would be overwritten"), "{said}");
}

#[test]
fn what_cannot_be_is_one_error() {
    let place = Place::new();
    place.write("m.vtu", &data());
    let said = place.refused("adapt m.vtu --field mach --complexity 60 -o out.vtu");
    assert!(said.contains("m.vtu has no field of this name (there are Mach, Velocity)"), "{said}");
    let said = place.refused("adapt m.vtu --field none.solb --complexity 60 -o out.vtu");
    assert!(said.contains("none.solb: No such file"), "{said}");
    let said = place.refused("adapt m.vtu --field Velocity --complexity 60 -o out.vtu");
    assert!(said.contains("--component 1 to 3"), "{said}");
    let said = place.refused("adapt m.vtu --metric m.vtu -o out.vtu");
    assert!(said.contains("m.vtu") && said.contains("fields: scalar, vector"), "{said}");
    let said = place.refused("adapt m.vtu --field Mach --complexity 60 -o m.vtu");
    assert!(said.contains("is an input and would be overwritten"), "{said}");
    let said = place.refused("metric implied m.vtu -o out.su2");
    assert!(said.contains("out.su2: holds no fields: the output must end in .sol or .solb"), "{said}");
    let said = place.refused("adapt m.vtu --field Mach --complexity 60 -o out.csv");
    assert!(said.contains("out.csv: holds fields and no mesh"), "{said}");
    assert!(!place.path("out.vtu").exists());
}
