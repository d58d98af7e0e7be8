//! What a loop leaves for somebody who gets its files without its folder: its result, or the last mesh and solution where it did not end.
use super::layout::Layout;
use crate::geometry::names;
use std::path::{Path, PathBuf};

/// The files, none of them twice by its name; none where this is no folder of a loop.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    let layout = Layout::new(folder.to_owned());
    if !layout.state().is_file() {
        return Vec::new();
    }
    let mut found: Vec<PathBuf> =
        std::fs::read_dir(layout.result()).into_iter().flatten().flatten().map(|entry| entry.path()).collect();
    if found.is_empty() {
        let solved = layout.finished("solve").into_iter().next_back();
        found.extend(solved.into_iter().flat_map(|cycle| {
            let mesh = layout.mesh(cycle);
            [names::beside(&mesh), mesh, layout.solution(cycle)]
        }));
        found.push(layout.page());
    }
    found.push(layout.figures());
    found.retain(|path| path.is_file());
    found.sort();
    found
}
