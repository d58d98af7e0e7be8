//! The page of `geo-adapt view` in a browser: drawn without an error, turned by the mouse, cut. Passes where there is no Chromium.
#![cfg(feature = "cli")]
mod browser;
mod common;
use browser::Browser;
use common::adapting::cube;
use common::program;
use geo_adapt::mesh::TetMesh;
use geo_adapt::mesh::io::write_mesh;
use geo_adapt::tasks::Team;
use geo_adapt::view::cut::Part;
use geo_adapt::view::{Given, Scene};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// WebGL by software.
const SOFTWARE: [&str; 3] = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"];

/// A page of a mesh.
fn page(folder: &Path, mesh: &TetMesh) -> PathBuf {
    let (input, page) = (folder.join("in.meshb"), folder.join("page.html"));
    write_mesh(&input, mesh).unwrap();
    let run = program().arg("view").arg(&input).arg("-o").arg(&page).output().unwrap();
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
