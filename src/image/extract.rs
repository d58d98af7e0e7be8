//! From the store to the mesh: the tetrahedra of the regions, and the triangles around and between them.
use super::circumsphere::{centre, shortest_edge};
use super::domain::Domain;
use super::manifold;
use super::rules::Limits;
use super::store::{NONE, Role, Store};
use crate::mesh::TetMesh;
use crate::mesh::adjacency::FACES;
use crate::mesh::vector::{Vec3, distance};
use serde::Serialize;
use std::collections::BTreeMap;

/// The tetrahedra that are alive, as plain arrays.
pub struct Tets {
    pub nodes: Vec<[u32; 4]>,
    pub neighbours: Vec<[u32; 4]>,
    /// 0: outside.
    pub regions: Vec<u16>,
    pub points: Vec<Vec3>,
}

/// A surface: all triangles between the same two regions.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Surface {
    /// Reference of its triangles.
    pub reference: i32,
    /// References of the regions beside, 0 outside.
    pub between: [i32; 2],
    /// Number of triangles.
    pub triangles: usize,
}

/// Ratios of circumradius to shortest edge.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct RadiusEdge {
    /// The greatest of all tetrahedra.
    pub greatest: f64,
    /// The greatest of those without a vertex on a surface.
    pub greatest_inside: f64,
    /// How many with a vertex on a surface are above the limit. Better ones there would need vertices nearer to each other than the limits
    /// allow.
    pub above_at_surfaces: usize,
    /// How many are above the limit without a vertex on a surface.
    pub above_inside: usize,
}

/// What comes out.
pub struct Extracted {
    /// The mesh.
    pub mesh: TetMesh,
    /// Its surfaces.
    pub surfaces: Vec<Surface>,
    /// How round its tetrahedra are.
    pub radius_edge: RadiusEdge,
    /// Tetrahedra left out where the boundary touched itself.
    pub left_out: usize,
}

impl Extracted {
    /// The mesh of a refined store.
    pub fn new(store: &Store, domain: &Domain, limits: &Limits) -> Self {
        let mut tets = collect(store);
        let left_out = manifold::repair(&mut tets);
        let radius_edge = radius_edge(&tets, store, limits);
        let mut mesh = TetMesh::default();
        let mut numbers = vec![NONE; tets.points.len()];
        let mut number = |mesh: &mut TetMesh, v: u32| {
            let number = &mut numbers[v as usize];
            if *number == NONE {
                *number = mesh.vertices.len() as u32;
                mesh.vertices.push(tets.points[v as usize]);
                mesh.vertex_refs.push(0);
            }
            *number
        };
        let mut counts = BTreeMap::new();
        for (t, nodes) in tets.nodes.iter().enumerate().filter(|&(t, _)| tets.regions[t] != 0) {
            let nodes = nodes.map(|v| number(&mut mesh, v));
            mesh.tets.push(nodes, domain.reference(tets.regions[t]));
            sides(&tets, t, |_, between| *counts.entry(between).or_insert(0) += 1);
        }
        let references: BTreeMap<[u16; 2], i32> = counts.keys().copied().zip(1..).collect();
        for t in (0..tets.nodes.len()).filter(|&t| tets.regions[t] != 0) {
            sides(&tets, t, |i, between| {
                let face = FACES[i].map(|k| number(&mut mesh, tets.nodes[t][k]));
                mesh.triangles.push(face, references[&between]);
            });
        }
        let surface = |(&between, &triangles): (&[u16; 2], &usize)| {
            let reference = references[&between];
            Surface { reference, between: between.map(|region| domain.reference(region)), triangles }
        };
        Self { mesh, surfaces: counts.iter().map(surface).collect(), radius_edge, left_out }
    }
}

/// The faces of a kept tetrahedron that become triangles, with the regions beside them: those with a lower region beyond.
fn sides(tets: &Tets, t: usize, mut found: impl FnMut(usize, [u16; 2])) {
    let region = tets.regions[t];
    for i in 0..4 {
        let beyond = tets.regions.get(tets.neighbours[t][i] as usize).copied().unwrap_or(0);
        if beyond < region {
            found(i, [beyond, region]);
        }
    }
}

/// What is alive, numbered anew.
fn collect(store: &Store) -> Tets {
    let alive: Vec<u32> = (0..store.tet_bound()).filter(|&t| store.nodes(t)[0] != NONE).collect();
    let mut numbers = vec![NONE; store.tet_bound() as usize];
    for (&t, number) in alive.iter().zip(0..) {
        numbers[t as usize] = number;
    }
    let numbered = |n: u32| numbers.get(n as usize).copied().unwrap_or(NONE);
    // Tetrahedra at the corners of the box are outside, wherever their circumcentre lies.
    let region =
        |&t: &u32| if store.nodes(t).iter().any(|&v| store.role(v) == Role::Corner) { 0 } else { store.region(t) };
    Tets {
        nodes: alive.iter().map(|&t| store.nodes(t)).collect(),
        neighbours: alive.iter().map(|&t| store.neighbours(t).map(numbered)).collect(),
        regions: alive.iter().map(region).collect(),
        points: (0..store.point_bound()).map(|v| store.at(v)).collect(),
    }
}

fn radius_edge(tets: &Tets, store: &Store, limits: &Limits) -> RadiusEdge {
    let mut found = RadiusEdge::default();
    for (nodes, _) in tets.nodes.iter().zip(&tets.regions).filter(|&(_, &region)| region != 0) {
        let points = nodes.map(|v| tets.points[v as usize]);
        let ratio = distance(centre(points), points[0]) / shortest_edge(&points);
        let inside = nodes.iter().all(|&v| store.role(v) == Role::Inner);
        let above = usize::from(ratio > limits.radius_edge);
        found.greatest = found.greatest.max(ratio);
        if inside {
            found.greatest_inside = found.greatest_inside.max(ratio);
            found.above_inside += above;
        } else {
            found.above_at_surfaces += above;
        }
    }
    found
}
