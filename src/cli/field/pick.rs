//! `geo-adapt field pick`.
use super::super::files::reading::{self, Carrier, Fields};
use super::super::files::{Files, Outputs};
use super::super::metric::common::Failure;
use super::super::say;
use crate::mesh::io::{FieldKind, Solution, SolutionField};
use crate::tasks::Team;
use std::path::PathBuf;
use std::process::ExitCode;

/// Arguments of `geo-adapt field pick`.
#[derive(clap::Args)]
pub struct Arguments {
    /// Fields at vertices: .sol or .solb, or a mesh of a format that holds them
    input: PathBuf,
    /// Values of each vertex, counted from 1 through all fields of the file: 5, or norm:2-4, the length of the vector of three
    #[arg(long, value_name = "K,norm:A-B,…", value_delimiter = ',', required = true)]
    take: Vec<Take>,
    /// Where they go, a scalar field each: .sol or .solb; of a mesh with fields also another of such formats
    #[arg(short, long, visible_short_alias = 'x', value_name = "OUT")]
    output: PathBuf,
}

/// Values of a vertex, from 0: one, or several whose root of squares is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Take {
    first: usize,
    last: usize,
    norm: bool,
}

impl std::str::FromStr for Take {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = |text: &str| text.trim().parse::<usize>().ok().and_then(|number| number.checked_sub(1));
        let ends = match text.strip_prefix("norm:") {
            Some(range) => range.split_once('-').and_then(|(a, b)| Some((number(a)?, number(b)?, true))),
            None => number(text).map(|at| (at, at, false)),
        };
        match ends {
            Some((first, last, norm)) if first <= last => Ok(Self { first, last, norm }),
            _ => Err("give the number of a value, from 1, or norm:2-4 for the length of the vector of three".into()),
        }
    }
}

impl Take {
    /// What the values are called, from a column of a field with such a name.
    fn name(self, solution: &Solution, names: &[String], (field, value): (usize, usize)) -> String {
        let of = names.get(field).cloned().unwrap_or_else(|| format!("field {}", field + 1));
        match (self.norm, solution.fields[field].kind) {
            (true, _) => format!("norm of {of}"),
            (false, FieldKind::Scalar) => of,
            (false, _) => format!("{of} {}", value + 1),
        }
    }
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    let target =
        Files::new().reads_fields([&arguments.input], &arguments.input).writes_fields(&arguments.output, "-o")?;
    let none = Carrier { path: &arguments.input, vertices: &[], fields: &[] };
    let read = reading::fields(Team::alone(), &arguments.input, none)?;
    read.notices.iter().for_each(crate::cli::note);
    let Fields { solution, names, mesh } = read.content;
    // The values of a vertex by field.
    let columns: Vec<(usize, usize)> = solution
        .fields
        .iter()
        .enumerate()
        .flat_map(|(field, content)| (0..content.kind.values()).map(move |value| (field, value)))
        .collect();
    let (mut fields, mut called) = (Vec::new(), Vec::new());
    for take in &arguments.take {
        if take.last >= columns.len() {
            let (name, count) = (arguments.input.display(), columns.len());
            return Err(format!("{name}: {count} values a vertex, but --take asks for value {}", take.last + 1).into());
        }
        let at = |vertex: usize, (field, value): (usize, usize)| {
            let field = &solution.fields[field];
            field.values[vertex * field.kind.values() + value]
        };
        let values = (0..solution.vertices).map(|vertex| match take.norm {
            false => at(vertex, columns[take.first]),
            true => {
                columns[take.first..=take.last].iter().map(|&column| at(vertex, column).powi(2)).sum::<f64>().sqrt()
            }
        });
        fields.push(SolutionField { kind: FieldKind::Scalar, values: values.collect() });
        called.push(take.name(&solution, &names, columns[take.first]));
    }
    let picked = Solution { vertices: solution.vertices, fields };
    let mut outputs = Outputs::new();
    let found = Fields { solution: picked, names: called, mesh: None };
    outputs.fields(Team::alone(), &target, found, mesh.as_ref())?.iter().for_each(crate::cli::note);
    outputs.commit()?;
    say(&format!(
        "{}: {} scalars at {} vertices\n",
        arguments.output.display(),
        arguments.take.len(),
        solution.vertices
    ))?;
    Ok(ExitCode::SUCCESS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_taken_as_text() {
        assert_eq!("5".parse(), Ok(Take { first: 4, last: 4, norm: false }));
        assert_eq!("norm:2-4".parse(), Ok(Take { first: 1, last: 3, norm: true }));
        for wrong in ["0", "x", "norm:4-2", "norm:3", "norm:0-2"] {
            assert!(wrong.parse::<Take>().is_err(), "{wrong}");
        }
    }
}
