//! The page of `geo-adapt view` in a browser: drawn without an error, turned by the mouse, cut. Passes where there is no Chromium.
use crate::browser::{Browser, SOFTWARE};
use crate::common::adapting::cube;
use crate::common::program;
use geo_adapt::mesh::TetMesh;
use geo_adapt::mesh::io::write_mesh;
use geo_adapt::tasks::Team;
use geo_adapt::view::cut::{Part, Style};
use geo_adapt::view::{Given, Scene};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// A page of a mesh.
fn page(folder: &Path, mesh: &TetMesh) -> PathBuf {
    page_with(folder, mesh, &[])
}

fn page_with(folder: &Path, mesh: &TetMesh, arguments: &[&str]) -> PathBuf {
    let (input, page) = (folder.join("in.meshb"), folder.join("page.html"));
    write_mesh(&input, mesh).unwrap();
    let run = program().arg("view").arg(&input).arg("-o").arg(&page).args(arguments).output().unwrap();
    assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
    page
}

/// Colours in the middle of a screenshot.
fn colours(screenshot: &str) -> BTreeSet<[u8; 3]> {
    let letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut bytes = Vec::new();
    let (mut word, mut held) = (0u32, 0);
    for value in screenshot.chars().filter_map(|letter| letters.find(letter)) {
        word = word << 6 | value as u32;
        held += 6;
        if held >= 8 {
            held -= 8;
            bytes.push((word >> held) as u8);
        }
    }
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    let samples = info.color_type.samples();
    let middle = |x: usize, y: usize| (x * 2 / info.width as usize, (300..500).contains(&y)) == (0, true);
    let places = (0..info.height as usize).flat_map(|y| (200..info.width as usize).map(move |x| (x, y)));
    let at = |(x, y): (usize, usize)| {
        let start = (y * info.width as usize + x) * samples;
        [pixels[start], pixels[start + 1], pixels[start + 2]]
    };
    places.filter(|&(x, y)| middle(x, y)).map(at).collect()
}

#[test]
fn a_page_is_drawn_turned_and_cut() {
    let Some(browser) = Browser::start(&SOFTWARE) else { return };
    let folder = tempfile::tempdir().unwrap();
    // No vertex lies in the middle, where the cut will be.
    let mesh = cube(5, |p| if p[0] < 0.5 { 3 } else { 5 });
    browser.open(&page(folder.path(), &mesh));
    browser.wait("document.body.dataset.state !== 'loading'");
    let state = |key: &str| {
        let text = browser.script(&format!("return document.body.dataset.{key}"));
        text.as_str().unwrap_or_else(|| panic!("{key}: {text}")).to_owned()
    };
    assert_eq!((state("state"), state("triangles")), ("drawn".into(), mesh.triangles.len().to_string()));
    assert!(colours(&browser.screenshot()).len() > 20, "the sides, and lines on them");
    // The numbers are those of the mesh.
    let sum = |array: &str| browser.script(&format!("return geoAdapt.model.{array}.reduce((a, b) => a + b, 0)"));
    assert_eq!(sum("tets").as_u64(), Some(mesh.tets.nodes.iter().flatten().map(|&v| u64::from(v)).sum()));
    assert!(sum("points").as_f64().unwrap().abs() < 1e-3);
    let furthest = browser.script("return Math.max(...geoAdapt.model.points)");
    assert!((furthest.as_f64().unwrap() - 0.5).abs() < 1e-7);

    // A drag of 100 pixels turns by 40 degrees.
    assert_eq!((state("azimuth"), state("elevation")), ("-55.00".into(), "25.00".into()));
    browser.drag([350, 400], [100, 50]);
    browser.wait("document.body.dataset.azimuth === '-95.00' && document.body.dataset.elevation === '45.00'");
    // Left, as WebDriver has it.
    browser.key('\u{e012}');
    browser.wait("document.body.dataset.azimuth === '-90.00'");
    let scale = || browser.script("return geoAdapt.camera.scale").as_f64().unwrap();
    let before = scale();
    browser.wheel([400, 400], -200);
    browser.wait(&format!("geoAdapt.camera.scale > {}", 1.2 * before));

    // The cut in the middle is that of the pictures.
    browser.script("document.getElementById('cutting').click()");
    browser.wait("document.body.dataset.faces !== '0'");
    let scene = Scene::new(Team::alone(), &mesh, Given::default());
    let sides = ["x=0.5", "-x=0.5"].map(|plane| {
        let part = Part { plane: Some(plane.parse().unwrap()), ..Part::default() };
        let shown = part.of(Team::alone(), &scene);
        (shown.triangles.len().to_string(), shown.faces.len().to_string())
    });
    assert!(sides.contains(&(state("triangles"), state("faces"))), "{sides:?}");
    // What is clicked is told.
    browser.drag([455, 400], [0, 0]);
    browser.wait("/^(triangle|tetrahedron) .*mean ratio 0\\.\\d+/.test(document.getElementById('picked').textContent)");
    assert_eq!(browser.errors(), Vec::<serde_json::Value>::new());
}

#[test]
fn a_cut_along_the_plane_is_that_of_the_pictures() {
    let Some(browser) = Browser::start(&SOFTWARE) else { return };
    let folder = tempfile::tempdir().unwrap();
    let mesh = cube(5, |_| 1);
    browser.open(&page_with(folder.path(), &mesh, &["--cut", "1,2,0.5=1.73", "--cut-style", "plane", "--hide", "2"]));
    browser.wait("document.body.dataset.state !== 'loading'");
    let scene = Scene::new(Team::alone(), &mesh, Given::default());
    let plane = Some("1,2,0.5=1.73".parse().unwrap());
    let shown = Part { plane, style: Style::Plane, hidden: [2].into(), below: None }.of(Team::alone(), &scene);
    let count = |key: &str| browser.script(&format!("return document.body.dataset.{key}")).as_str().unwrap().to_owned();
    assert_eq!(
        [count("pieces"), count("triangles"), count("faces")],
        [shown.pieces.len().to_string(), shown.triangles.len().to_string(), "0".into()]
    );
    // The same points.
    let sum =
        browser.script("return geoAdapt.model.pieceSoup().positions.reduce((a, b) => a + b, 0)").as_f64().unwrap();
    let points = shown.pieces.iter().flat_map(|piece| piece.corners).map(|corner| corner.point(&mesh.vertices));
    let expected: f64 = points.map(|p| p.iter().map(|x| x - 0.5).sum::<f64>()).sum();
    assert!((sum - expected).abs() < 1e-3, "{sum} {expected}");
    assert_eq!(browser.errors(), Vec::<serde_json::Value>::new());
}

#[test]
fn names_are_typed_and_saved_and_a_click_tells_the_surface() {
    let Some(browser) = Browser::start(&SOFTWARE) else { return };
    let folder = tempfile::tempdir().unwrap();
    let names = r##"{"triangles": {"2": {"colour": "#12ab34"}}, "tetrahedra": {"1": {"name": "core"}}}"##;
    std::fs::write(folder.path().join("in.names.json"), names).unwrap();
    browser.open(&page_with(folder.path(), &cube(3, |_| 1), &["--numbers", "--view", "0,0"]));
    browser.wait("document.body.dataset.state !== 'loading'");
    // From +x surface 2 is seen, and its number on it.
    let labels =
        || browser.script("return [...document.querySelectorAll('#labels text')].map((one) => one.textContent).join()");
    browser.wait("document.body.dataset.labels === '1'");
    assert_eq!(labels(), "2");
    browser.drag([455, 400], [0, 0]);
    browser.wait("/reference 2/.test(document.getElementById('picked').textContent)");
    assert_eq!(browser.script("return document.querySelector('#surfaces li.picked .number').textContent"), "2");
    browser.script(
        "window.saved = []; HTMLAnchorElement.prototype.click = function () { window.saved.push(this.download); };
         URL.createObjectURL = (blob) => { blob.text().then((text) => window.saved.push(text)); return '#'; };
         const input = document.querySelectorAll('#surfaces input.name')[1];
         input.value = ' inlet '; input.dispatchEvent(new Event('change'));
         document.getElementById('save-names').click();",
    );
    browser.wait("window.saved.length === 2");
    assert_eq!(labels(), "2 inlet");
    let [file, text] = [0, 1].map(|i| browser.script(&format!("return window.saved[{i}]")));
    assert_eq!(file, "in.names.json");
    let saved: serde_json::Value = serde_json::from_str(text.as_str().unwrap()).unwrap();
    // What was there is kept, and the program reads it.
    assert_eq!(saved["triangles"]["2"], serde_json::json!({"name": "inlet", "colour": "#12ab34"}));
    assert_eq!(saved["tetrahedra"]["1"]["name"], "core");
    let path = folder.path().join("in.meshb");
    std::fs::write(folder.path().join("in.names.json"), text.as_str().unwrap()).unwrap();
    let read = geo_adapt::geometry::names::read(&path).unwrap();
    assert_eq!(read.triangles[&2].name.as_deref(), Some("inlet"));
    assert_eq!(browser.errors(), Vec::<serde_json::Value>::new());
}

/// A page around ours, as a service has one: it keeps what it hears, and sends what the test says.
const AROUND: &str = r#"<!doctype html><title>around</title><iframe src="page.html" sandbox="allow-scripts" style="width: 900px; height: 700px"></iframe>
<script>
window.heard = [];
const frame = document.querySelector("iframe");
window.addEventListener("message", (event) => { if (event.source === frame.contentWindow) window.heard.push(event.data.geoAdapt); });
window.send = (message) => frame.contentWindow.postMessage({ geoAdapt: message }, "*");
window.last = (kind) => window.heard.findLast((one) => one.kind === kind);
</script>"#;

#[test]
fn a_page_in_a_frame_tells_what_is_clicked_and_named_and_turned() {
    let Some(browser) = Browser::start(&SOFTWARE) else { return };
    let folder = tempfile::tempdir().unwrap();
    page(folder.path(), &cube(5, |_| 1));
    let around = folder.path().join("around.html");
    std::fs::write(&around, AROUND).unwrap();
    browser.open(&around);
    browser.wait("window.last('ready')");
    assert_eq!(browser.script("return window.last('look') === undefined"), true);
    browser.drag([310, 400], [0, 0]);
    browser.wait("Number.isInteger(window.last('picked')?.reference)");
    browser.script("window.send({ kind: 'name', reference: window.last('picked').reference, name: ' wall ' })");
    browser.wait("window.last('names')");
    let named = browser.script(
        "const told = window.last('names');
         return [told.name, told.reference === window.last('picked').reference, told.content.triangles[told.reference].name]",
    );
    assert_eq!(named, serde_json::json!(["wall", true, "wall"]));
    browser.drag([310, 400], [100, 50]);
    browser.wait("window.last('look')?.azimuth.toFixed(2) === '-95.00'");
    // What it is asked for it does, and does not tell back; what makes no sense it leaves.
    let count = browser.script("return window.heard.length");
    browser.script(
        "const look = window.last('look');
         window.send({ ...look, kind: 'look', azimuth: 10, cut: { ...look.cut, on: true, axis: 'y', offset: 0.25 } });
         for (const bad of [{ kind: 'look' }, { kind: 'look', ...look, azimuth: 'x' }, { kind: 'name', reference: 99, name: 'x' }, { kind: 'constructor' }, null]) window.send(bad);",
    );
    browser.enter(Some("iframe"));
    browser.wait("document.body.dataset.azimuth === '10.00' && document.body.dataset.faces !== '0'");
    assert_eq!(browser.script("return document.querySelector('[name=axis]:checked').value"), "y");
    browser.enter(None);
    assert_eq!(browser.script("return window.heard.length"), count);
    assert_eq!(browser.errors(), Vec::<serde_json::Value>::new());
}

#[test]
fn without_decompression_streams_the_page_expands_its_data_itself() {
    let Some(browser) = Browser::start(&SOFTWARE) else { return };
    let folder = tempfile::tempdir().unwrap();
    let mesh = cube(9, |_| 1);
    let page = page(folder.path(), &mesh);
    let text = std::fs::read_to_string(&page).unwrap();
    let old = text.replacen("\"use strict\";", "\"use strict\"; delete window.DecompressionStream;", 1);
    assert_ne!(text, old);
    std::fs::write(&page, old).unwrap();
    browser.open(&page);
    browser.wait("document.body.dataset.state !== 'loading'");
    assert_eq!(browser.script("return typeof DecompressionStream"), "undefined");
    let sum = browser.script("return geoAdapt.model.tets.reduce((a, b) => a + b, 0)");
    assert_eq!(sum.as_u64(), Some(mesh.tets.nodes.iter().flatten().map(|&v| u64::from(v)).sum()));
    assert_eq!(browser.errors(), Vec::<serde_json::Value>::new());
}

#[test]
fn without_webgl_the_page_says_so() {
    let Some(browser) = Browser::start(&["--disable-3d-apis"]) else { return };
    let folder = tempfile::tempdir().unwrap();
    browser.open(&page(folder.path(), &cube(2, |_| 1)));
    browser.wait("document.body.dataset.state === 'error'");
    let message = browser.script("return document.getElementById('message').textContent");
    assert!(message.as_str().unwrap().contains("WebGL") && message.as_str().unwrap().contains("--png"), "{message}");
    // The figures are there all the same.
    assert!(browser.script("return document.querySelectorAll('#figures tr').length").as_u64() > Some(4));
}
