//! `geo-adapt field`: fields at the vertices of a mesh, evaluated or picked out of others.
use super::metric::common::{self, Failure, RunArguments, check_output};
use super::table::{Table, figure};
use super::{Outcome, print};
use crate::mesh::io::{self, FieldKind, Solution, SolutionField, read_solution};
use crate::metric::Scalar;
use crate::tasks::{Plan, Team};
use clap::Subcommand;
use serde::Serialize;
use std::path::PathBuf;
use std::process::ExitCode;

/// Arguments of `geo-adapt field`.
#[derive(clap::Args)]
pub struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// An analytic function at the vertices of a mesh, and the error of its linear interpolation there
    Evaluate(Evaluate),
    /// Some of the values of a file: components, or lengths of vectors
    Pick(Pick),
}

/// Arguments of `geo-adapt field evaluate`.
#[derive(clap::Args)]
struct Evaluate {
    /// The mesh: .mesh or .meshb
    mesh: PathBuf,
    /// The function, on the unit cube (Tsolakis 2021, equations 21 to 23)
    #[arg(long, value_enum, value_name = "NAME")]
    function: Scalar,
    /// Where the field goes: .sol or .solb
    #[arg(short, long, visible_short_alias = 'x', value_name = "OUT")]
    output: PathBuf,
    /// Write the error as JSON
    #[arg(long, value_name = "FILE.json")]
    report: Option<PathBuf>,
    #[command(flatten)]
    run: RunArguments,
}

/// Arguments of `geo-adapt field pick`.
#[derive(clap::Args)]
struct Pick {
    /// Fields at vertices: .sol or .solb
    input: PathBuf,
    /// Values of each vertex, counted from 1 through all fields of the file: 5, or norm:2-4, the length of the vector of three
    #[arg(long, value_name = "K,norm:A-B,…", value_delimiter = ',', required = true)]
    take: Vec<Take>,
    /// Where they go, a scalar field each: .sol or .solb
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

/// What `evaluate --report` writes.
#[derive(Serialize)]
struct Report {
    version: &'static str,
    mesh: PathBuf,
    function: Scalar,
    vertices: usize,
    tets: usize,
    /// L2 norm of the difference between the function and its linear interpolation.
    error: f64,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    match &arguments.command {
        Command::Evaluate(arguments) => evaluate(arguments),
        Command::Pick(arguments) => pick(arguments),
    }
}

fn evaluate(arguments: &Evaluate) -> Outcome {
    let inputs = [arguments.mesh.as_path()];
    check_output(&arguments.output, &["sol", "solb"], &inputs)?;
    arguments.report.as_deref().map(|report| check_output(report, &["json"], &inputs)).transpose()?;
    let pool = arguments.run.pool()?;
    let team = Team::new(&pool, Plan::default());
    let mesh = common::mesh(&arguments.run, team, &arguments.mesh)?;
    let values = arguments.function.on(team, &mesh);
    let error = arguments.function.error(team, &mesh, &values);
    if let Some(at) = values.iter().position(|value| !value.is_finite()) {
        let name = arguments.mesh.display();
        return Err(
            format!("{name}: the function is {} at vertex {}: it is one of the unit cube", values[at], at + 1).into()
        );
    }
    let solution = Solution { vertices: values.len(), fields: vec![SolutionField { kind: FieldKind::Scalar, values }] };
    io::write_solution_on(team, &arguments.output, &solution)?;
    let report = Report {
        version: env!("CARGO_PKG_VERSION"),
        mesh: arguments.mesh.clone(),
        function: arguments.function,
        vertices: mesh.vertices.len(),
        tets: mesh.tets.len(),
        error,
    };
    if let Some(path) = &arguments.report {
        common::write_json(path, &report)?;
    }
    let mut table = Table::new();
    table.row("vertices", report.vertices);
    table.row("L2 interpolation error", figure(report.error));
    table.row("written", arguments.output.display());
    arguments.run.print(table.text());
    Ok(ExitCode::SUCCESS)
}

fn pick(arguments: &Pick) -> Result<ExitCode, Failure> {
    check_output(&arguments.output, &["sol", "solb"], &[&arguments.input])?;
    let read = read_solution(&arguments.input)?;
    read.notices.iter().for_each(|notice| eprintln!("geo-adapt: note: {notice}"));
    let solution = read.content;
    // The values of a vertex by field.
    let columns: Vec<(usize, usize)> = solution
        .fields
        .iter()
        .enumerate()
        .flat_map(|(field, content)| (0..content.kind.values()).map(move |value| (field, value)))
        .collect();
    let mut fields = Vec::new();
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
    }
    let picked = Solution { vertices: solution.vertices, fields };
    io::write_solution(&arguments.output, &picked)?;
    print(&format!(
        "{}: {} scalars at {} vertices\n",
        arguments.output.display(),
        picked.fields.len(),
        picked.vertices
    ));
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
