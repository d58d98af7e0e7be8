//! What the README and the book say is typed, as it stands: each page's commands in a folder with what a clone has.
//!
//! A block that begins with ```console is typed; ```console,long takes minutes and is typed with GEO_ADAPT_LONG=1 (tests/run --long).
#![cfg(unix)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// All pages, by path.
fn pages(folder: &Path, all: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("the book has folders") {
        let path = entry.expect("it can be read").path();
        if path.is_dir() {
            pages(&path, all);
        } else if path.extension().is_some_and(|ending| ending == "md") {
            all.push(path);
        }
    }
    all.sort();
}

/// The lines that are typed on a page.
fn typed(page: &str) -> Vec<String> {
    let is_long = std::env::var_os("GEO_ADAPT_LONG").is_some();
    let mut lines = Vec::new();
    let mut is_typed = false;
    for line in page.lines() {
        match line.strip_prefix("```") {
            Some(kind) => is_typed = kind == "console" || is_long && kind == "console,long",
            None if is_typed => lines.extend(line.strip_prefix("$ ").map(str::to_owned)),
            None => {}
        }
    }
    lines
}

/// A folder with what a clone has, and an empty folder `out`.
fn clone() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for name in ["geometry", "cases", "docs", ".venv"] {
        let from = root().join(name);
        if from.exists() {
            std::os::unix::fs::symlink(from, folder.path().join(name)).expect("a link");
        }
    }
    fs::create_dir(folder.path().join("out")).expect("it is new");
    folder
}

#[test]
fn what_the_readme_and_the_book_say_is_typed() {
    let mut all = Vec::new();
    pages(&root().join("docs/book/src"), &mut all);
    all.push(root().join("README.md"));
    let programs = Path::new(env!("CARGO_BIN_EXE_geo-adapt")).parent().expect("it has a folder");
    let path = format!("{}:{}", programs.display(), std::env::var("PATH").unwrap_or_default());
    let has_fem = root().join(".venv/fem/bin/python").exists();
    assert!(has_fem || std::env::var_os("GEO_ADAPT_SET_UP").is_none(), "tests/run sets up .venv/fem");
    let mut count = 0;
    for page in all {
        let clone = clone();
        for line in typed(&fs::read_to_string(&page).expect("a page")) {
            if line.contains(".venv/fem") && !has_fem {
                eprintln!("{}: no .venv/fem: the rest of the page was not typed", page.display());
                break;
            }
            let output = Command::new("sh").args(["-ec", &line]).current_dir(clone.path()).env("PATH", &path).output();
            let output = output.expect("there is a shell");
            let said = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "{}: `{line}`: {said}", page.display());
            count += 1;
        }
    }
    assert!(count > 20, "only {count} lines were typed");
}

#[test]
fn all_pages_are_in_the_summary_and_their_pictures_are_there() {
    let book = root().join("docs/book/src");
    let summary = fs::read_to_string(book.join("SUMMARY.md")).expect("the summary");
    let mut all = Vec::new();
    pages(&book, &mut all);
    for page in all.iter().filter(|page| !page.ends_with("SUMMARY.md")) {
        let name = page.strip_prefix(&book).expect("it is below").display().to_string();
        assert!(summary.contains(&format!("({name})")), "{name} is not in the summary");
        let text = fs::read_to_string(page).expect("a page");
        for link in text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            let is_file = !link.starts_with("http") && !link.starts_with('#');
            let there = page.parent().expect("a folder").join(link).exists();
            assert!(!is_file || there, "{name}: {link} is not there");
        }
    }
}
