//! Pictures and pages of fields and flows: names, the metric beside, cuts along the plane, isolines, streamlines, the body before its box.
use crate::common::adapting::{complaint, cube, isotropic};
use crate::common::program;
use crate::common::viewing::{Page, Picture};
use geo_adapt::mesh::TetMesh;
use geo_adapt::mesh::io::{FieldKind, Solution, SolutionField, write_mesh, write_solution};
use geo_adapt::metric::Field;
use std::path::PathBuf;

/// A cube of 5 by 5 by 5 cells, in a folder of its own.
struct Place {
    folder: tempfile::TempDir,
    mesh: TetMesh,
}

impl Place {
    fn new() -> Self {
        let place = Self { folder: tempfile::tempdir().unwrap(), mesh: cube(5, |_| 1) };
        write_mesh(&place.path("in.meshb"), &place.mesh).unwrap();
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// What is said on stderr.
    fn run(&self, arguments: &[&str]) -> String {
        let run =
            program().current_dir(self.folder.path()).args(["view", "in.meshb"]).args(arguments).output().unwrap();
        let said = String::from_utf8(run.stderr).unwrap();
        assert_eq!(run.status.code(), Some(0), "{said}");
        said
    }

    fn refusal(&self, arguments: &[&str]) -> String {
        complaint(
            &program().current_dir(self.folder.path()).args(["view", "in.meshb"]).args(arguments).output().unwrap(),
        )
    }

    fn picture(&self, arguments: &[&str]) -> Picture {
        self.run(&[&["--png", "picture.png", "--size", "600x450"], arguments].concat());
        Picture::read(&self.path("picture.png"))
    }

    fn page(&self, arguments: &[&str]) -> Page {
        self.run(&[&["-o", "page.html"], arguments].concat());
        Page::read(&self.path("page.html"))
    }

    fn names(&self, name: &str, text: &str) {
        std::fs::write(self.path(name), text).unwrap();
    }

    /// A scalar x and a velocity about the axis through the middle, called Mach and U.
    fn solution(&self) {
        let vertices = &self.mesh.vertices;
        let fields = vec![
            SolutionField { kind: FieldKind::Scalar, values: vertices.iter().map(|p| p[0]).collect() },
            SolutionField {
                kind: FieldKind::Vector,
                values: vertices.iter().flat_map(|p| [0.5 - p[1], p[0] - 0.5, 0.0]).collect(),
            },
        ];
        write_solution(&self.path("u.solb"), &Solution { vertices: vertices.len(), fields }).unwrap();
        self.names("u.names.json", r#"{"fields": ["Mach", "U"]}"#);
    }
}

/// Pixels of the scene, without the legend.
fn scene(picture: &Picture) -> Vec<[i32; 3]> {
    let inside = |i: &usize| i % picture.width < 460 && i / picture.width > 60;
    (0..picture.pixels.len()).filter(inside).map(|i| picture.pixels[i].map(i32::from)).collect()
}

#[test]
fn surfaces_are_hidden_by_name_and_fields_are_found_by_theirs() {
    let place = Place::new();
    place.names(
        "in.names.json",
        r#"{"triangles": {"2": {"name": "outlet"}, "4": {"name": "outlet"}, "9": {"name": "gone"}}}"#,
    );
    place.solution();
    let page = place.page(&["--hide", "outlet,1", "--field", "u.solb", "--color", "U"]);
    assert_eq!(page.head["start"]["hidden"], serde_json::json!([1, 2, 4]));
    let fields: Vec<&str> =
        page.head["fields"].as_array().unwrap().iter().map(|field| field["name"].as_str().unwrap()).collect();
    assert_eq!((fields, &page.head["start"]["colour"]), (vec!["Mach", "|U|"], &"field 1".into()));
    assert_eq!(place.page(&["--field", "u.solb", "--color", "Mach"]).head["start"]["colour"], "field 0");
    let message = place.refusal(&["-o", "none.html", "--hide", "inlet"]);
    assert!(message.contains("no triangle is called inlet; there are 1, 2 (outlet)"), "{message}");
    assert!(place.refusal(&["-o", "none.html", "--hide", "gone"]).contains("gone"));
    assert!(place.refusal(&["-o", "none.html", "--field", "u.solb", "--color", "p"]).contains("Mach, |U|"));
    // Names of other fields are told, and do no harm.
    place.names("u.names.json", r#"{"fields": ["Mach"]}"#);
    let said = place.run(&["-o", "page.html", "--field", "u.solb"]);
    assert!(said.contains("u.names.json: names 1 fields, but u.solb has 2"), "{said}");
    assert_eq!(Page::read(&place.path("page.html")).head["fields"][0]["name"], "u 1");
}

#[test]
fn the_metric_beside_the_mesh_measures_its_shapes() {
    let place = Place::new();
    Field { metrics: vec![isotropic(0.2); place.mesh.vertices.len()] }.write(&place.path("in.solb")).unwrap();
    let said = place.run(&["-o", "page.html"]);
    assert!(said.contains("in.solb") && said.contains("--metric none"), "{said}");
    let head = Page::read(&place.path("page.html")).head;
    assert!(head["quality"].as_str().unwrap().ends_with("in the metric"), "{}", head["quality"]);
    assert_eq!(head["fields"][0]["name"], "size");
    // What is first seen stays the surface by reference.
    assert_eq!(head["start"]["colour"], "reference");
    assert!(place.page(&["--metric", "none"]).head["quality"].as_str().unwrap().ends_with("in space"));
    // A solution beside the mesh is no metric, nor is one of another mesh.
    for (kind, vertices) in [(FieldKind::Scalar, place.mesh.vertices.len()), (FieldKind::SymmetricTensor, 3)] {
        let values = vec![1.0; vertices * kind.values()];
        write_solution(&place.path("in.solb"), &Solution { vertices, fields: vec![SolutionField { kind, values }] })
            .unwrap();
        assert!(place.page(&[]).head["quality"].as_str().unwrap().ends_with("in space"), "{kind:?}");
    }
    // It is an input.
    assert!(place.refusal(&["--png", "in.solb"]).contains(".png"));
}

#[test]
fn a_cut_that_meets_nothing_says_so() {
    let place = Place::new();
    let said = place.run(&["--png", "picture.png", "--cut", "x=2"]);
    assert!(said.contains("the cut meets nothing") && said.contains("between 0 and 1"), "{said}");
    let said = place.run(&["--png", "picture.png", "--cut", "x=-2"]);
    assert!(said.contains("the cut takes all away"), "{said}");
    let red = |p: [i32; 3]| p[0] > p[1] + 60 && p[0] > p[2] + 60;
    let told = place.picture(&["--cut", "x=-2", "--color", "reference"]).count(red);
    assert!(!place.run(&["--png", "picture.png", "--cut", "x=0.5"]).contains("cut"));
    assert!(told > 100, "{told}: it is in the picture too");
}

#[test]
fn a_cut_along_the_plane_shows_the_field_as_it_is_there() {
    let place = Place::new();
    // The field is constant on the plane, however the tetrahedra lie; the faces of whole tetrahedra have other values.
    let values = place.mesh.vertices.iter().map(|p| p[0] + 2.0 * p[1] + 0.5 * p[2]).collect();
    let field = Solution {
        vertices: place.mesh.vertices.len(),
        fields: vec![SolutionField { kind: FieldKind::Scalar, values }],
    };
    write_solution(&place.path("h.solb"), &field).unwrap();
    let arguments =
        ["--field", "h.solb", "--cut", "1,2,0.5=1.73", "--hide", "1,2,3,4,5,6", "--no-wire", "--isolines", "0"];
    let colours = |more: &[&str]| {
        let picture = place.picture(&[&arguments[..], more].concat());
        // Neither paper nor the frame about what is cut.
        let mut seen: Vec<[i32; 3]> = scene(&picture).into_iter().filter(|p| p.iter().any(|&x| x < 200)).collect();
        let count = seen.len();
        seen.sort_unstable();
        let most = seen.chunk_by(|a, b| a == b).map(<[_]>::len).max().unwrap_or(0);
        (most, count)
    };
    let (most, all) = colours(&[]);
    assert!(all > 10_000 && most as f64 > 0.9 * all as f64, "{most} of {all}");
    let (most, all) = colours(&["--cut-style", "tets"]);
    assert!(all > 10_000 && (most as f64) < 0.5 * all as f64, "{most} of {all}");
}

#[test]
fn isolines_are_dark_lines_on_the_cut() {
    let place = Place::new();
    place.solution();
    let arguments = ["--field", "u.solb", "--view=-90,0", "--cut", "-y=0.51", "--color", "Mach", "--no-wire"];
    let shown = |lines: &str| scene(&place.picture(&[&arguments[..], &["--isolines", lines]].concat()));
    let [none, few, many] = ["0", "4", "20"].map(shown);
    let darker = |with: &[[i32; 3]]| {
        with.iter().zip(&none).filter(|(a, b)| a.iter().sum::<i32>() < b.iter().sum::<i32>() - 20).count()
    };
    assert!(darker(&few) > 300 && darker(&many) > 2 * darker(&few), "{} {}", darker(&few), darker(&many));
    let page = place.page(&[&arguments[..], &["--isolines", "4"]].concat());
    assert_eq!((&page.head["start"]["along"], &page.head["start"]["isolines"]), (&true.into(), &4.into()));
}

#[test]
fn streamlines_follow_a_velocity() {
    let place = Place::new();
    place.solution();
    let page = place.page(&["--field", "u.solb", "--streamlines=7", "--cut", "z=0.43"]);
    let lines = page.reals("streamlines");
    assert!(lines.len() > 100, "{}", lines.len());
    // The velocity is linear: they are circles about the axis, each at its height.
    for ends in &lines {
        let radius = |p: &[f64]| p[0].hypot(p[1]);
        assert!((radius(&ends[..3]) - radius(&ends[3..])).abs() < 1e-4 && (ends[2] - ends[5]).abs() < 1e-6, "{ends:?}");
        assert!((ends[2] + 0.07).abs() < 1e-6, "they begin on the cut: {ends:?}");
    }
    let picture = |more: &[&str]| {
        let shown = [
            "--field",
            "u.solb",
            "--color",
            "Mach",
            "--view=-90,90",
            "--cut",
            "z=0.43",
            "--isolines",
            "0",
            "--no-wire",
        ];
        let picture = place.picture(&[&shown[..], more].concat());
        scene(&picture).into_iter().filter(|p| p.iter().sum::<i32>() < 200).count()
    };
    assert!(picture(&["--streamlines=7"]) > picture(&[]) + 1_000);
    let heat = Solution {
        vertices: place.mesh.vertices.len(),
        fields: vec![SolutionField { kind: FieldKind::Scalar, values: vec![1.0; place.mesh.vertices.len()] }],
    };
    write_solution(&place.path("heat.solb"), &heat).unwrap();
    let message = place.refusal(&["--png", "none.png", "--field", "heat.solb", "--streamlines"]);
    assert!(message.contains("vector of three components"), "{message}");
}

#[test]
fn the_first_picture_of_a_flow_shows_the_body() {
    let place = Place::new();
    place.names(
        "in.names.json",
        r#"{"triangles": {"1": {"name": "wall"}, "2": {"name": "farfield"}, "3": {"name": "symmetry"}}}"#,
    );
    let said = place.run(&["-o", "page.html"]);
    assert!(said.contains("the far field is hidden; --hide none shows it"), "{said}");
    assert_eq!(Page::read(&place.path("page.html")).head["start"]["hidden"], serde_json::json!([2, 3]));
    assert_eq!(place.page(&["--hide", "none"]).head["start"]["hidden"], serde_json::json!([]));
    assert_eq!(place.page(&["--hide", "wall"]).head["start"]["hidden"], serde_json::json!([1]));
    // A plane of symmetry alone is no flow.
    place.names("in.names.json", r#"{"triangles": {"3": {"name": "symmetry"}}}"#);
    assert_eq!(place.page(&[]).head["start"]["hidden"], serde_json::json!([]));
}
