//! `geo-adapt adapt`.
use super::Outcome;
use crate::adapt::{self, Counts, Kind, Observer, Options};
use crate::geometry::{Discrete, Model};
use crate::mesh::io;
use crate::metric::{Analytic, Field, Source};
use crate::tasks::Pool;
use std::path::PathBuf;
use std::process::ExitCode;

/// Arguments of `geo-adapt adapt`.
#[derive(clap::Args)]
pub struct Arguments {
    input: PathBuf,
    #[arg(short, long, short_alias = 'x')]
    output: PathBuf,
    #[arg(long)]
    analytic: Option<Analytic>,
}

struct Print;
impl Observer for Print {
    fn begin(&self, kind: Kind, pass: usize, items: usize) {
        eprint!("{pass} {kind:?} {items} ");
    }
    fn advance(&self, _: usize) {}
    fn end(&self, counts: &Counts) {
        eprintln!("{} {:?}", counts.done, counts.refused);
    }
    fn stop(&self) -> bool {
        false
    }
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    let mesh = io::read_mesh(&arguments.input)?.content;
    let (model, place) = Discrete::from_mesh(&mesh, 45.0)?;
    let model = Model::Discrete(model);
    let source = Source::Analytic { field: arguments.analytic.unwrap(), log_scale: 0.0 };
    let pool = Pool::new(1)?;
    let adapted = adapt::adapt(&mesh, &place, &model, &source, &Options::default(), &pool, &Print)?;
    for w in &adapted.work {
        eprintln!("{:?} {:?} {:?}", w.time, w.counts.attempts, w.counts.done);
    }
    io::write_mesh(&arguments.output, &adapted.extracted.mesh)?;
    Field { metrics: adapted.extracted.metrics }.write(&arguments.output.with_extension("solb"))?;
    Ok(ExitCode::SUCCESS)
}
