//! Imports go one way, as [`ALLOWED`] says: { cli → cycle, api } → { adapt, sizing, inspection, view, formats, image } → { metric → transfer, geometry }
//! → mesh → tasks. In the rooms of [`ROOMS`] no files name each other in a circle.

use super::imports::{Graph, Module};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// What each top-level module may import besides itself.
const ALLOWED: &[(&str, &[&str])] = &[
    (
        "cli",
        &[
            "serve",
            "remote",
            "cycle",
            "view",
            "formats",
            "decomposition",
            "ranks",
            "inspection",
            "adapt",
            "image",
            "surface",
            "delaunay",
            "sizing",
            "metric",
            "geometry",
            "transfer",
            "tasks",
            "mesh",
            "process",
            "memory",
        ],
    ),
    (
        "cycle",
        &[
            "view", "formats", "ranks", "adapt", "sizing", "metric", "geometry", "transfer", "tasks", "mesh",
            "process", "memory",
        ],
    ),
    ("api", &["adapt", "sizing", "metric", "geometry", "transfer", "tasks", "mesh"]),
    ("formats", &["geometry", "mesh", "tasks"]),
    ("adapt", &["sizing", "metric", "geometry", "tasks", "mesh", "memory"]),
    ("decomposition", &["adapt", "sizing", "metric", "geometry", "ranks", "tasks", "mesh"]),
    ("inspection", &["metric", "mesh", "tasks"]),
    ("sizing", &["metric", "geometry", "tasks", "mesh"]),
    ("image", &["tasks", "mesh"]),
    ("surface", &["geometry", "mesh", "tasks"]),
    ("delaunay", &["mesh"]),
    ("view", &["metric", "geometry", "tasks", "mesh"]),
    ("metric", &["transfer", "mesh", "tasks"]),
    ("transfer", &["mesh", "tasks"]),
    ("geometry", &["mesh", "tasks"]),
    ("tasks", &[]),
    ("mesh", &["tasks", "memory"]),
    ("memory", &[]),
    ("process", &[]),
    ("ranks", &[]),
    ("serve", &["cycle", "remote", "process"]),
    ("remote", &[]),
];

/// Rooms in which no files name each other in a circle, but within one part: a module of the room with all that is in it.
const ROOMS: &[&str] = &["adapt", "cycle", "cli/bootstrap", "process", "memory", "ranks"];

fn is_layer(name: &str) -> bool {
    ALLOWED.iter().any(|(layer, _)| *layer == name)
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// The source without line comments and with no white space, so that imports over several lines are in one piece.
fn compact(source: &str) -> String {
    let code = source.lines().map(|line| line.split("//").next().unwrap_or_default());
    code.flat_map(|line| line.chars().filter(|c| !c.is_whitespace())).collect()
}

/// The first names of what follows a path's `::`: one, or those of a group `{a::b, c}`.
fn first_names(rest: &str) -> Vec<String> {
    let name = |text: &str| text.chars().take_while(|c| is_word(*c)).collect::<String>();
    let Some(group) = rest.strip_prefix('{') else { return vec![name(rest)] };
    let (mut depth, mut names) = (0, vec![name(group)]);
    for (at, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth == 0 => break,
            '}' => depth -= 1,
            ',' if depth == 0 => names.push(name(&group[at + 1..])),
            _ => {}
        }
    }
    names
}

/// The layers that a file names: by `crate::`, by the crate's own name, or by enough `super::` to reach the root.
/// `depth` is the length of the file's module path.
fn imports(source: &str, depth: usize) -> Vec<String> {
    let code = compact(source);
    let to_root = "super::".repeat(depth);
    let mut found = Vec::new();
    for root in ["crate::", "geo_adapt::", to_root.as_str()] {
        for (at, _) in code.match_indices(root) {
            let before = &code[..at];
            // Part of a longer name, or of a longer path upwards than asked for. `use` ends in a letter too.
            let inside = before.ends_with(is_word) && !before.ends_with("use");
            if !inside && !before.ends_with("super::") {
                found.extend(first_names(&code[at + root.len()..]).into_iter().filter(|name| is_layer(name)));
            }
        }
    }
    found
}

fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("src is readable") {
        let path = entry.expect("src is readable").path();
        if path.is_dir() {
            rust_files(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// The names of the modules that a file lies in, its own included: src/a/b.rs is [a, b], src/a/mod.rs is [a].
fn module_path(file: &Path, src: &Path) -> Vec<String> {
    let inside = file.strip_prefix(src).expect("a file of src").with_extension("");
    let mut names: Vec<_> = inside.iter().map(|name| name.to_string_lossy().into_owned()).collect();
    if names.last().is_some_and(|name| name == "mod") {
        names.pop();
    }
    names
}

#[test]
fn imports_go_one_way() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let (mut files, mut wrong, mut seen) = (Vec::new(), Vec::new(), 0);
    rust_files(&src, &mut files);
    for file in files {
        let path = module_path(&file, &src);
        // lib.rs and main.rs stand above all layers.
        if path.len() == 1 && ["lib", "main"].contains(&path[0].as_str()) {
            continue;
        }
        let layer = path[0].as_str();
        let (_, allowed) = *ALLOWED
            .iter()
            .find(|(name, _)| *name == layer)
            .unwrap_or_else(|| panic!("{}: {layer} has no place among the layers: give it one", file.display()));
        for name in imports(&fs::read_to_string(&file).expect("a readable file"), path.len()) {
            seen += 1;
            if name != layer && !allowed.contains(&name.as_str()) {
                wrong.push(format!("{}: {layer} imports {name}", file.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "imports against the layers:\n{}", wrong.join("\n"));
    assert!(seen >= 5, "only {seen} imports between layers were recognised: this test reads the source wrongly");
}

#[test]
fn no_files_of_a_room_name_each_other_in_a_circle() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    rust_files(&src, &mut files);
    let read = |file: &PathBuf| (module_path(file, &src), fs::read_to_string(file).expect("a readable file"));
    let sources: BTreeMap<Module, String> = files.iter().map(read).collect();
    let graph = Graph::new(&sources);
    for room in ROOMS {
        let names: Vec<&str> = room.split('/').collect();
        assert!(graph.count_within(&names) > 0, "{room}: no imports were recognised: the source is read wrongly");
        if let Some(circle) = graph.circle(&names) {
            panic!("{room}: {} → {}: move what they share into a file of its own", circle.join(" → "), circle[0]);
        }
    }
}

#[test]
fn every_way_to_write_an_import_is_seen() {
    assert_eq!(imports("use crate::mesh::vector::Vec3;", 2), ["mesh"]);
    assert_eq!(imports("use crate::{\n    adapt::{Store, TetId},\n    metric,\n};", 2), ["adapt", "metric"]);
    assert_eq!(imports("fn f() { crate::cli::main(); }", 2), ["cli"]);
    assert_eq!(imports("use super::super::geometry::Model;", 2), ["geometry"]);
    assert_eq!(imports("use geo_adapt::tasks;", 1), ["tasks"]);
    assert!(imports("use super::geometry::Model; // crate::cli", 2).is_empty());
    assert!(imports("let my_crate::cli = 0;", 2).is_empty());
}
