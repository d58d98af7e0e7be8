//! `geo-adapt view` of a CAD model: its faces by their numbers and names, on the page and in the picture.
use crate::common::adapting::complaint;
use crate::common::models::data;
use crate::common::program;
use crate::common::viewing::{Page, Picture};
use std::path::Path;
use std::process::Output;

fn view(folder: &Path, arguments: &[&str]) -> Output {
    program().current_dir(folder).arg("view").args(arguments).output().unwrap()
}

fn shown(folder: &Path, arguments: &[&str]) {
    let run = view(folder, arguments);
    assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
}

/// A folder with the block of 1 by 2 by 3.
fn place() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(data("block-inches.igs"), folder.path().join("a.igs")).unwrap();
    folder
}

#[test]
fn the_page_of_a_model_has_its_faces_by_number_and_tells_of_each() {
    let folder = place();
    std::fs::write(
        folder.path().join("a.igs.names.json"),
        r##"{"triangles": {"3": {"name": "inlet", "colour": "#12ab34"}}}"##,
    )
    .unwrap();
    shown(folder.path(), &["a.igs", "-o", "page.html"]);
    let page = Page::read(&folder.path().join("page.html"));
    let head = &page.head;
    assert_eq!(head["counts"], "1 solid, 6 faces, 12 edges, 8 vertices");
    let numbers: Vec<i64> =
        head["surfaces"].as_array().unwrap().iter().map(|one| one["reference"].as_i64().unwrap()).collect();
    assert_eq!(numbers, [1, 2, 3, 4, 5, 6]);
    assert_eq!((&head["surfaces"][2]["name"], &head["surfaces"][2]["colour"]), (&"inlet".into(), &"#12ab34".into()));
    let about = head["surfaces"][2]["about"].as_str().unwrap();
    assert!(["plane", "area", "centre", "normal", "neighbours"].iter().all(|part| about.contains(part)), "{about}");
    assert_eq!((&head["start"]["numbers"], &head["start"]["wire"]), (&true.into(), &false.into()));
    // What is typed on the page goes into the file that the next command reads, with what is there.
    assert_eq!(head["names"]["file"], "a.igs.names.json");
    assert_eq!(head["names"]["names"]["triangles"]["3"]["name"], "inlet");
    // The triangles of each face lie in its plane, and have its area.
    let listing = program().current_dir(folder.path()).args(["model", "a.igs", "--json"]).output().unwrap();
    let listing: serde_json::Value = serde_json::from_slice(&listing.stdout).unwrap();
    let (points, centre) = (page.reals("points"), &head["centre"]);
    for (face, number) in listing["faces"].as_array().unwrap().iter().zip(0..) {
        let of: Vec<&Vec<u32>> = page.arrays["triangles"]
            .iter()
            .zip(&page.arrays["surfaces"])
            .filter(|(_, s)| s[0] == number)
            .map(|(t, _)| t)
            .collect();
        let mut area = 0.0;
        for nodes in of {
            let p =
                [0, 1, 2].map(|i| [0, 1, 2].map(|k: usize| points[nodes[i] as usize][k] + centre[k].as_f64().unwrap()));
            let [u, v] = [1, 2].map(|i| [0, 1, 2].map(|k: usize| p[i][k] - p[0][k]));
            let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
            area += 0.5 * n.iter().map(|x| x * x).sum::<f64>().sqrt();
            let normal = [0, 1, 2].map(|k: usize| face["normal"][k].as_f64().unwrap());
            assert!((0..3).map(|k| n[k] * normal[k]).sum::<f64>() > 0.0, "face {}: they look outward", number + 1);
        }
        assert!((area - face["area"].as_f64().unwrap()).abs() < 1e-5, "face {}: {area}", number + 1);
    }
}

#[test]
fn the_picture_of_a_model_has_the_numbers_on_its_faces() {
    let folder = place();
    let picture = |more: &[&str]| {
        shown(folder.path(), &[&["a.igs", "--png", "a.png", "--size", "600x450", "--view", "0,0"], more].concat());
        Picture::read(&folder.path().join("a.png"))
    };
    // From +x one face is seen; its label is on it.
    let without = picture(&["--numbers=no"]);
    let label = |picture: &Picture| {
        let differs = |i: &usize| picture.pixels[*i] != without.pixels[*i];
        let found: Vec<usize> = (0..600 * 450).filter(differs).collect();
        assert!(found.iter().all(|i| (140..360).contains(&(i % 600)) && (50..400).contains(&(i / 600))));
        found.len()
    };
    let number = label(&picture(&[]));
    // A name makes the label longer.
    let arguments = ["model", "a.igs", "--name", "outlet=near:2,1,1.5"];
    let named = program().current_dir(folder.path()).args(arguments).output().unwrap();
    assert_eq!(named.status.code(), Some(0), "{}", String::from_utf8_lossy(&named.stderr));
    let without = picture(&["--numbers=no"]);
    let with = picture(&[]);
    let longer = with.pixels.iter().zip(&without.pixels).filter(|(a, b)| a != b).count();
    assert!(number > 20 && longer > 3 * number, "{number} {longer}");
}

#[test]
fn a_model_is_shown_by_itself() {
    let folder = place();
    let refusal = |arguments: &[&str]| complaint(&view(folder.path(), arguments));
    let message = refusal(&["a.igs", "--png", "a.png", "--field", "f.solb"]);
    assert!(message.contains("a.igs") && message.contains("--field"), "{message}");
    assert!(refusal(&["none.step", "--png", "a.png"]).contains("none.step"));
    assert!(refusal(&["a.igs", "--png", "a.png", "--hide", "inlet"]).contains("no triangle is called inlet"));
    assert!(refusal(&["a.igs", "--png", "a.png", "--below", "0.5"]).contains("no tetrahedra"));
    // Neither model nor names are ever written over.
    std::fs::write(folder.path().join("a.igs.names.json"), "{}").unwrap();
    assert!(!folder.path().join("a.png").exists());
}
