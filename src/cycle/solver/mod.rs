//! Who solves: one small trait, and those that are known.
pub mod analytic;
pub mod command;
mod handover;
pub mod named;
pub mod openfoam;
mod reference;
pub mod su2;

pub use super::data::{Call, FieldName, GoalFlow, Solved};

use crate::formats::{Dataset, NamedField};
use crate::geometry::{Names, names};
use crate::mesh::TetMesh;
use crate::mesh::io::{read_mesh, read_mesh_and_stack, read_solution};
use crate::mesh::stack::Stack;
use crate::tasks::Team;
use reference::Reference;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// The solver of a configuration: `[solver.analytic]`, `[solver.command]` and so on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Choice {
    /// An analytic function, to try the loop with nothing to install.
    Analytic(analytic::Config),
    /// Any program.
    Command(command::Config),
    /// One that the operator of a service has set up.
    Named(named::Config),
    /// SU2.
    Su2(su2::Config),
    /// OpenFOAM's rhoCentralFoam or rhoSimpleFoam.
    Openfoam(openfoam::Config),
}

impl Choice {
    /// The solver.
    pub fn solver(&self) -> &dyn Solver {
        match self {
            Self::Analytic(solver) => solver,
            Self::Command(solver) => solver,
            Self::Named(solver) => solver,
            Self::Su2(solver) => solver,
            Self::Openfoam(solver) => solver,
        }
    }
}

impl Choice {
    /// Whether it has coefficients without reference values.
    pub fn wants_reference(&self) -> bool {
        match self {
            Self::Openfoam(solver) => solver.flow.area.is_none() || solver.flow.length.is_none(),
            Self::Su2(solver) => solver.flow.as_ref().is_some_and(|flow| flow.area.is_none() || flow.length.is_none()),
            Self::Analytic(_) | Self::Command(_) | Self::Named(_) => false,
        }
    }

    /// The same with those of the walls of a mesh, where none are given; and a line that says which.
    pub fn referenced(&self, mesh: &TetMesh, names: &Names) -> (Self, String) {
        let mut choice = self.clone();
        let (walls, area, length) = match &mut choice {
            Self::Openfoam(solver) => (&solver.flow.walls, &mut solver.flow.area, &mut solver.flow.length),
            Self::Su2(su2::Config { flow: Some(flow), .. }) => (&flow.walls, &mut flow.area, &mut flow.length),
            _ => return (choice, String::new()),
        };
        let found = Reference::of(mesh, names, walls);
        let of = if found.is_some() { "of the walls of the first mesh" } else { "for the walls have none along z" };
        let found = found.unwrap_or(Reference { area: 1.0, length: 1.0 });
        let mut said = Vec::new();
        for (name, value, found, what) in
            [("area", area, found.area, "the planform"), ("length", length, found.length, "the mean aerodynamic chord")]
        {
            if value.is_none() {
                *value = Some(found);
                said.push(format!("reference {name} {found:.6} ({what} {of})"));
            }
        }
        (choice, format!("{}; give others in the flow of the configuration", said.join(", ")))
    }
}

/// A solver, as the loop sees it. Errors are messages that name file, place and remedy.
pub trait Solver {
    /// Refuses before the loop what would fail in it: a program or file that is not there. `base` is the folder of the configuration.
    ///
    /// # Errors
    /// What is missing, and how to get it.
    fn check(&self, base: &Path) -> Result<(), String>;

    /// Refuses before the loop prisms, pyramids and hexahedra of the first mesh that it could not be given.
    ///
    /// # Errors
    /// Why, and what to do.
    fn check_stack(&self, _stack: &Stack) -> Result<(), String> {
        Ok(())
    }

    /// Files besides mesh and model that a solve depends on, as far as they are known. `base` is as above.
    fn inputs(&self, _base: &Path) -> Vec<PathBuf> {
        Vec::new()
    }

    /// The fields that it gives, where that is known before it runs.
    fn fields(&self) -> Option<Vec<FieldName>> {
        None
    }

    /// The flow whose adjoint it gives beside its fields, as a goal has it without terms of its own.
    fn flow(&self) -> Option<GoalFlow> {
        None
    }

    /// The functionals that it tells, where that is known before it runs.
    fn functionals(&self) -> Option<Vec<String>> {
        None
    }

    /// Writes the last mesh and solution into a folder as the solver reads them, beside the mesh and solution of libMeshb that are there.
    /// The files, or folders.
    ///
    /// # Errors
    /// When something cannot be written.
    fn result(&self, _data: &Dataset, _folder: &Path) -> Result<Vec<PathBuf>, String> {
        Ok(Vec::new())
    }

    /// Writes what the programs need into the folder of the job; which programs to start, in their order.
    ///
    /// # Errors
    /// When something cannot be written, or an input cannot be used.
    fn prepare(&self, job: &Job<'_>) -> Result<Vec<Call>, String>;

    /// Reads what they wrote.
    ///
    /// # Errors
    /// When that is not there or not what it should be.
    fn collect(&self, job: &Job<'_>) -> Result<Solved, String>;
}

/// One solve. All paths are absolute.
pub struct Job<'a> {
    /// The folder of the step; everything of the solver goes in here.
    pub folder: &'a Path,
    /// The folder of the configuration.
    pub base: &'a Path,
    /// The cycle, from 1.
    pub cycle: u32,
    /// The mesh, .meshb; the names of its references may lie beside it (.names.json).
    pub mesh: &'a Path,
    /// The last solution on this mesh; none in the first cycle.
    pub before: Option<Before<'a>>,
    /// Threads to use.
    pub threads: usize,
    /// The options of our own subcommands that say the threads, if the configuration does.
    pub thread_words: &'a [String],
}

/// The solution of the cycle before, on this mesh.
pub struct Before<'a> {
    /// .solb.
    pub path: &'a Path,
    /// Its fields, in their order.
    pub fields: &'a [FieldName],
}

impl Job<'_> {
    /// The mesh alone; what is no tetrahedron is cut into such.
    ///
    /// # Errors
    /// When the file cannot be read.
    pub fn mesh(&self) -> Result<TetMesh, String> {
        read_mesh(self.mesh).map(|read| read.content).map_err(|error| error.to_string())
    }

    /// The mesh with its stack, the names of its references, and the fields of the solution before.
    ///
    /// # Errors
    /// When a file cannot be read.
    pub fn dataset(&self) -> Result<Dataset, String> {
        let read = read_mesh_and_stack(Team::alone(), self.mesh).map_err(|error| error.to_string())?;
        let (mesh, stack) = read.content;
        let names = names::read(self.mesh).map_err(|error| error.to_string())?;
        let mut fields = Vec::new();
        if let Some(Before { path, fields: named }) = &self.before {
            let read = read_solution(path).map_err(|error| error.to_string())?.content;
            fields = read
                .fields
                .into_iter()
                .zip(named.iter())
                .map(|(field, named)| NamedField { name: named.name.clone(), kind: field.kind, values: field.values })
                .collect();
        }
        Ok(Dataset { mesh, stack, names, fields })
    }
}
