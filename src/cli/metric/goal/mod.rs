//! `geo-adapt metric goal`.
mod file;
mod made;

pub use file::Asked;
pub use made::{Made, make};

use super::common::{self, Amount, GradationArgument, LimitArguments, OutputArgument, RunArguments};
use crate::cli::figures::FigureArguments;
use crate::cli::files::reading::Carrier;
use crate::cli::files::{Files, JSON, Outputs};
use crate::cli::table::Table;
use crate::cli::{Outcome, positive};
use crate::metric::goal::terms::{Equations, Flow, GAMMA, PRANDTL};
use crate::metric::goal::{Boundary, NORM, Variables};
use crate::metric::multiscale::{Bounds, Measure, Norm, Options};
use crate::metric::recovery::Recovery;
use crate::metric::summary::Summary;
use crate::tasks::{Plan, Team, stage};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// A file of terms, for the help.
const FILE: &str = "A file of --terms. Paths begin at its folder, and may be names of fields of the mesh's file:
  boundary = \"inside\"                          # as --boundary
  [[terms]]                                      # Q is the sum of weight times |H(field)| over the terms
  field = \"u.solb\"
  weight = \"weights.solb\"                        # from 0 on
  [[terms]]
  field = { file = \"flow.solb\", component = 2 }  # one of several values a vertex
  adjoint = \"adjoint.solb\"                       # the weight is 0.5 |d/dx of this| + 0.01 |d2/dy2 of this|
  derivatives = { x = 0.5, yy = 0.01 }
  [flow]                                         # as --euler, --navier-stokes and --incompressible
  primal = \"flow.solb\"
  adjoint = \"adjoint.solb\"
  equations = \"compressible\"                     # or incompressible
  mu = 0.001";

/// Arguments of `geo-adapt metric goal`.
#[derive(clap::Args)]
#[command(defer(common::needs_amount), after_help = FILE)]
pub struct Arguments {
    /// The mesh, in any format that `convert` reads
    mesh: PathBuf,
    #[command(flatten)]
    of: OfArguments,
    #[command(flatten)]
    gas: GasArguments,
    #[command(flatten)]
    output: OutputArgument,
    #[command(flatten)]
    amount: Amount,
    /// The p of the metric's exponent -1/(2p+3). The error of a functional is an integral: 1
    #[arg(long, value_name = "P", default_value_t = NORM, allow_negative_numbers = true)]
    norm: Norm,
    /// How second derivatives are recovered
    #[arg(long, value_enum, default_value_t = Recovery::default())]
    hessian: Recovery,
    /// What vertices on the boundary of the domain get [default: as the file of --terms says, else inside]
    #[arg(long, value_enum)]
    boundary: Option<Boundary>,
    #[command(flatten)]
    gradation: GradationArgument,
    #[command(flatten)]
    limits: LimitArguments,
    #[command(flatten)]
    figures: FigureArguments,
    #[command(flatten)]
    run: RunArguments,
}

/// What the terms are: exactly one of these.
#[derive(clap::Args)]
#[group(id = "goal", required = true, multiple = false)]
struct OfArguments {
    /// Pairs of weight and field, a TOML file as below
    #[arg(long, value_name = "FILE.toml")]
    terms: Option<PathBuf>,
    /// The state of a gas at the vertices: the fluxes of Euler's equations are the fields, weighted by the derivatives of --adjoint
    #[arg(long, value_name = "PRIMAL", requires = "adjoint")]
    euler: Option<PathBuf>,
    /// The same with the terms of viscosity and heat, for --mu or --reynolds
    #[arg(long, value_name = "PRIMAL", requires = "adjoint", requires = "viscosity")]
    navier_stokes: Option<PathBuf>,
    /// A flow of constant density: velocity (3) and pressure at the vertices; without --mu and --reynolds it has no friction
    #[arg(long, value_name = "PRIMAL", requires = "adjoint")]
    incompressible: Option<PathBuf>,
}

/// What flows, and its adjoint.
#[derive(clap::Args)]
struct GasArguments {
    /// The adjoint at the vertices: multipliers of the equations of mass, momentum (3) and total energy in conservative form; with --incompressible
    /// those of momentum (3) and mass, such as OpenFOAM's Ua and pa
    #[arg(long, value_name = "ADJOINT", conflicts_with = "terms")]
    adjoint: Option<PathBuf>,
    /// Density of an incompressible flow, by which the pressure is divided
    #[arg(long, value_name = "RHO", default_value_t = 1.0, value_parser = positive, allow_negative_numbers = true, conflicts_with_all = ["terms", "euler", "navier_stokes"])]
    density: f64,
    /// What the five values of --euler or --navier-stokes are, in any one system of units
    #[arg(long, value_enum, default_value_t = Variables::default(), conflicts_with_all = ["terms", "incompressible"])]
    variables: Variables,
    /// Ratio of the specific heats
    #[arg(long, value_name = "GAMMA", default_value_t = GAMMA, value_parser = positive, allow_negative_numbers = true, conflicts_with_all = ["terms", "incompressible"])]
    gamma: f64,
    /// Dynamic viscosity, in the units of density, velocity and the mesh's length
    #[arg(long, value_name = "MU", value_parser = positive, allow_negative_numbers = true, group = "viscosity", conflicts_with_all = ["terms", "euler"])]
    mu: Option<f64>,
    /// Reynolds' number: the viscosity is 1/RE, of a state that is divided by density and speed of the free stream, on a mesh whose unit is the
    /// length of RE
    #[arg(long, value_name = "RE", value_parser = positive, allow_negative_numbers = true, group = "viscosity", conflicts_with_all = ["terms", "euler"])]
    reynolds: Option<f64>,
    /// Prandtl's number
    #[arg(long, value_name = "PR", default_value_t = PRANDTL, value_parser = positive, allow_negative_numbers = true, conflicts_with_all = ["terms", "euler", "incompressible"])]
    prandtl: f64,
}

/// What is written as JSON.
#[derive(Serialize)]
struct Report<'a> {
    version: &'static str,
    #[serde(serialize_with = "crate::cli::files::text::path")]
    mesh: &'a Path,
    #[serde(serialize_with = "crate::cli::files::text::path")]
    output: &'a Path,
    goal: Made,
    metric: Summary,
}

impl Arguments {
    /// The terms.
    fn asked(&self) -> Result<Asked, String> {
        let OfArguments { terms, euler, navier_stokes, incompressible } = &self.of;
        let GasArguments { adjoint, density, variables, gamma, mu, reynolds, prandtl } = &self.gas;
        if let Some(terms) = terms {
            return Asked::read(terms);
        }
        let primal = euler.as_ref().or(navier_stokes.as_ref()).or(incompressible.as_ref());
        let (Some(primal), Some(adjoint)) = (primal, adjoint) else {
            return Err("give --terms, or --euler, --navier-stokes or --incompressible with an --adjoint".into());
        };
        let equations = if incompressible.is_some() { Equations::Incompressible } else { Equations::Compressible };
        let (primal, adjoint) = (primal.clone(), adjoint.clone());
        let (density, variables, gamma, prandtl) = (*density, *variables, *gamma, *prandtl);
        let (mu, reynolds) = (*mu, *reynolds);
        Ok(Asked::flow(Flow { primal, adjoint, equations, density, variables, gamma, mu, reynolds, prandtl }))
    }
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    let asked = arguments.asked()?;
    let mut files = Files::new().reads_meshes([&arguments.mesh]).reads(&arguments.of.terms);
    files = files.reads_fields(asked.files(), &arguments.mesh);
    let target = arguments.output.target(&mut files)?;
    let json = arguments.figures.target(&mut files, JSON)?;
    let pool = arguments.run.pool()?;
    let team = Team::new(&pool, Plan::default());
    let data = common::mesh(&arguments.run, team, &arguments.mesh)?;
    stage("mesh read");
    let (complexity, gradation) = (arguments.amount.needed()?, arguments.gradation.ratio());
    let (limits, measure) = (arguments.limits.limits()?, Measure::AtVertices);
    let bounds = Bounds { complexity, measure, gradation, limits, fixed: None, by_others: None };
    let options = Options { recovery: arguments.hessian, norm: arguments.norm, bounds };
    let (of, mut notices) = (Carrier::of(&arguments.mesh, &data), Vec::new());
    let (logs, made) = make(team, (&data.mesh, &[]), (&asked, of), (&options, arguments.boundary), &mut notices)?;
    arguments.run.note(&notices);
    let mut outputs = Outputs::new();
    arguments.run.note(&outputs.logs(team, &target, &logs, common::on(&data))?);
    if arguments.figures.are_not_wanted() {
        outputs.commit()?;
        return Ok(ExitCode::SUCCESS);
    }
    let report = Report {
        version: env!("CARGO_PKG_VERSION"),
        mesh: &arguments.mesh,
        output: &arguments.output.output,
        goal: made,
        metric: Summary::of(team, &data.mesh, &logs),
    };
    outputs.json(json.as_ref(), &report)?;
    outputs.commit()?;
    arguments.figures.print(&report, || {
        let mut table = Table::new();
        report.goal.rows(&mut table);
        super::show::rows(&mut table, &report.metric, None);
        table.row("written", arguments.output.output.display());
        table.text().into()
    })?;
    Ok(ExitCode::SUCCESS)
}
