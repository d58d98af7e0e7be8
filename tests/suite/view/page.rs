//! `geo-adapt view`: a page that loads nothing and holds the mesh's numbers, and pictures that show what they should.
use crate::common::adapting::{complaint, cube, isotropic};
use crate::common::program;
use crate::common::viewing::{Page, Picture};
use geo_adapt::mesh::io::{FieldKind, Solution, SolutionField, write_mesh, write_solution};
use geo_adapt::mesh::{Elements, TetMesh};
use geo_adapt::metric::Field;
use std::path::PathBuf;
use std::process::Command;

/// A cube of two regions with a field x + 10 y and a metric of size 1/4, in a folder of its own.
struct Place {
    folder: tempfile::TempDir,
    mesh: TetMesh,
}

impl Place {
    fn new(n: u32) -> Self {
        let mut mesh = cube(n, |p| if p[0] < 0.5 { 3 } else { 5 });
        // Far from the origin: coordinates are kept relative to the middle.
        mesh.vertices.iter_mut().for_each(|p| p[2] += 1e4);
        let folder = tempfile::tempdir().unwrap();
        let place = Self { folder, mesh };
        write_mesh(&place.path("in.meshb"), &place.mesh).unwrap();
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = program();
        command.current_dir(self.folder.path()).args(["view", "in.meshb"]).args(arguments);
        command
    }

    fn run(&self, arguments: &[&str]) {
        let run = self.command(arguments).output().unwrap();
        assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
    }

    fn refusal(&self, arguments: &[&str]) -> String {
        let message = complaint(&self.command(arguments).output().unwrap());
        assert!(!self.path("page.html").exists() && !self.path("picture.png").exists(), "{message}");
        message
    }

    fn field(&self, name: &str, values: Vec<f64>) {
        let solution =
            Solution { vertices: values.len(), fields: vec![SolutionField { kind: FieldKind::Scalar, values }] };
        write_solution(&self.path(name), &solution).unwrap();
    }

    fn page(&self) -> Page {
        Page::read(&self.path("page.html"))
    }
}

#[test]
fn a_page_loads_nothing_and_holds_the_mesh() {
    let place = Place::new(4);
    let mesh = &place.mesh;
    place.field("heat.solb", mesh.vertices.iter().map(|p| p[0] + 10.0 * p[1]).collect());
    Field { metrics: vec![isotropic(0.25); mesh.vertices.len()] }.write(&place.path("m.solb")).unwrap();
    std::fs::write(
        place.path("in.meshb.names.json"),
        r##"{"triangles": {"2": {"name": "</script>east & west", "color": "#12ab34"}}, "tetrahedra": {"5": {"name": "core"}}}"##,
    )
    .unwrap();
    place.run(&[
        "-o",
        "page.html",
        "--field",
        "heat.solb",
        "--metric",
        "m.solb",
        "--title",
        "A <b> & c",
        "--cut",
        "x=0.3",
    ]);
    let page = place.page();
    // A name space that nobody asks for, and a gradient of the page itself.
    let own = page.text.replace("\"http://www.w3.org/2000/svg\"", "").replace("url(#gradient)", "");
    for wanting in ["http:", "https:", "src=", "href=\"", "url(", "@import", "import(", "fetch(", "XMLHttpRequest"] {
        assert!(!own.contains(wanting), "{wanting}");
    }
    assert!(page.text.contains("default-src 'none'") && page.text.contains("<title>A &lt;b&gt; &amp; c</title>"));
    assert!(!page.text.contains("{{"));
    let centre: Vec<f64> = page.head["centre"].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
    assert_eq!(centre, [0.5, 0.5, 1e4 + 0.5]);
    for (row, p) in page.reals("points").iter().zip(&mesh.vertices) {
        assert!((0..3).all(|i| (row[i] + centre[i] - p[i]).abs() < 1e-7), "{row:?} {p:?}");
    }
    let same = |name: &str, nodes: Vec<Vec<u32>>| assert_eq!(page.arrays[name], nodes, "{name}");
    same("tets", mesh.tets.nodes.iter().map(|n| n.to_vec()).collect());
    same("triangles", mesh.triangles.nodes.iter().map(|n| n.to_vec()).collect());
    same("regions", mesh.tets.refs.iter().map(|&r| vec![u32::from(r == 5)]).collect());
    same("surfaces", mesh.triangles.refs.iter().map(|&r| vec![r as u32 - 1]).collect());
    for (row, p) in page.reals("field 0").iter().zip(&mesh.vertices) {
        assert!((row[0] - p[0] - 10.0 * p[1]).abs() < 1e-5);
    }
    // An interface has tetrahedra on both sides.
    for (sides, reference) in page.arrays["sides"].iter().zip(&mesh.triangles.refs) {
        assert_eq!(sides[1] != u32::MAX, *reference == 7);
    }
    let head = &page.head;
    assert_eq!(head["fields"][0]["name"], "heat");
    assert_eq!(head["fields"][1]["name"], "size");
    assert_eq!(
        (&head["surfaces"][1]["name"], &head["surfaces"][1]["colour"]),
        (&"</script>east & west".into(), &"#12ab34".into())
    );
    assert_eq!((head["regions"][1]["name"].as_str(), head["regions"][1]["count"].as_u64()), (Some("core"), Some(192)));
    assert_eq!(head["start"]["plane"], serde_json::json!([[1.0, 0.0, 0.0], 0.3]));
    let counted: u64 = head["histogram"].as_array().unwrap().iter().map(|count| count.as_u64().unwrap()).sum();
    assert_eq!(counted as usize, mesh.tets.len());
}

#[test]
fn a_page_is_the_same_on_any_number_of_threads() {
    let place = Place::new(12);
    let written = ["1", "3"].map(|threads| {
        place.run(&["-o", "page.html", "--png", "picture.png", "--cut", "1,1,0=0.9", "--threads", threads]);
        [place.path("page.html"), place.path("picture.png")].map(|path| std::fs::read(path).unwrap())
    });
    assert!(written[0] == written[1]);
}

#[test]
fn a_picture_shows_the_surface_and_a_cut_its_inside() {
    let place = Place::new(6);
    let white = |p: [i32; 3]| p == [255; 3];
    place.run(&["--png", "picture.png", "--size", "600x450"]);
    let whole = Picture::read(&place.path("picture.png"));
    assert_eq!((whole.width, whole.pixels.len()), (600, 600 * 450));
    assert_eq!((whole.at(0, 0), whole.at(599, 449)), ([255; 3], [255; 3]));
    let covered = 600 * 450 - whole.count(white);
    assert!((30_000..120_000).contains(&covered), "{covered}");
    // Three sides are seen, each of its colour: those of the references are far apart.
    let hues: std::collections::BTreeSet<[u8; 3]> =
        whole.pixels.iter().copied().filter(|p| p.iter().max() != p.iter().min()).collect();
    assert!(hues.len() > 3);

    // From +x only the side of reference 2 is seen; behind the cut only the inside.
    let green = |p: [i32; 3]| p[1] > p[0] + 60 && p[1] > p[2] + 60;
    let names = r##"{"triangles": {"2": {"color": "#10d020"}}}"##;
    std::fs::write(place.path("in.names.json"), names).unwrap();
    let from_east = ["--png", "picture.png", "--size", "600x450", "--view", "0,0", "--color", "reference"];
    place.run(&from_east);
    let before = Picture::read(&place.path("picture.png")).count(green);
    place.run(&[&from_east[..], &["--cut", "x=0.6"]].concat());
    let after = Picture::read(&place.path("picture.png")).count(green);
    // What is left then is the swatch of the legend.
    assert!(before > 20_000 && after < 300, "{before} {after}");
    place.run(&[&from_east[..], &["--hide", "2"]].concat());
    assert!(Picture::read(&place.path("picture.png")).count(green) < 300);
}

#[test]
fn a_cut_is_coloured_by_quality_and_by_fields() {
    let mut place = Place::new(6);
    // The tetrahedra of one end are squeezed: bad ones.
    for p in &mut place.mesh.vertices {
        p[0] = if p[0] > 0.6 { 0.6 + 0.05 * (p[0] - 0.6) } else { p[0] };
    }
    write_mesh(&place.path("in.meshb"), &place.mesh).unwrap();
    place.field("heat.solb", place.mesh.vertices.iter().map(|p| p[1]).collect());
    let arguments = ["--png", "picture.png", "--size", "600x450", "--view=-90,0", "--cut", "-y=0.5", "--no-wire"];
    let middle = |by: &[&str]| {
        place.run(&[&arguments[..], by].concat());
        Picture::read(&place.path("picture.png"))
    };
    let red = |p: [i32; 3]| p[0] > p[2] + 60;
    let blue = |p: [i32; 3]| p[2] > p[0] + 25;
    let quality = middle(&["--color", "quality"]);
    let legend = |p: &Picture| {
        (p.pixels.iter().enumerate().filter(|(i, _)| i % 600 < 460)).map(|(_, p)| p.map(i32::from)).collect::<Vec<_>>()
    };
    let shown = legend(&quality);
    assert!(shown.iter().filter(|&&p| red(p)).count() > 1_000 && shown.iter().filter(|&&p| blue(p)).count() > 20_000);
    // The field is about 0.5 all over the cut: one colour but for the shade.
    let field = legend(&middle(&["--field", "heat.solb", "--range", "0,1"]));
    assert!(field.iter().filter(|p| p[1] > p[0] + 40 && p[1] > p[2]).count() > 20_000);
    // Only the bad ones: what is left is at one end.
    let bad = legend(&middle(&["--below", "0.4"]));
    assert!(bad.iter().filter(|&&p| blue(p)).count() < 500 && bad.iter().filter(|&&p| red(p)).count() > 1_000);
}

#[test]
fn a_surface_alone_is_shown_too() {
    let mut place = Place::new(3);
    place.mesh.tets = Elements::default();
    write_mesh(&place.path("in.meshb"), &place.mesh).unwrap();
    place.run(&["-o", "page.html", "--png", "picture.png", "--color", "quality"]);
    let page = place.page();
    assert_eq!(page.arrays["quality"].len(), place.mesh.triangles.len());
    // Half a square: 4√3 A/Σl² = √3/2.
    assert!(page.arrays["quality"].iter().all(|q| (f64::from(q[0]) / 65535.0 - 0.75f64.sqrt()).abs() < 1e-4));
    assert!(place.refusal_of_new(&["--png", "other.png", "--below", "0.5"]).contains("no tetrahedra"));
}

impl Place {
    fn refusal_of_new(&self, arguments: &[&str]) -> String {
        complaint(&self.command(arguments).output().unwrap())
    }
}

#[test]
fn bad_input_is_one_error() {
    let place = Place::new(2);
    place.field("short.solb", vec![1.0; 5]);
    let png = ["--png", "picture.png"];
    let refusal = |more: &[&str]| place.refusal(&[&png[..], more].concat());
    let message = refusal(&["--field", "short.solb"]);
    assert!(message.contains("short.solb") && message.contains("5 vertices") && message.contains("27"), "{message}");
    assert!(refusal(&["--field", "none.solb"]).contains("none.solb"));
    assert!(refusal(&["--metric", "short.solb"]).contains("short.solb"));
    assert!(refusal(&["--cut", "w=3"]).contains("x=0.5"));
    assert!(refusal(&["--size", "10x10"]).contains("1200x900"));
    assert!(refusal(&["--view", "10,100"]).contains("-55,25"));
    assert!(refusal(&["--range", "2,1"]).contains("smaller first"));
    assert!(refusal(&["--hide", "99"]).contains("no triangle has the reference 99"));
    assert!(refusal(&["--color", "heat"]).contains("there are reference, quality"));
    assert!(refusal(&["--color", "distance"]).contains("--cad"));
    assert!(refusal(&["--cad", "none.step"]).contains("none.step"));
    assert!(place.refusal(&[]).contains("--png"));
    assert!(place.refusal(&["-o", "page.txt"]).contains(".html"));
    assert!(place.refusal(&["-o", "no/page.html"]).contains("make it first"));
    std::fs::write(place.path("in.meshb.names.json"), "[]").unwrap();
    assert!(refusal(&[]).contains("in.meshb.names.json"));
    let missing = program().args(["view", "nowhere.meshb", "--png", "picture.png"]).output().unwrap();
    assert!(complaint(&missing).contains("nowhere.meshb"));
}
