//! The metric of a stage: the source's, with sizes no less than a share of those that the mesh has.
//!
//! Where a layer is to be hundreds of times thinner than the cells, all edges of a tetrahedron are too long, those along the layer too. All
//! are split, and later most of the new vertices are collapsed again. So the mesh comes to such a metric in stages.
use super::context::Context;
use super::ids::{EDGE, TetId, VertexId};
use super::{fill, measure};
use crate::mesh::adjacency::MatchedFaces;
use crate::mesh::vector::{Vec3, sub};
use crate::mesh::{Elements, TetMesh};
use crate::metric::implied::implied;
use crate::metric::{Background, Sym3};
use crate::tasks::{GRAIN, Team};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// Where ln M changes by no more than this in any term, sizes are the same to a twentieth.
const SAME: f64 = 0.1;

/// The metric of a stage, before it is begun.
pub struct Stage {
    mesh: TetMesh,
    logs: Vec<Sym3>,
    /// Complexity of the stage's metric on the mesh.
    pub complexity: f64,
    /// Complexity of the metric that the stages go to, the source's or a coarser one, by its values at the vertices.
    pub wanted: f64,
}

impl Context<'_> {
    /// ln M at a point: of the stage, where one is on, else of the source. The search begins at `hint`.
    #[inline]
    pub fn log_at(&self, p: Vec3, hint: &mut u32) -> Sym3 {
        match &self.stage {
            None => self.source.log_at(p, hint),
            Some(stage) => stage.log_at(p, hint),
        }
    }

    /// Whether an edge is longer than `limit` in the metric of one of its ends.
    pub fn has_edge_longer(&self, team: Team<'_>, limit: f64) -> bool {
        let (store, square) = (&self.store, limit * limit);
        let has_one = |t: TetId| {
            let vertices = store.vertices(t);
            let (points, metrics) = (vertices.map(|v| store.position(v)), vertices.map(|v| store.metric(v)));
            EDGE.iter().any(|&[a, b]| {
                let edge = sub(points[b], points[a]);
                metrics[a].quadratic(edge).max(metrics[b].quadratic(edge)) > square
            })
        };
        team.chunks(GRAIN, store.tet_bound(), |range| store.live_tets_in(range).any(has_one)).contains(&true)
    }

    /// The stage that brings the mesh, which has the source's metric, nearer to M, the same with sizes `coarser` times as large: at each vertex
    /// (M⁻¹ ∩ r⁻² M̄⁻¹)⁻¹, where M̄ is the metric that the mesh implies. So in no direction are sizes less than the mesh's by more than r:
    /// `factor` beyond the direction that has to shrink least. That one needs no stage, since a mesh whose edges are all too long alike is
    /// halved without harm. None for a mesh that implies no metric.
    pub fn stage(&self, team: Team<'_>, factor: f64, coarser: f64) -> Option<Stage> {
        let store = &self.store;
        let vertices = team.map(GRAIN, store.vertex_bound(), |v| store.position(VertexId(v as u32)));
        let tets = team.collect(GRAIN, store.tet_bound(), |range, tets| {
            tets.extend(store.live_tets_in(range).map(|t| store.vertices(t).map(|v| v.0)));
        });
        let mesh = TetMesh { vertices, tets: Elements { nodes: tets, refs: Vec::new() }, ..TetMesh::default() };
        let implied = implied(team, &mesh)?;
        let logs = team.map(GRAIN / 4, mesh.vertices.len(), |v| {
            let (id, implied) = (VertexId(v as u32), &implied.logs[v]);
            if !store.is_vertex(id) {
                return Sym3::ZERO;
            }
            let inverse = store.log(id).times(-1.0).plus_identity(2.0 * coarser.ln());
            // The greatest eigenvalue of M⁻¹ in the mesh's metric is right to rounding, whatever the anisotropy of both.
            let [.., greatest] = inverse.exp().congruent(&implied.times(0.5).exp()).eigen().values;
            let least = implied.plus_identity(2.0 * factor.ln() + (-greatest.ln()).max(0.0));
            inverse.intersect_logs(&least.times(-1.0)).times(-1.0)
        });
        let complexity = measure::complexity(team, store, 1, |v| logs[v.index()].trace());
        let wanted = measure::complexity(team, store, 1, |v| store.log(v).trace()) / coarser.powi(3);
        Some(Stage { mesh, logs, complexity, wanted })
    }

    /// Begins a stage: the mesh as it is now becomes its background.
    pub fn begin_stage(&mut self, team: Team<'_>, Stage { mesh, logs, .. }: Stage) {
        let holders: Vec<_> = mesh.vertices.iter().map(|_| AtomicU32::new(u32::MAX)).collect();
        team.for_each(GRAIN, mesh.tets.len(), |range| {
            for t in range {
                mesh.tets.nodes[t].iter().for_each(|&v| {
                    holders[v as usize].fetch_min(t as u32, Relaxed);
                });
            }
        });
        self.set_metrics(team, |v, hint| {
            *hint = holders[v.index()].load(Relaxed);
            logs[v.index()]
        });
        let faces = MatchedFaces::of(team, &mesh.tets.nodes);
        self.stage = Some(Box::new(Background::on(team, Arc::new(mesh), faces, logs)));
    }

    /// Ends a stage: the mesh has the source's metric again.
    pub fn end_stage(&mut self, team: Team<'_>) {
        self.stage = None;
        self.set_metrics(team, |v, hint| self.source.log_at(self.store.position(v), hint));
    }

    /// Gives all vertices another metric. Tetrahedra where it differs by more than [`SAME`] count as changed.
    fn set_metrics(&self, team: Team<'_>, log_of: impl Fn(VertexId, &mut u32) -> Sym3 + Sync) {
        let store = &self.store;
        store.tick();
        let changed = team.chunks(GRAIN, store.vertex_bound(), |range| {
            // Vertices with neighbouring ids mostly lie near each other.
            let mut hint = 0;
            let mut set = |v: VertexId| {
                let (before, log) = (store.log(v), log_of(v, &mut hint));
                store.set_metric(v, &log, &log.exp());
                store.set_hint(v, hint);
                before.0.iter().zip(log.0).any(|(before, log)| (before - log).abs() > SAME)
            };
            range.map(|v| VertexId(v as u32)).map(|v| store.is_vertex(v) && set(v)).collect::<Vec<_>>()
        });
        let changed = changed.concat();
        team.for_each(GRAIN, store.tet_bound(), |range| {
            let of = |t: &TetId| store.vertices(*t).iter().any(|v| changed[v.index()]);
            store.live_tets_in(range).filter(of).for_each(|t| store.touch(t));
        });
        fill::measure(team, store);
    }
}
