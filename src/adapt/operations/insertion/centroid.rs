//! Point creation at centroids (Tsolakis 2021, 3.2.1 and figure 8). A tetrahedron with an edge that is too long proposes its
//! centroid. If that encroaches upon a surface triangle or a ridge of it, these propose instead, as in constrained Delaunay refinement
//! (Shewchuk 1998, Tetrahedral mesh generation by Delaunay refinement).
//!
//! The dissertation collects the candidates of all tetrahedra, drops those too near to each other, and then inserts. Here a candidate is
//! checked and inserted in one operation. It lies in the tetrahedron that is claimed, so it needs no location; the candidates before it
//! are vertices of the mesh by now, so one test of nearness serves for both. A tetrahedron made in this sweep proposes nothing: flips
//! come first.
use crate::adapt::core::access::Access;
use crate::adapt::core::context::Context;
use crate::adapt::core::edge_list::EdgeItem;
use crate::adapt::core::ids::{EDGE, FACE, TetId, VertexId};
use crate::adapt::core::refusal::Refusal;
use crate::adapt::core::star::Seed;
use crate::adapt::core::vertex_moves::Placed;
use crate::adapt::core::worker::Worker;
use crate::adapt::schedule::Operation;
use crate::geometry::Entity;
use crate::mesh::vector::{Vec3, add, dot, scale, sub};
use crate::metric::Sym3;
use crate::metric::quality::edge_length;
use crate::tasks::{GRAIN, Team};
use serde::Serialize;

/// Where refinement puts new vertices.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum PointCreation {
    /// At the metric middle of long edges.
    #[default]
    Edge,
    /// At centroids of tetrahedra and surface triangles with long edges; at middles of edges where these fail.
    Centroid,
    /// Inside at unit distance from vertices along the eigenvectors of their metrics; at middles of edges on the model, where they are
    /// much too long, and where these fail.
    Eigenvector,
}

impl PointCreation {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Edge, Self::Centroid, Self::Eigenvector];

    /// As the command line spells it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Edge => "edge",
            Self::Centroid => "centroid",
            Self::Eigenvector => "eigenvector",
        }
    }
}

/// A point that may become a vertex.
pub struct Candidate<'a> {
    pub seed: Seed,
    pub entity: Entity,
    pub point: Vec3,
    pub metric: Sym3,
    /// The vertices it was found from.
    pub around: &'a [VertexId],
}

/// The tetrahedra with an edge that is too long: those at the surface first, then by their longest edge.
pub fn active_tets(team: Team<'_>, context: &Context<'_>) -> Vec<TetId> {
    let store = &context.store;
    let mut found = team.collect(GRAIN, store.tet_bound(), |range, found| {
        for t in store.live_tets_in(range) {
            let v = store.vertices(t);
            let (p, m) = (v.map(|x| store.position(x)), v.map(|x| store.metric(x)));
            let lengths = EDGE.map(|[i, j]| edge_length(sub(p[j], p[i]), &m[i], &m[j]));
            let longest = lengths.into_iter().fold(0.0, f64::max);
            if longest > context.limits.long {
                found.push((store.tags(t) == [0; 4], longest, t));
            }
        }
    });
    team.sort_by(&mut found, |x, y| x.0.cmp(&y.0).then(y.1.total_cmp(&x.1)).then(x.2.cmp(&y.2)));
    team.map(GRAIN, found.len(), |i| found[i].2)
}

/// Whether p lies inside the smallest ellipsoid (a sphere in the metric) through the ends of the segment.
fn encroaches_edge(m: &Sym3, [a, b]: [Vec3; 2], p: Vec3) -> bool {
    dot(m.apply(sub(a, p)), sub(b, p)) < 0.0
}

/// Whether p lies inside the smallest ellipsoid (a sphere in the metric, its centre in the triangle's plane) through the corners.
pub fn encroaches_face(m: &Sym3, [a, b, c]: [Vec3; 3], p: Vec3) -> bool {
    let (e, f) = (sub(b, a), sub(c, a));
    let (ee, ef, ff) = (m.quadratic(e), dot(m.apply(e), f), m.quadratic(f));
    let twice = 2.0 * (ee * ff - ef * ef);
    // The centre from a: ⟨e, centre⟩ = ⟨e, e⟩/2, ⟨f, centre⟩ = ⟨f, f⟩/2.
    let centre = add(scale(e, ff * (ee - ef) / twice), scale(f, ee * (ff - ef) / twice));
    m.quadratic(sub(sub(p, a), centre)) < m.quadratic(centre)
}

/// Mean of points.
fn centroid<const N: usize>(points: [Vec3; N]) -> Vec3 {
    scale(points.into_iter().fold([0.0; 3], add), 1.0 / N as f64)
}

/// Refines tetrahedra at their centroids.
pub struct InsertCentroids;

impl Operation for InsertCentroids {
    type Item = TetId;
    type Scratch = ();
    const WHOLE_BALLS: bool = false;

    fn attempt<A: Access>(
        &self,
        worker: &mut Worker<'_, '_, A>,
        _scratch: &mut (),
        item: TetId,
    ) -> Result<(), Refusal> {
        worker.refine_tet(item)
    }
}

impl<A: Access> Worker<'_, '_, A> {
    /// Refines a tetrahedron that has an edge that is too long: at its centroid, or at a surface triangle or ridge that this encroaches upon.
    ///
    /// # Errors
    /// `Stale` when no edge is too long or the tetrahedron was made in this sweep, `Length` when all candidates are too near to
    /// vertices, else the refusal of the last insertion.
    pub fn refine_tet(&mut self, t: TetId) -> Result<(), Refusal> {
        let v = self.claim_current_tet(t)?;
        if self.store.stamp(t) == self.store.clock() || !EDGE.iter().any(|&[i, j]| self.is_long(v[i], v[j])) {
            return Err(Refusal::Stale);
        }
        let points = v.map(|x| self.store.position(x));
        let (point, metric) = (centroid(points), self.mean_metric(v));
        let mut result = None;
        let tags = self.store.tags(t);
        for i in (0..4).filter(|&i| tags[i] != 0) {
            // The insertion before may have replaced the tetrahedron, and this face with it.
            if self.store.unlocked_vertices(t) != v {
                break;
            }
            if encroaches_face(&metric, FACE[i].map(|k| points[k]), point) {
                result = better(result, self.refine_face(t, i));
            }
        }
        if result.is_none() {
            let ridges = EDGE.map(|[i, j]| [v[i], v[j]]);
            result = self.split_encroached(&metric, &ridges, point, t);
        }
        result.unwrap_or_else(|| {
            let candidate = Candidate { seed: Seed::Inside, entity: Entity::Interior, point, metric, around: &v };
            self.insert_if_spaced(&candidate, &[t])
        })
    }

    /// Candidates of the surface triangle opposite local vertex i of a claimed tetrahedron; none when no edge of it is too long.
    fn refine_face(&mut self, t: TetId, i: usize) -> Option<Result<(), Refusal>> {
        let (vertices, tag) = (self.store.vertices(t), self.store.tags(t)[i]);
        let face = FACE[i].map(|k| vertices[k]);
        let edges = [[face[0], face[1]], [face[1], face[2]], [face[2], face[0]]];
        let long = edges.map(|[a, b]| self.is_long(a, b));
        if long != [true; 3] {
            let long = edges.into_iter().zip(long).filter(|&(_, long)| long);
            return long
                .fold(None, |result, ([a, b], _)| better(result, Some(self.split_edge(EdgeItem { a, b, tet: t }))));
        }
        if edges.iter().all(|&[a, b]| self.context.required.has_edge(a, b)) {
            // A required triangle proposes nothing: it stays as it is.
            return None;
        }
        let (point, metric) = (centroid(face.map(|x| self.store.position(x))), self.mean_metric(face));
        let split = self.split_encroached(&metric, &edges, point, t);
        Some(split.unwrap_or_else(|| {
            let (seed, entity) = (Seed::Face(face), Entity::Face(tag - 1));
            let seeds = [t, self.store.neighbour(t, i)];
            let seeds = if seeds[1].is_some() { &seeds[..] } else { &seeds[..1] };
            self.insert_if_spaced(&Candidate { seed, entity, point, metric, around: &face }, seeds)
        }))
    }

    /// Splits the edges that are ridges, too long, and encroached upon by the point; none when there is no such edge.
    fn split_encroached(
        &mut self,
        metric: &Sym3,
        edges: &[[VertexId; 2]],
        point: Vec3,
        tet: TetId,
    ) -> Option<Result<(), Refusal>> {
        let mut result = None;
        for &[a, b] in edges {
            let ends = [a, b].map(|x| self.store.position(x));
            if self.store.ridge_curve(a, b).is_some() && self.is_long(a, b) && encroaches_edge(metric, ends, point) {
                result = better(result, Some(self.split_edge(EdgeItem { a, b, tet })));
            }
        }
        result
    }

    /// Inserts a candidate into the tetrahedra that hold it, unless it is too near to a vertex.
    pub fn insert_if_spaced(&mut self, candidate: &Candidate, seeds: &[TetId]) -> Result<(), Refusal> {
        let &Candidate { seed, entity, point, around, .. } = candidate;
        for &t in seeds {
            self.claim_tet(t)?;
        }
        if self.is_near(candidate, seeds)? {
            return Err(Refusal::Length);
        }
        let placed = self.place(entity, point, around);
        let result = self.insert(seed, seeds, placed, (around[0], VertexId::NONE));
        if matches!(result, Err(Refusal::Inverted | Refusal::Topology)) && placed.point != point {
            // As in split_at: there is no room on the model yet.
            let v = self.insert(seed, seeds, Placed { point, ..placed }, (around[0], VertexId::NONE))?;
            self.state.unprojected.push(v);
            return Ok(());
        }
        result.map(|_| ())
    }

    /// Whether the candidate is too near to a vertex of its tetrahedra or of their neighbours: collapse would remove it again.
    fn is_near(&mut self, candidate: &Candidate, tets: &[TetId]) -> Result<bool, Refusal> {
        for &t in tets {
            if self.is_near_any(candidate, &self.store.vertices(t)) {
                return Ok(true);
            }
            for n in self.store.neighbours(t).into_iter().filter(|n| n.is_some()) {
                let vertices = self.claim_tet(n)?;
                if self.is_near_any(candidate, &vertices) {
                    return Ok(true);
                }
            }
        }
        Ok(false)
    }

    pub fn is_near_any(&self, candidate: &Candidate, vertices: &[VertexId]) -> bool {
        let to = |v: VertexId| sub(self.store.position(v), candidate.point);
        let length = |v: VertexId| edge_length(to(v), &candidate.metric, &self.store.metric(v));
        vertices.iter().any(|&v| length(v) < self.context.limits.short)
    }

    fn is_long(&self, a: VertexId, b: VertexId) -> bool {
        self.length(a, b) > self.context.limits.long
    }

    /// The metric at the centroid of the vertices.
    fn mean_metric<const N: usize>(&self, vertices: [VertexId; N]) -> Sym3 {
        let logs = vertices.map(|v| self.store.log(v));
        Sym3(std::array::from_fn(|k| logs.iter().map(|log| log.0[k]).sum::<f64>() / N as f64)).exp()
    }
}

/// The result of several candidates: success if one was inserted; else a conflict, so that the item is tried again, if there was one.
pub fn better(one: Option<Result<(), Refusal>>, other: Option<Result<(), Refusal>>) -> Option<Result<(), Refusal>> {
    match (one, other) {
        (Some(Ok(())), _) | (_, None) => one,
        (Some(Err(Refusal::Conflict)), Some(Err(_))) => one,
        (_, other) => other,
    }
}

#[cfg(test)]
mod tests;
