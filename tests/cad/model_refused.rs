//! Files that are no model, or not all of one, get one clear message.

use crate::common::models::data;
use crate::model::program;
use std::path::Path;

/// Bad input: exit 2, one message that names the file and holds `part`, and nothing else.
fn refused(path: &Path, part: &str) {
    let output = program(&[], path);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{}: {message}", path.display());
    assert!(output.stdout.is_empty(), "{}", path.display());
    assert_eq!(message.lines().count(), 1, "{message}");
    assert!(message.starts_with("geo-adapt: error: ") && message.contains(path.to_str().unwrap()), "{message}");
    assert!(message.contains(part), "{part:?} is not in {message}");
}

#[test]
fn files_that_are_no_model_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, content: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, content).unwrap();
        path
    };
    for kind in ["step", "igs", "brep", "egads"] {
        refused(&file(&format!("empty.{kind}"), b""), "empty");
        refused(&file(&format!("text.{kind}"), b"A shopping list:\nmilk, bread\n"), "this is no");
        refused(&file(&format!("picture.{kind}"), b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\x01\0"), "this is no");
        refused(&folder.path().join(format!("missing.{kind}")), "No such file");
    }
    refused(&file("mesh.stl", b"solid"), ".step");
    refused(&file("model", b"solid"), ".step");
    std::fs::create_dir(folder.path().join("folder.step")).unwrap();
    refused(&folder.path().join("folder.step"), "is a folder");
    let empty = "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n\
                 FILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\nENDSEC;\nDATA;\nENDSEC;\nEND-ISO-10303-21;\n";
    refused(&file("nothing.step", empty.as_bytes()), "no shape");
}

#[test]
fn cut_and_damaged_files_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["capped-cylinder.step", "block-inches.igs", "duct.brep", "torus.brep"] {
        let whole = std::fs::read(data(name)).unwrap();
        let path = folder.path().join(name);
        for share in [0.2, 0.5, 0.8, 0.97] {
            std::fs::write(&path, &whole[..(share * whole.len() as f64) as usize]).unwrap();
            refused(&path, "again");
        }
    }
    // A reference to nothing, where OCCT's reader would follow a null pointer.
    let text = std::fs::read_to_string(data("capped-cylinder.step")).unwrap();
    let place = text.find("= LINE(").unwrap();
    let damaged = text[..place].to_string() + &text[place..].replacen(",#", ",#9", 1);
    let path = folder.path().join("damaged.step");
    std::fs::write(&path, damaged).unwrap();
    refused(&path, "damaged");
}

#[test]
fn a_model_without_faces_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("wire.brep");
    // One vertex, by hand.
    let text = "DBRep_DrawableShape\n\nCASCADE Topology V1, (c) Matra-Datavision\nLocations 0\nCurve2ds 0\nCurves 0\n\
                Polygon3D 0\nPolygonOnTriangulations 0\nSurfaces 0\nTriangulations 0\n\nTShapes 1\nVe\n1e-07\n0 0 0\n\
                0 0\n\n0101101\n*\n\n+1 0 \n";
    std::fs::write(&path, text).unwrap();
    refused(&path, "no faces");
}
