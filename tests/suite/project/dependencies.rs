//! Who takes the library alone gets none of the program's packages.
use std::process::Command;

/// The packages that a build with these options has.
fn packages(options: &[&str]) -> Vec<String> {
    let output = Command::new(env!("CARGO"))
        .args(["tree", "--locked", "--offline", "--edges", "normal", "--prefix", "none", "--format", "{p}"])
        .args(options)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo starts");
    assert!(output.status.success(), "cargo tree: {}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).expect("names of packages");
    text.lines().filter_map(|line| line.split(' ').next()).map(str::to_owned).collect()
}

/// What only the command line, the loop, the pages and the files of other programs need.
const OF_THE_PROGRAM: [&str; 10] =
    ["clap", "indicatif", "ctrlc", "toml", "png", "regex-lite", "base64", "flate2", "hdf5-pure", "quick-xml"];

#[test]
fn the_library_alone_has_no_package_of_the_program() {
    let alone = packages(&["--no-default-features"]);
    let with_cad = packages(&["--no-default-features", "--features", "occt"]);
    let program = packages(&[]);
    for package in OF_THE_PROGRAM {
        let is_in = |packages: &[String]| packages.iter().any(|name| name == package);
        assert!(!is_in(&alone), "{package} is in the library without features");
        assert!(!is_in(&with_cad), "{package} is in the library with occt");
        assert!(is_in(&program), "{package} is not in the program: is this list still right?");
    }
    assert!(alone.iter().any(|name| name == "nalgebra"), "{alone:?}");
}
