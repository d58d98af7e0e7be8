//! A build without OpenCASCADE says so.
#![cfg(not(feature = "occt"))]
use std::process::Command;

#[test]
fn model_names_the_missing_backend() {
    let output = Command::new(env!("CARGO_BIN_EXE_geo-adapt")).args(["model", "cube.step"]).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(message.contains("cube.step") && message.contains("no CAD backend"), "{message}");
}
