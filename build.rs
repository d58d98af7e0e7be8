//! Builds the C++ sides: of the OpenCASCADE bridge when the feature `occt` is on, of task back-ends with `tbb` and `openmp`.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    #[cfg(feature = "occt")]
    occt::build();
    #[cfg(feature = "tbb")]
    {
        // TBB_INCLUDE and TBB_LIB name its folders when it is not the system's.
        let [include, library] = ["TBB_INCLUDE", "TBB_LIB"].map(folder);
        tasks_side("tbb").includes(include).compile("geo-adapt-tbb");
        library.iter().for_each(|library| println!("cargo:rustc-link-search=native={library}"));
        println!("cargo:rustc-link-lib=tbb");
    }
    #[cfg(feature = "openmp")]
    {
        tasks_side("openmp").flag("-fopenmp").compile("geo-adapt-openmp");
        println!("cargo:rustc-link-lib=gomp");
    }
}

#[cfg(feature = "tbb")]
fn folder(name: &str) -> Option<String> {
    println!("cargo:rerun-if-env-changed={name}");
    std::env::var(name).ok()
}

/// The C++ side of a task back-end.
#[cfg(any(feature = "tbb", feature = "openmp"))]
fn tasks_side(name: &str) -> cc::Build {
    let source = format!("src/tasks/backends/cpp/{name}.cpp");
    println!("cargo:rerun-if-changed={source}");
    let mut build = cc::Build::new();
    build.cpp(true).std("c++17").flag("-Wall").flag("-Wextra").file(source);
    build
}

#[cfg(feature = "occt")]
mod occt {
    use std::path::PathBuf;

    const SOURCES: [&str; 19] = [
        "cpp/load.cpp",
        "cpp/gaps.cpp",
        "cpp/names.cpp",
        "cpp/divide.cpp",
        "cpp/connect.cpp",
        "cpp/separate.cpp",
        "cpp/domain.cpp",
        "cpp/heal.cpp",
        "cpp/sew.cpp",
        "cpp/damage.cpp",
        "cpp/model.cpp",
        "cpp/evaluate.cpp",
        "cpp/outline.cpp",
        "cpp/splines.cpp",
        "cpp/place.cpp",
        "cpp/write.cpp",
        "cpp/save.cpp",
        "cpp/check.cpp",
        "cpp/memory.cpp",
    ];

    /// Toolkits that the bridge calls, callers first.
    const LIBRARIES: [&str; 16] = [
        "TKIGES",
        "TKSTEP",
        "TKSTEPBase",
        "TKXSBase",
        "TKBO",
        "TKPrim",
        "TKShHealing",
        "TKTopAlgo",
        "TKGeomAlgo",
        "TKBRep",
        "TKGeomBase",
        "TKG3d",
        "TKG2d",
        "TKMath",
        "TKernel",
        "TKSTEPAttr",
    ];

    /// Compiles cpp/ and links OCCT: all files as one, since what takes its time is the reading of OCCT's headers (docs/decisions/build-time.md).
    /// So two files must not use one name for different things in their anonymous namespaces. OCCT_INCLUDE and OCCT_LIB name OCCT's folders when it
    /// is not the system's.
    pub fn build() {
        for name in ["OCCT_INCLUDE", "OCCT_LIB"] {
            println!("cargo:rerun-if-env-changed={name}");
        }
        let include = include_folder();
        let all = PathBuf::from(std::env::var_os("OUT_DIR").expect("cargo names it")).join("all.cpp");
        let text: String = SOURCES.iter().map(|source| format!("#include \"geo-adapt/{source}\"\n")).collect();
        std::fs::write(&all, text).expect("the output folder can be written");
        cxx_build::bridge("src/geometry/occt/bridge.rs")
            .file(all)
            // As a system folder, so that OCCT's own headers raise no warnings.
            .flag("-isystem")
            .flag(include.to_str().expect("OCCT's include folder has a UTF-8 name"))
            .std("c++17")
            .flag("-Wall")
            .flag("-Wextra")
            .compile("geo-adapt-occt");
        for source in SOURCES.iter().chain(&[
            "cpp/occt.hpp",
            "cpp/gaps.hpp",
            "cpp/names.hpp",
            "cpp/damage.hpp",
            "cpp/splines.hpp",
            "src/geometry/occt/bridge.rs",
        ]) {
            println!("cargo:rerun-if-changed={source}");
        }
        if let Ok(folder) = std::env::var("OCCT_LIB") {
            println!("cargo:rustc-link-search=native={folder}");
        }
        for library in LIBRARIES {
            println!("cargo:rustc-link-lib={library}");
        }
    }

    /// Where OCCT's headers lie; ends the build with the remedy when they are nowhere.
    fn include_folder() -> PathBuf {
        let candidates = std::env::var("OCCT_INCLUDE")
            .into_iter()
            .chain(["/usr", "/usr/local", "/opt/opencascade"].map(|root| format!("{root}/include/opencascade")));
        for folder in candidates.map(PathBuf::from) {
            if folder.join("Standard_Version.hxx").is_file() {
                return folder;
            }
        }
        eprintln!(
            "OpenCASCADE's headers were not found. Install OCCT 7.6 (Debian: apt-get install libocct-data-exchange-dev \
             libocct-modeling-algorithms-dev libocct-ocaf-dev), or set OCCT_INCLUDE and OCCT_LIB to its folders, or build \
             with --no-default-features --features cli to leave the CAD backend out."
        );
        std::process::exit(1);
    }
}
