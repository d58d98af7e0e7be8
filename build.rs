//! Builds the C++ side of the OpenCASCADE bridge when the feature `occt` is on.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
}
