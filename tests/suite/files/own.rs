//! No command overwrites what it reads, nor writes two results to one file: by whatever path, it is refused before the work, with code 2.
#![cfg(unix)]

use crate::common::program;
use std::collections::BTreeMap;
use std::fs;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::Output;

/// A command: `OUT` stands for the output that is tried, `$` for the folder.
struct Case {
    arguments: &'static str,
    /// What the output must end in.
    ending: &'static str,
    inputs: &'static [&'static str],
}

const fn case(arguments: &'static str, ending: &'static str, inputs: &'static [&'static str]) -> Case {
    Case { arguments, ending, inputs }
}

/// Every command that writes, with each of its outputs.
const COMMANDS: &[Case] = &[
    case(
        "adapt a.meshb --metric a.solb --cad a.brep -o OUT",
        "meshb",
        &["a.meshb", "a.solb", "a.brep", "a.names.json"],
    ),
    case("adapt a.meshb --field f.solb --complexity 9 -o OUT", "mesh", &["a.meshb", "f.solb"]),
    case("adapt a.meshb --metric a.solb -o new.meshb --report OUT", "json", &["a.meshb", "a.solb", "a.names.json"]),
    case("adapt a.vtu --field Mach --complexity 9 -o OUT", "vtu", &["a.vtu"]),
    case("adapt a.meshb --field Mach --complexity 9 -o OUT", "msh", &["a.meshb", "a.solb", "a.names.json"]),
    case("metric multiscale a.b8.ugrid a.vtu --complexity 9 -o OUT", "vtu", &["a.b8.ugrid", "a.mapbc", "a.vtu"]),
    case("bootstrap a.brep -o OUT", "meshb", &["a.brep", "a.names.json"]),
    case("bootstrap a.brep -o new.meshb --report OUT", "json", &["a.brep", "a.names.json"]),
    case("classify a.meshb --cad a.brep -o OUT", "meshb", &["a.meshb", "a.brep", "a.names.json"]),
    case("convert a.meshb OUT", "meshb", &["a.meshb", "a.solb", "a.names.json"]),
    case("convert b.mesh OUT", "sol", &["b.mesh", "b.sol"]),
    case("convert a.b8.ugrid OUT", "vtu", &["a.b8.ugrid", "a.mapbc"]),
    case("convert a.meshb --fields f.solb --names n.json OUT", "su2", &["a.meshb", "f.solb", "n.json"]),
    case("convert case OUT", "vtu", &["case/constant/polyMesh/points", "case/0/p"]),
    case("field evaluate a.meshb --function sinfun3 -o OUT", "solb", &["a.meshb"]),
    case("field evaluate a.meshb --function sinfun3 -o new.solb --report OUT", "json", &["a.meshb"]),
    case("field pick f.solb --take 1 -o OUT", "solb", &["f.solb"]),
    case(
        "field error a.meshb f.solb --truth b.mesh b.sol --report OUT",
        "json",
        &["a.meshb", "f.solb", "b.mesh", "b.sol"],
    ),
    case("image-mesh i.nhdr -o OUT", "meshb", &["i.nhdr", "i.raw"]),
    case("image-mesh i.nhdr -o new.mesh --report OUT", "json", &["i.nhdr", "i.raw"]),
    case("metric from-image i.nhdr --mesh a.meshb --complexity 9 -o OUT", "sol", &["i.nhdr", "i.raw", "a.meshb"]),
    case("metric from-points a.meshb n.csv -o OUT", "solb", &["a.meshb", "n.csv"]),
    case("metric geometry a.meshb --cad a.brep -o OUT", "solb", &["a.meshb", "a.brep", "a.names.json"]),
    case("metric geometry a.meshb -o new.solb --report OUT", "json", &["a.meshb"]),
    case("metric grade a.meshb a.solb -o OUT", "solb", &["a.meshb", "a.solb"]),
    case("metric implied a.meshb -o OUT", "solb", &["a.meshb"]),
    case(
        "inspect a.meshb --metric a.solb --cad a.brep --report OUT",
        "json",
        &["a.meshb", "a.solb", "a.brep", "a.names.json"],
    ),
    case("metric isotropic a.meshb a.solb -o OUT", "solb", &["a.meshb", "a.solb"]),
    case("metric interpolate a.meshb a.solb b.mesh -o OUT", "solb", &["a.meshb", "a.solb", "b.mesh"]),
    case("metric intersect a.meshb a.solb b.sol -o OUT", "solb", &["a.meshb", "a.solb", "b.sol"]),
    case("metric limit a.solb --hmax 1 -o OUT", "solb", &["a.solb"]),
    case("metric multiscale a.meshb f.solb b.sol --complexity 9 -o OUT", "sol", &["a.meshb", "f.solb", "b.sol"]),
    case("metric multiscale a.meshb f.solb --complexity 9 --memory 1GB -o OUT", "solb", &["a.meshb", "f.solb"]),
    case("metric multiscale a.meshb f.solb --complexity 9 -o new.sol --report OUT", "json", &["a.meshb", "f.solb"]),
    case("metric scale a.meshb a.solb --complexity 9 -o OUT", "solb", &["a.meshb", "a.solb"]),
    case("metric show a.meshb a.solb --report OUT", "json", &["a.meshb", "a.solb"]),
    case("transfer a.meshb f.solb b.mesh -o OUT", "solb", &["a.meshb", "f.solb", "b.mesh"]),
    case("transfer a.meshb f.solb b.mesh -o new.solb --report OUT", "json", &["a.meshb", "f.solb", "b.mesh"]),
    case("model a.brep --scale 0.001 -o OUT", "brep", &["a.brep", "a.names.json"]),
    case("tune a.meshb --metric a.solb --report OUT", "json", &["a.meshb", "a.solb"]),
    case("view a.meshb --metric a.solb -o OUT", "html", &["a.meshb", "a.solb", "a.names.json"]),
    case("view a.meshb --png OUT", "png", &["a.meshb", "a.solb", "a.names.json"]),
    case("view a.meshb --field f.solb --cad a.brep --png OUT", "png", &["a.meshb", "f.solb", "a.brep"]),
];

/// The files, whose content no command gets to see.
const FILES: [&str; 17] = [
    "a.vtu",
    "a.meshb",
    "a.solb",
    "a.names.json",
    "a.brep",
    "f.solb",
    "b.mesh",
    "b.sol",
    "a.b8.ugrid",
    "a.mapbc",
    "n.json",
    "n.csv",
    "i.raw",
    "case/constant/polyMesh/points",
    "case/constant/polyMesh/faces",
    "case/0/p",
    "file",
];

struct Place(tempfile::TempDir);

impl Place {
    fn new() -> Self {
        let place = Self(tempfile::tempdir().unwrap());
        for name in FILES {
            let path = place.path(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, format!("the file {name}")).unwrap();
        }
        let header = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: raw\ndata file: i.raw\n";
        fs::write(place.path("i.nhdr"), header).unwrap();
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Every file with its bytes.
    fn files(&self) -> BTreeMap<PathBuf, Vec<u8>> {
        fn collect(folder: &Path, files: &mut BTreeMap<PathBuf, Vec<u8>>) {
            for entry in fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                match path.is_dir() {
                    true => collect(&path, files),
                    false => drop(files.insert(path.clone(), fs::read(&path).unwrap_or_default())),
                }
            }
        }
        let mut files = BTreeMap::new();
        collect(self.0.path(), &mut files);
        files
    }

    fn run(&self, arguments: &str, out: &Path) -> Output {
        let words = arguments.split(' ').map(|word| if word == "OUT" { out.as_os_str() } else { word.as_ref() });
        program().args(words).current_dir(self.0.path()).output().unwrap()
    }

    /// A run that must be refused and leave everything as it was; what it said.
    fn refused(&self, arguments: &str, out: &Path) -> String {
        let before = self.files();
        let run = self.run(arguments, out);
        let said = String::from_utf8(run.stderr).unwrap();
        assert_eq!(run.status.code(), Some(2), "{arguments} with {}: {said}", out.display());
        assert!(self.files() == before, "{arguments} with {}: files have changed", out.display());
        said
    }
}

/// The ways to name a file: as it is, by a roundabout path, from the root, by a link, and by another name of the same bytes.
fn ways(place: &Place, input: &str, ending: &str) -> Vec<PathBuf> {
    let (file, name) = (place.path(input), Path::new(input).file_name().unwrap().to_str().unwrap());
    let (soft, hard) = (place.path(&format!("soft.{ending}")), place.path(&format!("hard.{ending}")));
    for link in [&soft, &hard] {
        let _ = fs::remove_file(link);
    }
    symlink(&file, &soft).unwrap();
    fs::hard_link(&file, &hard).unwrap();
    let mut ways = vec![soft, hard];
    if name.ends_with(&format!(".{ending}")) {
        ways.extend([PathBuf::from(input), format!("./case/../{input}").into(), file]);
    }
    ways
}

#[test]
fn an_input_is_never_overwritten_by_whatever_path() {
    let place = Place::new();
    for Case { arguments, ending, inputs } in COMMANDS {
        for input in *inputs {
            for out in ways(&place, input, ending) {
                let said = place.refused(arguments, &out);
                let what = format!("{arguments} with {} for {input}: {said}", out.display());
                assert!(said.contains("would be overwritten") && said.contains("give another"), "{what}");
                let is_named = said.contains(Path::new(input).file_name().unwrap().to_str().unwrap());
                assert!(is_named && said.contains(out.file_name().unwrap().to_str().unwrap()), "{what}");
            }
        }
    }
}

#[test]
fn what_is_written_beside_an_output_overwrites_no_input() {
    let place = Place::new();
    for (arguments, out, input) in [
        ("adapt b.mesh --metric a.solb -o OUT", "a.mesh", "a.solb"),
        ("adapt a.meshb --metric f.solb -o OUT", "a.mesh", "a.names.json"),
        ("bootstrap a.brep -o OUT", "a.meshb", "a.names.json"),
        ("classify a.meshb --cad a.brep -o OUT", "a.mesh", "a.names.json"),
        ("convert a.meshb OUT", "a.mesh", "a.solb"),
        ("convert b.mesh OUT --names a.mapbc", "a.b8.ugrid", "a.mapbc"),
    ] {
        let said = place.refused(arguments, Path::new(out));
        assert!(said.contains(input) && said.contains("would be overwritten"), "{arguments}: {said}");
    }
    let said = place.refused("convert case OUT", Path::new("./case"));
    assert!(said.contains("polyMesh/") && said.contains("would be overwritten"), "{said}");
    let said = place.refused("convert case/constant/polyMesh OUT", Path::new("case"));
    assert!(said.contains("would be overwritten"), "{said}");
}

#[test]
fn two_results_never_go_to_one_file() {
    let place = Place::new();
    let from_root = |name: &str| place.path(name).to_str().unwrap().to_owned();
    for name in ["mesh", "solb"] {
        symlink(format!("new.{name}"), place.path(&format!("{name}.json"))).unwrap(); // not there yet
    }
    symlink("new.html", place.path("page.png")).unwrap();
    fs::write(place.path("old.mesh"), "old").unwrap();
    fs::hard_link(place.path("old.mesh"), place.path("old.json")).unwrap();
    let adapt = "adapt a.meshb --metric a.solb -o new.mesh --report OUT";
    let image = "image-mesh i.nhdr -o new.mesh --report OUT";
    for (arguments, outs) in [
        (adapt, &["new.mesh", "./new.mesh", "new.solb", "new.names.json", "mesh.json", "solb.json"][..]),
        (image, &["new.mesh", "case/../new.mesh", "new.names.json", "mesh.json"]),
        ("adapt a.meshb --metric a.solb -o old.mesh --report OUT", &["old.mesh", "old.json"]),
        ("bootstrap a.brep -o new.mesh --report OUT", &["new.names.json", "mesh.json", "solb.json"]),
        ("transfer a.meshb f.solb b.mesh -o new.solb --report OUT", &["solb.json"]),
        ("metric geometry a.meshb -o new.solb --report OUT", &["solb.json"]),
        ("metric multiscale a.meshb f.solb --complexity 9 -o new.solb --report OUT", &["solb.json"]),
        ("field evaluate a.meshb --function sinfun3 -o new.solb --report OUT", &["solb.json"]),
        ("view a.meshb -o new.html --png OUT", &["page.png"]),
    ] {
        for out in outs.iter().flat_map(|out| [(*out).to_owned(), from_root(out)]) {
            let said = place.refused(arguments, Path::new(&out));
            assert!(
                said.contains("would write the same file") && said.contains(&out),
                "{arguments} with {out}: {said}"
            );
        }
    }
}

#[test]
fn what_cannot_be_written_is_told_before_anything_is_read() {
    let place = Place::new();
    fs::create_dir(place.path("folder.json")).unwrap();
    symlink("one.json", place.path("two.json")).unwrap();
    symlink("two.json", place.path("one.json")).unwrap();
    fs::write(place.path("fixed.json"), "old").unwrap();
    let mut permissions = fs::metadata(place.path("fixed.json")).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(place.path("fixed.json"), permissions).unwrap();
    let long = format!("{}.json", "a".repeat(300));
    let reports = COMMANDS.iter().filter(|case| case.ending == "json");
    for case in reports {
        for (out, expected) in [
            ("none/r.json", "there is no folder"),
            ("folder.json", "this is a folder"),
            ("new.json/", "this is a folder"),
            ("file/r.json", "ot a directory"),
            ("one.json", "symbolic links"),
            ("fixed.json", "read-only"),
            ("/proc/r.json", "/proc/r.json"),
            (&long, "too long"),
        ] {
            let said = place.refused(case.arguments, Path::new(out));
            assert!(said.contains(expected), "{} with {out}: {said}", case.arguments);
        }
    }
}

/// Who writes without [`Files`] could forget what is read: no other file of the command line has a way to.
#[test]
fn nothing_else_in_the_command_line_writes_files() {
    fn collect(folder: &Path, found: &mut Vec<PathBuf>) {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() { collect(&path, found) } else { found.push(path) }
        }
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/cli");
    let mut sources = Vec::new();
    collect(&root, &mut sources);
    // What goes to a folder of the run's own: its progress, meshers' scripts, what a child answers, the model that it makes for its parent, parts of a mesh.
    let own = [
        "workplace.rs",
        "events.rs",
        "child.rs",
        "bootstrap/netgen.rs",
        "bootstrap/gmsh.rs",
        "bootstrap/domain.rs",
        "bootstrap/heal.rs",
        "adapt/scratch.rs",
    ];
    let ways =
        ["write_", "Batch", "names::write", "formats::write", "fs::write", "File::create", "OpenOptions", "fs::copy"];
    let ways = [&ways[..], &["fs::rename", "println!", "print!(", "stdout()"]].concat();
    let mut wrong = Vec::new();
    for path in sources.iter().filter(|path| path.extension().is_some_and(|end| end == "rs")) {
        let name = path.strip_prefix(&root).unwrap().to_str().unwrap();
        if own.contains(&name) || name.starts_with("files/") || name == "terminal.rs" {
            continue;
        }
        let text = fs::read_to_string(path).unwrap();
        // Tests write to folders of their own.
        let code = text.lines().take_while(|line| *line != "#[cfg(test)]");
        for (line, number) in code.zip(1..) {
            let code = line.split("//").next().unwrap_or_default();
            let is_own = [
                "write_logs",
                "write_mesh(&mesh",
                "write_mesh(&self",
                "write_as_it_is",
                "write_brep",
                "write_triangles",
            ];
            let is_own = is_own.iter().any(|own| code.contains(own));
            if ways.iter().any(|way| code.contains(way)) && !is_own {
                wrong.push(format!("{name}:{number}: {line}"));
            }
        }
    }
    assert!(wrong.is_empty(), "these write by themselves:\n{}", wrong.join("\n"));
    assert!(sources.len() > 30, "only {} files of the command line were found", sources.len());
}
