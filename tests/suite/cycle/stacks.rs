//! Prisms of the first mesh go through the loop as they are.
#![cfg(unix)]
use super::place::Place;
use super::{openfoam, su2};
use geo_adapt::formats::{self, Dataset, NamedField};
use geo_adapt::geometry::Label;
use geo_adapt::mesh::io::FieldKind;
use geo_adapt::mesh::samples::on_prisms;
use geo_adapt::mesh::vector::Vec3;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;

/// A cube on a layer of prisms.
fn layer() -> Dataset {
    let (mut mesh, mut stack) = on_prisms(3, 0.1);
    stack.join(&mut mesh).unwrap();
    Dataset { mesh, stack, ..Dataset::default() }
}

/// A loop with a program.
fn place(config: &str, name: &str, program: &str) -> Place {
    let place = Place::new(config);
    place.write(name, program);
    std::fs::set_permissions(place.path(name), std::fs::Permissions::from_mode(0o755)).unwrap();
    place
}

/// The cells that are no tetrahedra by their nodes.
fn cells(data: &Dataset) -> Vec<Vec<Vec3>> {
    let nodes = |nodes: &[u32]| nodes.iter().map(|&v| data.mesh.vertices[v as usize]).collect();
    data.stack.cells.iter().map(|cell| nodes(cell.nodes())).collect()
}

/// The mesh of a file, whose cells are those of the layer; it has other tetrahedra.
fn kept(path: &Path) -> Dataset {
    let (data, before) = (formats::read(path).unwrap().content, layer());
    assert_eq!(cells(&data), cells(&before), "{}", path.display());
    assert_eq!(data.stack.quads.len(), before.stack.quads.len());
    assert_ne!(data.stack.own()[0], before.stack.own()[0]);
    data
}

#[test]
fn su2_gets_them_back_in_every_cycle() {
    let place = place(&su2::CONFIG.replace("cube.meshb", "layer.su2"), "SU2_CFD", su2::SU2);
    let mut data = layer();
    let named = [(1, "inlet"), (2, "far"), (3, "far"), (4, "far"), (5, "wall"), (6, "wall")];
    data.names.triangles =
        named.map(|(reference, name)| (reference, Label { name: Some(name.into()), colour: None })).into();
    formats::write(&place.path("layer.su2"), &data).unwrap();
    place.run(&[]);
    let last = kept(&place.path("out/cycle-03/solve/mesh.su2"));
    for name in ["result/mesh.su2", "result/mesh.meshb", "result/result.vtu"] {
        assert_eq!(kept(&place.path("out").join(name)).mesh.vertices, last.mesh.vertices);
    }
    let report = place.report();
    let cycle = &report["cycles"].as_array().unwrap()[2];
    assert_eq!(cycle["tets"], last.stack.own()[0]);
    // It restarts from what was transferred.
    assert!(cycle["functionals"]["CD"].as_f64().unwrap() < 1e-12, "{cycle}");
}

#[test]
fn openfoam_has_values_in_them() {
    let config = openfoam::CONFIG
        .replace("cube = 3", "file = \"layer.su2\"")
        .replace("PROGRAM", "./stand-in")
        .replace("mach = 2.0", "mach = 0.3\nreynolds = 50.0")
        .replace("WALLS", "walls = ['5', '6']\nfarfield = ['1', '2', '3', '4']");
    let place = place(&config, "stand-in", openfoam::STAND_IN);
    formats::write(&place.path("layer.su2"), &layer()).unwrap();
    place.run(&[]);
    for name in ["cycle-02/solve/case", "result/case"] {
        let data = formats::read(&place.path("out").join(name)).unwrap().content;
        // Cells are known by their faces there.
        let sorted = |data: &Dataset| {
            let mut cells = cells(data);
            cells.iter_mut().for_each(|nodes| nodes.sort_by(|a, b| a.partial_cmp(b).unwrap()));
            cells
        };
        assert_eq!(sorted(&data), sorted(&layer()), "{name}");
        let field = |name: &str| &data.fields.iter().find(|field| field.name == name).unwrap().values;
        assert!(field("p").iter().all(|p| (p - 1.0).abs() < 1e-9), "{name}");
        // The stream has the velocity 0.3, and nothing moves at the walls, of which one is below the prisms.
        let vertices = &data.mesh.vertices;
        let at = |z: f64| (0..vertices.len()).filter(move |&v| vertices[v][2] == z);
        assert!((0..vertices.len()).any(|v| (field("U")[3 * v] - 0.3).abs() < 0.05), "{name}");
        assert!([-0.1, 1.0].into_iter().all(|z| at(z).count() > 0 && at(z).all(|v| field("U")[3 * v] < 0.2)), "{name}");
    }
    // Friction.
    assert!(place.report()["cycles"][1]["functionals"]["CD"].as_f64().unwrap() > 0.0);
}

/// The program hands the file back: in the first cycle one that is there.
const COMMAND: &str = r#"
[mesh]
file = "layer.vtu"
[solver.command]
run = 'if [ {solution_in} = none ]; then cp {config}/layer.vtu {solution_out}; else cp {mesh} {solution_out}; fi'
mesh = "mesh.vtu"
solution_out = "solution.vtu"
[metric]
fields = ["u"]
[schedule]
complexity = 100
cycles = 1
[output]
folder = "out"
pictures = false
"#;

#[test]
fn a_program_gets_them_or_the_loop_does_not_begin() {
    let begun = |config: &str| {
        let (place, mut data) = (Place::new(config), layer());
        let values = data.mesh.vertices.iter().map(|p| p[0] * p[0] + p[2]).collect();
        data.fields.push(NamedField { name: "u".into(), kind: FieldKind::Scalar, values });
        formats::write(&place.path("layer.vtu"), &data).unwrap();
        place
    };
    let place = begun(COMMAND);
    place.run(&[]);
    kept(&place.path("out/cycle-02/solve/mesh.vtu"));
    let place = begun(&COMMAND.replace("mesh.vtu", "mesh.vtk"));
    let refused = place.refusal(&[]);
    let told =
        "[solver.command] mesh: mesh.vtk: extension: the mesh has 18 prisms, for which this format is not written";
    assert!(refused.contains(told) && refused.contains("`geo-adapt convert --split`"), "{refused}");
    assert!(!place.path("out/cycle-01").exists());
    let refused = begun(&format!("{COMMAND}[adapt]\nmemory = \"1GiB\"\n")).refusal(&[]);
    assert!(refused.contains("has 18 prisms, which are not kept where it is adapted part by part"), "{refused}");
}
