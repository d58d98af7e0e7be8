//! OpenFOAM: a case is made of a few flow conditions, run until it stands still, and read.
//!
//! `flow` says what holds where, `method` which program solves it (rhoCentralFoam with local time steps, or rhoSimpleFoam where the flow is
//! slow and viscous), `dictionaries` how; `drive` runs the case (a process of its own, `geo-adapt openfoam CASE`) through
//! `programs`, as fast as `step_control` lets it, to first order in the cells of `first_order`, until it stands still or else to its `mean`, and `forces` sums up what
//! acts on the walls, over `cells`, which need not be tetrahedra. `adjoint` solves the adjoint of lift or drag then, where it is wanted. OpenFOAM v1912 (Debian's package `openfoam`).
pub mod adjoint;
mod cells;
mod dictionaries;
pub mod drive;
mod first_order;
mod flow;
mod forces;
mod mean;
mod method;
mod programs;
mod state;
mod step_control;

pub use cells::Cells;
pub use flow::{Flow, Kind};
pub use forces::{Coefficients, Walls};
pub use method::{Method, Scheme, Stage};

use super::{FieldName, Job, Solver};
use crate::cycle::data::{Call, GoalFlow, Solved};
use crate::cycle::launch::{self, find_program};
use crate::formats::foam::{self, CellField};
use crate::formats::{self, Dataset, NamedField};
use crate::mesh::io::FieldKind;
use crate::tasks::Team;
use drive::{Outcome, PLAN, Plan, RESULT};
use programs::Program;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// `[solver.openfoam]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Config {
    /// Which of OpenFOAM's programs; by default what suits the flow.
    pub method: Option<Method>,
    /// The program, on the PATH or with its folder; by default that of the method.
    pub program: Option<String>,
    /// Processes: above 1 the mesh is cut into as many parts, and mpirun starts them.
    #[serde(default = "single")]
    pub processes: u32,
    /// The flow.
    pub flow: Flow,
    /// Steps of a solve at most.
    #[serde(default = "thousand")]
    pub steps: usize,
    /// Steps of first order before those of the first solve; by default 300, with `simple` none.
    pub start_steps: Option<usize>,
    /// Steps between two looks at it; by default 100, with `simple` 50.
    pub block: Option<usize>,
    /// A solve ends when pressure and coefficients change by less over two blocks in a row, relatively.
    #[serde(default = "still")]
    pub still: f64,
    /// How values at faces are found; by default the best that lasts on stretched tetrahedra.
    pub scheme: Option<Scheme>,
    /// Greatest Courant number, of `central`; it is halved where a solve blows up and first order in the cells that fell does not help.
    #[serde(default = "courant")]
    pub courant: f64,
    /// Greatest growth of the local time step from a cell to the next, less 1; of `central`.
    #[serde(default = "courant")]
    pub smoothing: f64,
    /// Relaxation of velocity and energy, of `simple`; it is halved where a solve blows up.
    #[serde(default = "relaxation")]
    pub relaxation: f64,
    /// A force whose adjoint is solved too, of a viscous flow up to Mach 0.3.
    pub adjoint: Option<adjoint::Force>,
}

fn single() -> u32 {
    1
}

fn thousand() -> usize {
    1000
}

fn still() -> f64 {
    1e-4
}

fn courant() -> f64 {
    0.3
}

fn relaxation() -> f64 {
    0.7
}

/// The fields of a solution, with their values a vertex.
const FIELDS: [(&str, usize); 5] = [("p", 1), ("T", 1), ("U", 3), ("rho", 1), ("Mach", 1)];

/// What a solve tells besides.
const FUNCTIONALS: [&str; 4] = ["CL", "CD", "steps", "change"];

/// What it tells besides of an adjoint.
const ADJOINT_STEPS: &str = "adjoint steps";

/// The folder of the case in that of a step.
const CASE: &str = "case";

impl Config {
    /// The method.
    pub fn method(&self) -> Method {
        self.method.unwrap_or_else(|| Method::of(&self.flow))
    }

    /// The program.
    pub fn program(&self) -> &str {
        self.program.as_deref().unwrap_or(self.method().program())
    }

    /// What holds at each surface of a mesh.
    fn kinds(&self, data: &Dataset) -> Result<BTreeMap<i32, Kind>, String> {
        let references: BTreeSet<i32> = data.mesh.triangles.refs.iter().copied().collect();
        let name = |reference: i32| data.names.triangles.get(&reference).and_then(|label| label.name.as_deref());
        let shown = |reference: i32| {
            name(reference).map_or_else(|| reference.to_string(), |name| format!("{name} ({reference})"))
        };
        let (mut kinds, mut missing) = (BTreeMap::new(), Vec::new());
        for &reference in &references {
            match self.flow.kind(reference, name(reference)) {
                Some(kind) => drop(kinds.insert(reference, kind)),
                None => missing.push(shown(reference)),
            }
        }
        if !missing.is_empty() {
            return Err(format!(
                "[solver.openfoam.flow] says nothing of the surfaces {}: put each in one of walls, symmetry, farfield, inflow, outflow",
                missing.join(", ")
            ));
        }
        let flow = &self.flow;
        let lists = [&flow.walls, &flow.symmetry, &flow.farfield, &flow.inflow, &flow.outflow];
        let known = |word: &str| {
            references.iter().any(|&reference| name(reference) == Some(word) || reference.to_string() == word)
        };
        if let Some(word) = lists.into_iter().flatten().find(|word| !known(word)) {
            let all: Vec<String> = references.iter().map(|&reference| shown(reference)).collect();
            return Err(format!("[solver.openfoam.flow] names a surface {word}, but the mesh has {}", all.join(", ")));
        }
        Ok(kinds)
    }

    /// The fields to begin with: those before, or the free stream.
    fn initial(&self, data: &Dataset) -> Result<[CellField; 3], String> {
        let (flow, team) = (&self.flow, Team::alone());
        let uniform = |kind, values: &[f64]| CellField { kind, values: values.to_vec() };
        if data.fields.is_empty() {
            return Ok([
                uniform(FieldKind::Scalar, &[flow.pressure]),
                uniform(FieldKind::Scalar, &[flow.temperature]),
                uniform(FieldKind::Vector, &flow.velocity()),
            ]);
        }
        let cells = |name: &str, kind: FieldKind| {
            let field = data.fields.iter().find(|field| field.name == name && field.kind == kind);
            let field = field.ok_or_else(|| format!("the solution before has no field {name}: begin the loop anew"))?;
            let values = data.vertices_to_cells(team, &field.values, kind.values());
            Ok::<_, String>(CellField { kind, values })
        };
        let (mut p, mut t) = (cells("p", FieldKind::Scalar)?, cells("T", FieldKind::Scalar)?);
        // What a transfer that keeps integrals may have overshot.
        p.values.iter_mut().for_each(|value| *value = value.max(0.02 * flow.pressure));
        t.values.iter_mut().for_each(|value| *value = value.max(0.05 * flow.temperature));
        Ok([p, t, cells("U", FieldKind::Vector)?])
    }

    /// References of the walls.
    fn walls(&self, data: &Dataset) -> Result<Vec<i32>, String> {
        let kinds = self.kinds(data)?.into_iter();
        Ok(kinds.filter(|(_, kind)| *kind == Kind::Wall).map(|(reference, _)| reference).collect())
    }

    /// A program, where it is found from the folder of the configuration.
    fn found(&self, program: &str, base: &Path) -> Program {
        let path = find_program(program, base).unwrap_or_else(|| program.into());
        Program { path: path.to_string_lossy().into_owned(), processes: self.processes }
    }

    /// The plan of the adjoint, on these patches.
    fn plan_of_adjoint(&self, patches: Vec<(String, Kind)>, base: &Path) -> Option<adjoint::Plan> {
        let force = self.adjoint?;
        let program = self.found(adjoint::PROGRAM, base);
        let scheme = self.scheme.unwrap_or(Scheme::LinearUpwind);
        Some(adjoint::Plan { force, program, patches, iterations: self.steps, scheme, relaxation: self.relaxation })
    }

    fn plan(&self, walls: Vec<i32>, patches: Vec<(String, Kind)>, begins: bool, base: &Path) -> Plan {
        let symmetry = patches.iter().filter(|(_, kind)| *kind == Kind::Symmetry).map(|(name, _)| name.clone());
        let method = self.method();
        let &Self { courant, smoothing, relaxation, .. } = self;
        let scheme = self.scheme.unwrap_or(method.scheme());
        Plan {
            program: self.found(self.program(), base),
            flow: self.flow.clone(),
            walls,
            symmetry: symmetry.collect(),
            stage: Stage { method, scheme, courant, smoothing, relaxation },
            start_steps: if begins { self.start_steps.unwrap_or(method.start_steps()) } else { 0 },
            steps: self.steps,
            block: self.block.unwrap_or(method.block()),
            still: self.still,
            adjoint: self.plan_of_adjoint(patches, base),
        }
    }
}

impl Solver for Config {
    fn check(&self, base: &Path) -> Result<(), String> {
        self.flow.check()?;
        if self.block == Some(0) || self.steps == 0 {
            return Err("[solver.openfoam] steps and block: give 1 or more".into());
        }
        launch::check("[solver.openfoam]", self.processes)?;
        if !(self.courant > 0.0 && self.courant < 1.0 && self.smoothing > 0.0 && self.smoothing.is_finite()) {
            return Err(
                "[solver.openfoam] courant: give a number between 0 and 1 (0.2 to 0.45 is usual); smoothing: above 0"
                    .into(),
            );
        }
        if !(self.relaxation > 0.0 && self.relaxation < 1.0) {
            return Err("[solver.openfoam] relaxation: give a number between 0 and 1 (0.7 is usual)".into());
        }
        if self.method() == Method::Central && self.scheme == Some(Scheme::LinearUpwind) {
            return Err(
                "[solver.openfoam] scheme linearupwind is of method simple; give upwind, minmod, vanalbada or vanleer"
                    .into(),
            );
        }
        let missing = |program: &&str| find_program(program, base).is_none();
        let wanted = [Some(self.program()), self.adjoint.map(|_| adjoint::PROGRAM)];
        if let Some(program) = wanted.into_iter().flatten().find(missing) {
            return Err(format!(
                "[solver.openfoam] {program} is not there: install OpenFOAM (sudo apt install openfoam), or give program with its folder"
            ));
        }
        self.adjoint.map_or(Ok(()), |_| adjoint::check(&self.flow))
    }

    fn fields(&self) -> Option<Vec<FieldName>> {
        let of_adjoint = adjoint::FIELDS.map(|(name, kind)| (name, kind.values()));
        let of_adjoint = of_adjoint.into_iter().filter(|_| self.adjoint.is_some());
        Some(
            FIELDS
                .into_iter()
                .chain(of_adjoint)
                .map(|(name, values)| FieldName { name: name.into(), values })
                .collect(),
        )
    }

    fn flow(&self) -> Option<GoalFlow> {
        self.adjoint?;
        let names = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect::<Vec<_>>();
        let of_adjoint = adjoint::FIELDS.map(|(name, _)| name);
        let (density, mu) = (self.flow.density(), Some(self.flow.viscosity()));
        Some(GoalFlow { density, mu, ..GoalFlow::incompressible(names(&["U", "p"]), names(&of_adjoint)) })
    }

    fn functionals(&self) -> Option<Vec<String>> {
        let of_adjoint = self.adjoint.map(|_| ADJOINT_STEPS);
        Some(FUNCTIONALS.into_iter().chain(of_adjoint).map(String::from).collect())
    }

    fn result(&self, data: &Dataset, folder: &Path) -> Result<Vec<PathBuf>, String> {
        let case = folder.join(CASE);
        // A folder by the slash at its end.
        formats::write(&case.join(""), data).map_err(|error| error.to_string())?;
        Ok(vec![case])
    }

    fn prepare(&self, job: &Job<'_>) -> Result<Vec<Call>, String> {
        let data = job.dataset()?;
        let (kinds, initial) = (self.kinds(&data)?, self.initial(&data)?);
        let case = job.folder.join(CASE);
        let kind_of = |reference: i32, _: &str| kinds.get(&reference).map_or("patch", |kind| kind.patch()).to_owned();
        let folder = case.join("constant/polyMesh");
        let patches = foam::write_poly_mesh(Team::alone(), &folder, &data, &kind_of, false);
        let patches = patches.map_err(|error| error.to_string())?;
        let time = case.join("0");
        std::fs::create_dir_all(&time).map_err(|error| format!("{}: {error}", time.display()))?;
        for (name, field) in ["p", "T", "U"].into_iter().zip(&initial) {
            let entries = |patch: &foam::Patch| (patch.name.clone(), self.flow.entries(name, kinds[&patch.reference]));
            let entries: Vec<_> = patches.iter().map(entries).collect();
            foam::write_cell_field(&time.join(name), field, data.cells(), &entries, false)
                .map_err(|error| error.to_string())?;
        }
        let patches: Vec<_> = patches.iter().map(|patch| (patch.name.clone(), kinds[&patch.reference])).collect();
        if self.adjoint.is_some() {
            for (name, kind) in adjoint::FIELDS {
                let before = data.fields.iter().find(|field| field.name == name && field.kind == kind);
                let cells = |field: &NamedField| data.vertices_to_cells(Team::alone(), &field.values, kind.values());
                adjoint::begin(&case, data.cells(), &patches, (name, kind), before.map(cells))?;
            }
        }
        dictionaries::write_constant(&case, &self.flow, self.method())?;
        let plan = self.plan(self.walls(&data)?, patches, data.fields.is_empty(), job.base);
        let text = serde_json::to_string_pretty(&plan).map_err(|error| error.to_string())?;
        std::fs::write(case.join(PLAN), text).map_err(|error| format!("{}: {error}", case.join(PLAN).display()))?;
        let own = std::env::current_exe().map_err(|error| format!("this program's own file: {error}"))?;
        let words = vec![own.to_string_lossy().into_owned(), "openfoam".into(), case.to_string_lossy().into_owned()];
        Ok(vec![Call { words, env: Vec::new(), folder: job.folder.to_owned() }])
    }

    fn collect(&self, job: &Job<'_>) -> Result<Solved, String> {
        let case = job.folder.join(CASE);
        let path = case.join(RESULT);
        let named = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
        let text = std::fs::read_to_string(&path).map_err(|error| named(&error))?;
        let outcome: Outcome = serde_json::from_str(&text).map_err(|error| named(&error))?;
        let data = job.dataset()?;
        let still = if self.flow.reynolds.is_some() { self.walls(&data)? } else { Vec::new() };
        let mut fields = fields(&self.flow, &data, &still, &outcome.fields(&case)?)?;
        if self.adjoint.is_some() {
            let time = adjoint::fields(&case)?;
            for (name, _) in adjoint::FIELDS {
                fields.push(at_vertices(&data, &time, name)?);
            }
        }
        let Coefficients { lift, drag } = outcome.coefficients;
        let steps = outcome.steps as f64;
        let functionals = FUNCTIONALS.into_iter().zip([lift, drag, steps, outcome.change]);
        let of_adjoint = outcome.adjoint.map(|made| (ADJOINT_STEPS, made as f64));
        let functionals = functionals.chain(of_adjoint).map(|(name, value)| (name.to_owned(), value)).collect();
        Ok(Solved { fields, functionals })
    }
}

/// A field of the cells, at the vertices.
fn at_vertices(data: &Dataset, time: &Path, name: &str) -> Result<NamedField, String> {
    let path = time.join(name);
    let read = foam::read_cell_field(&path, data.cells()).map_err(|error| error.to_string())?;
    let CellField { kind, values } = read.map_err(|class| format!("{}: a {class}", path.display()))?;
    let values = data.cells_to_vertices(Team::alone(), values, kind.values());
    Ok(NamedField { name: name.to_owned(), kind, values })
}

/// Pressure, temperature, velocity, density and Mach number at the vertices; on surfaces of the references `still` nothing moves.
fn fields(flow: &Flow, data: &Dataset, still: &[i32], time: &Path) -> Result<Vec<NamedField>, String> {
    let read = |name: &str| at_vertices(data, time, name);
    let (p, t, mut u) = (read("p")?, read("T")?, read("U")?);
    for (nodes, _) in data.mesh.triangles.iter().filter(|(_, reference)| still.contains(reference)) {
        nodes.into_iter().for_each(|v| u.values[3 * v as usize..][..3].fill(0.0));
    }
    let scalar = |name: &str, values| NamedField { name: name.to_owned(), kind: FieldKind::Scalar, values };
    let density = p.values.iter().zip(&t.values).map(|(p, t)| p / (flow.r() * t)).collect();
    let speed = u.values.chunks_exact(3).map(|u| (u[0] * u[0] + u[1] * u[1] + u[2] * u[2]).sqrt());
    let mach = speed.zip(&t.values).map(|(speed, t)| speed / (flow.gamma * flow.r() * t).sqrt()).collect();
    let (rho, mach) = (scalar("rho", density), scalar("Mach", mach));
    Ok(vec![p, t, u, rho, mach])
}
