//! Tetrahedra beside a stack of prisms, pyramids and hexahedra: they are adapted, and the stack stays as it is.
use super::core::fill;
use super::references::References;
use super::run::{Adapted, Options, Part, adapt_part};
use super::{Effort, Observer};
use crate::geometry::Model;
use crate::geometry::classify::Classification;
use crate::mesh::TetMesh;
use crate::mesh::adjacency::sorted2;
use crate::mesh::stack::{Error, Outside, Rejoined, Stack};
use crate::metric::frozen::{Fitted, fit};
use crate::metric::implied::implied;
use crate::metric::{Source, Sym3};
use crate::tasks::{GRAIN, Pool, Team};

/// A stack, and what joins the tetrahedra beside it to it.
pub struct Beside {
    /// The stack as it was read.
    pub stack: Stack,
    /// The whole mesh as it was placed on its model.
    whole: TetMesh,
    /// Its mesh was taken out.
    outside: Outside,
    /// The references of the whole mesh.
    refs: References,
}

impl Beside {
    /// The mesh of the tetrahedra beside a stack, of which the `whole` mesh was placed on its model, with its own place.
    pub fn of(
        team: Team<'_>,
        (stack, mut outside): (Stack, Outside),
        whole: TetMesh,
        place: Classification,
        model: &Model,
    ) -> (TetMesh, Classification, Self) {
        let refs = References::of(team, &whole, &place, model);
        let edges = outside.surface_edges();
        let place = Classification {
            faces: outside.placed.iter().map(|&t| place.faces[t as usize]).collect(),
            ridges: place.ridges.iter().copied().filter(|(nodes, _)| edges.contains(&sorted2(*nodes))).collect(),
            ..place
        };
        let mesh = std::mem::take(&mut outside.mesh);
        (mesh, place, Self { stack, whole, outside, refs })
    }

    /// The number of triangles between the tetrahedra and the stack.
    pub fn triangles(&self) -> usize {
        self.outside.interface.len()
    }

    /// ln M of a source, which lies on the mesh, at its vertices, fitted to the triangles of the stack: from there sizes change by the ratio from an edge to the
    /// next at most. An analytic field is taken at the vertices.
    pub fn fitted(&self, team: Team<'_>, mesh: &TetMesh, source: &Source, ratio: f64) -> (Vec<Sym3>, Fitted) {
        let mut logs = logs(team, mesh, source);
        let fitted = fit(team, mesh, &self.outside.interface, &mut logs, ratio);
        (logs, fitted)
    }

    /// Adapts the mesh as [`super::adapt`] does: the faces to the stack stay as they are.
    ///
    /// # Errors
    /// As there.
    #[allow(clippy::too_many_arguments)]
    pub fn adapt(
        &self,
        mesh: &TetMesh,
        place: &Classification,
        model: &Model,
        source: &Source,
        options: &Options,
        pool: &Pool,
        observer: &dyn Observer,
    ) -> Result<Adapted, fill::Error> {
        let team = Team::new(pool, options.plan);
        source.check(team, mesh)?;
        let logs = logs(team, mesh, source);
        let held = &self.outside.held;
        let part = Part { logs: &logs, held, triangles: &[], refs: &self.refs, effort: Effort::FULL };
        adapt_part(mesh, place, Some(part), model, source, options, pool, observer)
    }

    /// The adapted mesh and its metric with the stack as it was; `held` are the numbers that the vertices between both have now. At vertices within the
    /// stack the metric is that of its cells.
    ///
    /// # Errors
    /// Those of [`Stack::join`].
    pub fn rejoin(
        &self,
        team: Team<'_>,
        (adapted, metrics): (&TetMesh, &[Sym3]),
        held: &[u32],
    ) -> Result<(Rejoined, Vec<Sym3>), Error> {
        let rejoined = self.outside.rejoin(&self.stack, &self.whole, adapted, held)?;
        let mut pieces = TetMesh { vertices: rejoined.mesh.vertices.clone(), ..TetMesh::default() };
        pieces.tets.nodes = rejoined.mesh.tets.nodes[rejoined.stack.own()[0]..].to_vec();
        let within = implied(team, &pieces);
        let of_cells = |v: usize| within.as_ref().map_or(Sym3::IDENTITY, |within| within.logs[v].exp());
        let metric = |(v, from): (usize, &Option<u32>)| from.map_or_else(|| of_cells(v), |from| metrics[from as usize]);
        let metrics = rejoined.from.iter().enumerate().map(metric).collect();
        Ok((rejoined, metrics))
    }
}

/// ln M of a source at the vertices of a mesh.
fn logs(team: Team<'_>, mesh: &TetMesh, source: &Source) -> Vec<Sym3> {
    match source.logs_on(mesh) {
        Some(logs) => logs.to_vec(),
        None => team.map(GRAIN, mesh.vertices.len(), |v| source.log_at(mesh.vertices[v], &mut 0)),
    }
}
