//! Prisms, pyramids and hexahedra of the mesh: they stay, and what is done is done to the tetrahedra beside them.
use super::input::{Error, Given, InputArguments, OnModel};
use super::report::Report;
use super::source::On;
use crate::adapt::beside::Beside;
use crate::cli::table::{Table, place};
use crate::geometry::Model;
use crate::geometry::classify::Classification;
use crate::mesh::TetMesh;
use crate::mesh::adjacency::MatchedFaces;
use crate::mesh::split_nonmanifold::split_nonmanifold;
use crate::mesh::stack::{Kind, Outside, Stack};
use crate::metric::Source;
use crate::metric::frozen::Fitted;
use crate::sizing;
use crate::tasks::Team;
use serde::Serialize;
use std::sync::Arc;

/// How sizes grow from the stack where no gradation is asked for.
const GROWTH: f64 = 1.5;

/// What stayed as it is.
#[derive(Serialize)]
pub struct Kept {
    pyramids: usize,
    prisms: usize,
    hexahedra: usize,
    /// Triangles between them and the tetrahedra.
    triangles: usize,
    #[serde(skip)]
    told: String,
    /// How the metric was fitted to these.
    metric: Option<Fitted>,
}

impl Kept {
    /// What the table says of it.
    pub fn row(&self, table: &mut Table) {
        let Self { told, triangles, .. } = self;
        table.row(
            "kept as they are",
            format_args!("{told}, {triangles} triangles towards the tetrahedra; figures are of these"),
        );
        if let Some(Fitted { vertices, coarser, finer }) = self.metric {
            table.row(
                "metric fitted to them",
                format_args!(
                    "{vertices} vertices; beside them larger sizes at {coarser} vertices, smaller ones at {finer}"
                ),
            );
        }
    }
}

impl Given {
    /// Refuses a stack, for which this command or way of working is not made.
    pub fn without_stack(self, path: &std::path::Path, what: &str) -> Result<Self, Error> {
        if self.stack.is_empty() {
            return Ok(self);
        }
        let (path, told) = (path.display(), self.stack.told());
        Err(format!(
            "{path}: the mesh has {told}, which {what} does not keep: use `geo-adapt adapt` in one process without --memory, or split them by \
             `geo-adapt convert --split`"
        )
        .into())
    }
}

impl InputArguments {
    /// The mesh of the tetrahedra beside a stack, of which the whole mesh is on its model.
    pub(super) fn beside(
        &self,
        team: Team<'_>,
        (stack, outside): (Stack, Outside),
        whole: TetMesh,
        on: Classification,
        model: &Model,
    ) -> Result<(TetMesh, Classification, Beside), Error> {
        let name = self.mesh.display();
        let (mut mesh, on, beside) = Beside::of(team, (stack, outside), whole, on, model);
        if mesh.tets.is_empty() {
            return Err(format!(
                "{name}: the mesh has {} alone, and no tetrahedra that could be adapted",
                beside.stack.told()
            )
            .into());
        }
        let faces = MatchedFaces::of(team, &mesh.tets.nodes);
        let copies = split_nonmanifold(team, &mut mesh, &faces).map_err(|error| format!("{name}: {error}"))?;
        match copies.iter().min() {
            None => Ok((mesh, on, beside)),
            Some(&first) => Err(format!(
                "{name}: beside the {} the tetrahedra hang together in edges or vertices alone, the first is vertex {} at {}; put tetrahedra or cells \
                 between",
                beside.stack.told(),
                first + 1,
                place(mesh.vertices[first as usize])
            )
            .into()),
        }
    }

    /// The metric fitted to the stack.
    pub(super) fn fitted(
        &self,
        team: Team<'_>,
        (mesh, on): (&Arc<TetMesh>, On<'_>),
        beside: &Beside,
        source: &Source,
    ) -> (Source, Fitted) {
        let (logs, fitted) = beside.fitted(team, mesh, source, self.multiscale.growth().unwrap_or(GROWTH));
        let faces = MatchedFaces::of(team, &mesh.tets.nodes);
        (Source::Background(sizing::background(team, (mesh, faces), (on.place, on.model), logs)), fitted)
    }
}

impl Report {
    /// Puts the stack and the mesh of the report together, which is measured before; `held` are the numbers of the vertices between both in this.
    pub fn rejoin(&mut self, team: Team<'_>, on: &OnModel, held: Option<&[u32]>) -> Result<(), Error> {
        let (Some(beside), Some(held)) = (&on.beside, held) else { return Ok(()) };
        self.measure(team, &on.model);
        let (rejoined, metrics) =
            beside.rejoin(team, (&self.mesh, &self.metrics), held).map_err(|error| error.to_string())?;
        self.off_model.iter_mut().for_each(|v| *v = rejoined.number[*v as usize]);
        let [pyramids, prisms, hexahedra] = Kind::ALL.map(|kind| rejoined.stack.cells_of(kind).count());
        let (triangles, told) = (beside.triangles(), rejoined.stack.told());
        self.kept = Some(Kept { pyramids, prisms, hexahedra, triangles, told, metric: on.how.fitted });
        (self.mesh, self.stack, self.metrics) = (rejoined.mesh, rejoined.stack, metrics);
        Ok(())
    }
}
