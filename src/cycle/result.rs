//! What a loop that has ended leaves at one place: `OUT/result`, with the last mesh and solution for people, for us, and for the solver.
use super::config::Loaded;
use super::data::SolveResult;
use super::error::Error;
use super::history::History;
use super::layout::Layout;
use crate::formats::{self, Dataset, NamedField};
use crate::geometry::names;
use crate::mesh::io::{read_mesh_and_stack, read_solution, write_beside};
use crate::tasks::Team;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

/// What each file is, and where.
pub type Files = Vec<(&'static str, PathBuf)>;

/// Writes the folder anew. It is made beside and renamed, so that an old one is there until then.
///
/// # Errors
/// When something cannot be written.
pub fn write(
    layout: &Layout,
    loaded: &Loaded,
    history: &History,
    cycle: u32,
    solved: &SolveResult,
) -> Result<Files, Error> {
    let (target, made) = (layout.result(), layout.result().with_extension("new"));
    let named = |path: &Path, error: std::io::Error| Error::Failed(format!("{}: {error}", path.display()));
    let remove = |path: &Path| match path.exists() {
        true => fs::remove_dir_all(path).map_err(|error| named(path, error)),
        false => Ok(()),
    };
    remove(&made)?;
    fs::create_dir_all(&made).map_err(|error| named(&made, error))?;
    let mut files: Files = vec![
        ("result", made.join("result.vtu")),
        ("mesh", made.join("mesh.meshb")),
        ("solution", made.join("solution.solb")),
        ("functionals", made.join("functionals.csv")),
        ("report", made.join("report.html")),
    ];
    for (from, to) in [(layout.mesh(cycle), &files[1].1), (layout.solution(cycle), &files[2].1)] {
        copy(&from, to)?;
        if names::beside(&from).is_file() {
            copy(&names::beside(&from), &names::beside(to))?;
        }
    }
    let data = dataset(layout, cycle, solved)?;
    formats::write(&files[0].1, &data)?;
    let for_solver = loaded.config.solver.solver().result(&data, &made)?;
    files.extend(for_solver.into_iter().map(|path| ("for the solver", path)));
    write_beside(&files[3].1, |file| file.write_all(table(history).as_bytes()))?;
    copy(&layout.page(), &files[4].1)?;
    remove(&target)?;
    fs::rename(&made, &target).map_err(|error| named(&target, error))?;
    let moved = |path: PathBuf| path.strip_prefix(&made).map_or(path.clone(), |inside| target.join(inside));
    Ok(files.into_iter().map(|(what, path)| (what, moved(path))).collect())
}

fn copy(from: &Path, to: &Path) -> Result<(), Error> {
    fs::copy(from, to).map(drop).map_err(|error| Error::Failed(format!("{}: {error}", from.display())))
}

/// The mesh of a cycle with its names and its solution.
fn dataset(layout: &Layout, cycle: u32, solved: &SolveResult) -> Result<Dataset, Error> {
    let (mesh, stack) = read_mesh_and_stack(Team::alone(), &layout.mesh(cycle))?.content;
    let solution = read_solution(&layout.solution(cycle))?.content;
    let fields = solution.fields.into_iter().zip(&solved.fields);
    let fields =
        fields.map(|(field, named)| NamedField { name: named.name.clone(), kind: field.kind, values: field.values });
    let (names, fields) = (names::read(&layout.mesh(cycle))?, fields.collect());
    Ok(Dataset { mesh, stack, names, fields })
}

/// A row a cycle, with the functionals. Without times, so that it is the same file however often the loop was ended; the report has them.
fn table(history: &History) -> String {
    let names: Vec<&String> = history.cycles.first().map_or_else(Vec::new, |cycle| cycle.functionals.keys().collect());
    let quoted = |name: &str| {
        if name.contains([',', '"', '\n']) { format!("\"{}\"", name.replace('"', "\"\"")) } else { name.into() }
    };
    let mut text = String::from("cycle,complexity,vertices,tetrahedra");
    names.iter().for_each(|name| text += &format!(",{}", quoted(name)));
    text += "\n";
    let number = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
    for cycle in &history.cycles {
        let _ = write!(text, "{},{},{},{}", cycle.cycle, number(cycle.complexity), cycle.vertices, cycle.tets);
        for &name in &names {
            text += &format!(",{}", number(cycle.functionals.get(name).copied()));
        }
        text += "\n";
    }
    text
}

#[cfg(test)]
mod tests {
    use super::super::history::Cycle;
    use super::*;

    #[test]
    fn a_row_a_cycle() {
        let cycle = |cycle, complexity, drag: f64| Cycle {
            cycle,
            complexity,
            vertices: 8,
            tets: 6,
            functionals: [("drag".to_owned(), drag), ("p, mean".to_owned(), 1.5)].into(),
            ..Cycle::default()
        };
        let cycles = vec![cycle(1, None, 0.25), cycle(2, Some(100.0), 1e-3)];
        let text = table(&History { cycles, ..History::default() });
        assert_eq!(
            text,
            "cycle,complexity,vertices,tetrahedra,drag,\"p, mean\"\n1,,8,6,0.25,1.5\n2,100,8,6,0.001,1.5\n"
        );
    }
}
