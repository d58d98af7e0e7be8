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
use crate::tasks::{Rows, Team};
use std::borrow::Cow;

/// Marks a vertex inside.
pub const INSIDE: u32 = u32::MAX;

/// Marks a vertex that stays: on a vertex or an edge of the model, required, or beside something required.
pub const FIXED: u32 = u32::MAX - 1;

/// The mesh as plain arrays. The first level borrows those of the input.
pub struct Level<'m> {
    /// Positions.
    pub points: Cow<'m, [Vec3]>,
    /// ln M.
    pub logs: Cow<'m, [Sym3]>,
    /// M.
    pub metrics: Vec<Sym3>,
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
    /// Lists the tetrahedra at each of so many vertices.
    pub fn of<const N: usize>(elements: &[[u32; N]], vertices: usize) -> Self {
        Self(Rows::at_nodes(Team::alone(), elements, vertices))
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
    pub fn of(mesh: &'m TetMesh, place: &'m Classification, logs: Cow<'m, [Sym3]>, required: &Required) -> Self {
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
            metrics: logs.iter().map(Sym3::exp).collect(),
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
    pub fn balls(&self) -> Balls {
        Balls::of(&self.tets, self.points.len())
    }

    /// The level after one round.
    pub fn coarser(self, team: Team<'_>, balls: &Balls) -> Self {
        let surface = Surface::of(&self);
        let mut map = VertexMap::of(&self, balls, &surface);
        let mut repair = MapRepair::of(&self, balls, &surface);
        repair.repair(&mut map);
        while apart::keep(team, &self, &surface, &mut map) {
            repair.repair(&mut map);
        }
        self.mapped(&map)
    }

    /// What is left when vertices have gone onto others.
    fn mapped(self, map: &VertexMap) -> Self {
        let stays: Vec<u32> = (0..self.points.len() as u32).filter(|&v| map.target(v) == v).collect();
        let mut number = vec![u32::MAX; self.points.len()];
        stays.iter().zip(0..).for_each(|(&v, new)| number[v as usize] = new);
        let (mut tets, mut regions) = (Vec::new(), Vec::new());
        for (nodes, &region) in self.tets.iter().zip(&*self.regions) {
            let nodes = map.map(nodes);
            if is_proper(&nodes) {
                tets.push(nodes.map(|v| number[v as usize]));
                regions.push(region);
            }
        }
        let (mut triangles, mut triangle_origin) = (Vec::new(), Vec::new());
        for (nodes, &origin) in self.triangles.iter().zip(&self.triangle_origin) {
            let nodes = map.map(nodes);
            if is_proper(&nodes) {
                triangles.push(nodes.map(|v| number[v as usize]));
                triangle_origin.push(origin);
            }
        }
        Self {
            points: stays.iter().map(|&v| self.points[v as usize]).collect(),
            logs: stays.iter().map(|&v| self.logs[v as usize]).collect(),
            metrics: stays.iter().map(|&v| self.metrics[v as usize]).collect(),
            faces: stays.iter().map(|&v| self.faces[v as usize]).collect(),
            origin: stays.iter().map(|&v| self.origin[v as usize]).collect(),
            tets: Cow::Owned(tets),
            regions: Cow::Owned(regions),
            triangles: Cow::Owned(triangles),
            triangle_origin,
            of_face: self.of_face,
        }
    }

    /// Squares of the lengths of an edge in the metrics of its ends.
    #[inline(always)]
    pub fn squares(&self, a: u32, b: u32) -> [f64; 2] {
        let e = sub(self.points[b as usize], self.points[a as usize]);
        [a, b].map(|v| self.metrics[v as usize].quadratic(e))
    }
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
