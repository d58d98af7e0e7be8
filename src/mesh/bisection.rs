//! Bisection of marked edges: all elements at an edge are halved at its middle, so the mesh stays conforming.
//!
//! Each element is split by itself, at its marked edge that comes first in the list, and so are its halves. A face of two tetrahedra is
//! split by the order of its own edges alone, so both make the same triangles of it.
use super::adjacency::sorted2;
use super::vector::{Vec3, lerp};
use super::{Elements, TetMesh};
use crate::tasks::{GRAIN, Team};
use std::collections::HashMap;
use std::sync::Arc;

/// A mesh with vertices added in the middles of edges, after its own.
#[derive(Clone, Debug)]
pub struct Halved {
    /// The mesh.
    pub mesh: Arc<TetMesh>,
    /// For each vertex that was added the ends of its edge: vertices before it.
    pub parents: Vec<[u32; 2]>,
}

/// Edges to be halved, in an order.
pub struct MarkedEdges {
    numbers: HashMap<[u32; 2], u32>,
    is_end: Vec<bool>,
}

impl MarkedEdges {
    /// These edges, of a mesh of so many vertices; edge i gets the vertex `vertices` + i.
    pub fn new(edges: &[[u32; 2]], vertices: usize) -> Self {
        let mut is_end = vec![false; vertices];
        edges.iter().flatten().for_each(|&v| is_end[v as usize] = true);
        Self { numbers: edges.iter().map(|&[a, b]| sorted2([a, b])).zip(0..).collect(), is_end }
    }

    /// The number of an edge, if it is marked.
    pub fn number(&self, a: u32, b: u32) -> Option<u32> {
        let is_end = |v: u32| self.is_end.get(v as usize).is_some_and(|&is_end| is_end);
        if is_end(a) && is_end(b) { self.numbers.get(&sorted2([a, b])).copied() } else { None }
    }

    /// The elements after the bisection, each with the one that it is a part of. Parts keep their orientation.
    pub fn split<const N: usize>(&self, team: Team<'_>, elements: &[[u32; N]]) -> (Vec<[u32; N]>, Vec<u32>) {
        let parts = team.chunks(GRAIN, elements.len(), |range| {
            let (mut nodes, mut parents) = (Vec::with_capacity(range.len()), Vec::with_capacity(range.len()));
            let mut open = Vec::new();
            for parent in range {
                open.push(elements[parent]);
                while let Some(element) = open.pop() {
                    match self.first(&element) {
                        Some((i, j, middle)) => open.extend([j, i].map(|k| {
                            let mut half = element;
                            half[k] = middle;
                            half
                        })),
                        None => {
                            nodes.push(element);
                            parents.push(parent as u32);
                        }
                    }
                }
            }
            (nodes, parents)
        });
        let nodes = team.join_slices(parts.iter().map(|(nodes, _)| nodes.as_slice()));
        (nodes, team.join_slices(parts.iter().map(|(_, parents)| parents.as_slice())))
    }

    /// The marked edge of an element that comes first: its places, and the vertex in its middle.
    fn first<const N: usize>(&self, nodes: &[u32; N]) -> Option<(usize, usize, u32)> {
        let pairs = (0..N).flat_map(|i| (i + 1..N).map(move |j| (i, j)));
        let marked = pairs.filter_map(|(i, j)| Some((self.number(nodes[i], nodes[j])?, i, j)));
        marked.min().map(|(number, i, j)| (i, j, self.is_end.len() as u32 + number))
    }
}

/// Halves these edges of a mesh, each named once, in this order. Tags go to the parts; what is said of single vertices and of required
/// elements is dropped. Returns for each triangle the one that it is a part of.
pub fn bisect(team: Team<'_>, mesh: &mut TetMesh, edges: &[[u32; 2]]) -> (MarkedEdges, Vec<u32>) {
    let marked = MarkedEdges::new(edges, mesh.vertices.len());
    let at = |v: u32| mesh.vertices[v as usize];
    let middles: Vec<Vec3> = edges.iter().map(|&[a, b]| lerp(at(a), at(b), 0.5)).collect();
    let (triangles, parents) = split(team, &marked, &mesh.triangles);
    *mesh = TetMesh {
        vertices: [&mesh.vertices[..], &middles].concat(),
        vertex_refs: vec![0; mesh.vertices.len() + middles.len()],
        edges: split(team, &marked, &mesh.edges).0,
        triangles,
        tets: split(team, &marked, &mesh.tets).0,
        ..TetMesh::default()
    };
    (marked, parents)
}

fn split<const N: usize>(team: Team<'_>, marked: &MarkedEdges, of: &Elements<N>) -> (Elements<N>, Vec<u32>) {
    let (nodes, parents) = marked.split(team, &of.nodes);
    let refs = parents.iter().map(|&parent| of.refs[parent as usize]).collect();
    (Elements { nodes, refs }, parents)
}

#[cfg(test)]
mod tests {
    use super::super::samples::cube;
    use super::super::validity;
    use super::super::vector::volume6;
    use super::*;

    #[test]
    fn a_cube_stays_a_mesh_whatever_is_marked() {
        let mut seed = 7u64;
        let mut random = move |n: usize| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 33) as usize % n
        };
        let mut mesh = cube(3);
        for round in 0..6 {
            let mut edges: Vec<[u32; 2]> = mesh
                .tets
                .nodes
                .iter()
                .flat_map(|n| [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]].map(|[i, j]| sorted2([n[i], n[j]])))
                .collect();
            edges.sort_unstable();
            edges.dedup();
            // In any order.
            let marked: Vec<[u32; 2]> = (0..edges.len() / 7).map(|_| edges.swap_remove(random(edges.len()))).collect();
            let (vertices, triangles) = (mesh.vertices.len(), mesh.triangles.clone());
            let (_, parents) = bisect(Team::alone(), &mut mesh, &marked);
            assert_eq!(mesh.vertices.len(), vertices + marked.len(), "round {round}");
            let found = validity::check(&mesh);
            assert!(found.is_valid(), "{found:?}");
            let volume: f64 = mesh
                .tets
                .nodes
                .iter()
                .map(|n| {
                    let [a, b, c, d] = n.map(|v| mesh.vertices[v as usize]);
                    volume6(a, b, c, d) / 6.0
                })
                .sum();
            assert!((volume - 1.0).abs() < 1e-12);
            for (reference, parent) in mesh.triangles.refs.iter().zip(parents) {
                assert_eq!(*reference, triangles.refs[parent as usize]);
            }
        }
    }

    #[test]
    fn what_is_not_marked_stays() {
        let mut mesh = cube(2);
        let before = mesh.clone();
        bisect(Team::alone(), &mut mesh, &[]);
        assert_eq!((mesh.tets, mesh.triangles), (before.tets, before.triangles));
    }
}
