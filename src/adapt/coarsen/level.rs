//! A mesh between two rounds of coarsening.
use super::apart;
use super::repair::MapRepair;
use super::surface::Surface;
use super::vertex_map::VertexMap;
use crate::adapt::core::ids::VertexId;
use crate::adapt::core::required::Required;
use crate::geometry::Entity;
use crate::geometry::classify::Classification;
use crate::mesh::TetMesh;
use crate::mesh::vector::{Vec3, sub};
use crate::metric::Sym3;
use crate::tasks::{GRAIN, Rows, Team};
use std::borrow::Cow;

/// Marks a vertex inside.
pub const INSIDE: u32 = u32::MAX;

/// Marks a vertex that stays: on a vertex or an edge of the model, required, or beside something required.
pub const FIXED: u32 = u32::MAX - 1;

/// What lengths of edges need of a vertex.
#[derive(Clone, Copy)]
pub struct Corner {
    /// Its position.
    pub point: Vec3,
    /// M.
    metric: Sym3,
}

/// The mesh as plain arrays. The first level borrows those of the input.
pub struct Level<'m> {
    /// Positions.
    pub points: Cow<'m, [Vec3]>,
    /// ln M.
    pub logs: Cow<'m, [Sym3]>,
    /// Positions once more, beside M: a length waits for one place in memory, not for two.
    pub corners: Vec<Corner>,
    /// For each vertex the model face that it lies on, [`INSIDE`] or [`FIXED`].
    pub faces: Vec<u32>,
    /// For each vertex its number in the input.
    pub origin: Vec<u32>,
    /// Vertices of the tetrahedra.
    pub tets: Cow<'m, [[u32; 4]]>,
    /// Their regions.
    pub regions: Cow<'m, [i32]>,
    /// Vertices of the triangles.
    pub triangles: Cow<'m, [[u32; 3]]>,
    /// For each triangle the number of the input's triangle that became it.
    pub triangle_origin: Vec<u32>,
    /// The model faces of the input's triangles.
    pub of_face: &'m [u32],
}

/// The tetrahedra at each vertex.
pub struct Balls(Rows);

impl Balls {
    /// Lists the elements at each of so many vertices.
    pub fn of<const N: usize>(team: Team<'_>, elements: &[[u32; N]], vertices: usize) -> Self {
        Self(Rows::at_nodes(team, elements, vertices))
    }

    /// The tetrahedra at a vertex.
    #[inline(always)]
    pub fn at(&self, v: u32) -> &[u32] {
        self.0.row(v as usize)
    }

    /// One of the tetrahedra at each vertex, 0 where there is none.
    pub fn firsts(&self) -> Vec<u32> {
        (0..self.0.len()).map(|v| self.0.row(v).first().copied().unwrap_or(0)).collect()
    }
}

impl<'m> Level<'m> {
    /// The first level: the input.
    pub fn of(
        team: Team<'_>,
        mesh: &'m TetMesh,
        place: &'m Classification,
        logs: Cow<'m, [Sym3]>,
        required: &Required,
    ) -> Self {
        let mut faces: Vec<u32> = place
            .entities
            .iter()
            .map(|entity| match *entity {
                Entity::Interior => INSIDE,
                Entity::Face(face) => face,
                _ => FIXED,
            })
            .collect();
        required.frozen().for_each(|v: VertexId| faces[v.index()] = FIXED);
        if required.frozen().next().is_some() {
            // Tetrahedra at an edge that may be required keep all of their vertices.
            let frozen = |v: &u32| required.is_frozen(VertexId(*v));
            let near = mesh.tets.nodes.iter().filter(|nodes| nodes.iter().copied().filter(|v| frozen(v)).count() > 1);
            near.flatten().for_each(|&v| faces[v as usize] = FIXED);
        }
        Self {
            points: Cow::Borrowed(&mesh.vertices),
            corners: team.map(GRAIN, logs.len(), |v| Corner { point: mesh.vertices[v], metric: logs[v].exp() }),
            logs,
            faces,
            origin: (0..mesh.vertices.len() as u32).collect(),
            tets: Cow::Borrowed(&mesh.tets.nodes),
            regions: Cow::Borrowed(&mesh.tets.refs),
            triangles: Cow::Borrowed(&mesh.triangles.nodes),
            triangle_origin: (0..mesh.triangles.len() as u32).collect(),
            of_face: &place.faces,
        }
    }

    /// The tetrahedra at each vertex.
    pub fn balls(&self, team: Team<'_>) -> Balls {
        Balls::of(team, &self.tets, self.points.len())
    }

    /// The level after one round.
    pub fn coarser(self, team: Team<'_>, balls: &Balls) -> Self {
        let surface = Surface::of(team, &self);
        let map = VertexMap::of(team, &self, balls, &surface);
        let repair = MapRepair::of(team, &self, balls, &surface, &map);
        repair.repair();
        while apart::keep(team, &self, &surface, &map) {
            repair.repair();
        }
        self.mapped(team, &map)
    }

    /// What is left when vertices have gone onto others.
    fn mapped(self, team: Team<'_>, map: &VertexMap) -> Self {
        let stays = team.collect(GRAIN, self.points.len(), |range, stays| {
            stays.extend((range.start as u32..range.end as u32).filter(|&v| map.target(v) == v));
        });
        let mut number = vec![u32::MAX; self.points.len()];
        stays.iter().zip(0..).for_each(|(&v, new)| number[v as usize] = new);
        let (tets, triangles) = (map.left(team, &self.tets), map.left(team, &self.triangles));
        Self {
            points: Cow::Owned(of_those(team, &stays, &self.points)),
            logs: Cow::Owned(of_those(team, &stays, &self.logs)),
            corners: of_those(team, &stays, &self.corners),
            faces: of_those(team, &stays, &self.faces),
            origin: of_those(team, &stays, &self.origin),
            tets: Cow::Owned(renumbered(team, map, &number, &tets, &self.tets)),
            regions: Cow::Owned(of_those(team, &tets, &self.regions)),
            triangles: Cow::Owned(renumbered(team, map, &number, &triangles, &self.triangles)),
            triangle_origin: of_those(team, &triangles, &self.triangle_origin),
            of_face: self.of_face,
        }
    }

    /// Squares of the lengths of an edge in the metrics of its ends.
    #[inline(always)]
    pub fn squares(&self, a: u32, b: u32) -> [f64; 2] {
        squares(&self.corners[a as usize], &self.corners[b as usize])
    }
}

/// As [`Level::squares`].
#[inline(always)]
pub fn squares(a: &Corner, b: &Corner) -> [f64; 2] {
    let e = sub(b.point, a.point);
    [a.metric.quadratic(e), b.metric.quadratic(e)]
}

/// The values of those of these numbers.
fn of_those<T: Copy + Send + Sync>(team: Team<'_>, those: &[u32], values: &[T]) -> Vec<T> {
    team.map(GRAIN, those.len(), |at| values[those[at] as usize])
}

/// The elements of these numbers, with the new numbers of the targets of their vertices.
fn renumbered<const N: usize>(
    team: Team<'_>,
    map: &VertexMap,
    number: &[u32],
    those: &[u32],
    elements: &[[u32; N]],
) -> Vec<[u32; N]> {
    team.map(GRAIN, those.len(), |at| map.map(&elements[those[at] as usize]).map(|v| number[v as usize]))
}

/// Whether no two nodes are the same.
#[inline(always)]
pub fn is_proper<const N: usize>(nodes: &[u32; N]) -> bool {
    let mut same = false;
    for i in 1..N {
        for j in 0..i {
            same |= nodes[i] == nodes[j];
        }
    }
    !same
}
