//! What the tests of several files need: a piece with all that a piece may have, and what it is whatever the order of its lists.
mod bytes;
mod cuts;
mod former;
mod input;
mod manifold;
mod outline;
mod part;
mod region;
mod split_and_join;

use super::input::{InMemory, Skin};
use super::piece::Piece;
use crate::geometry::discrete::{DEFAULT_RIDGE_ANGLE, complete_boundary};
use crate::geometry::{Discrete, Model};
use crate::mesh::samples;
use crate::metric::{Background, Source, Sym3};
use crate::tasks::Team;

/// Numbers that repeat from run to run (splitmix64).
pub struct Random(pub u64);

impl Random {
    pub fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) % n as u64) as usize
    }
}

/// A cube of n³ cells with two regions, in which edges of the length `size` are wanted: as a model, a metric and a piece. Some vertices, edges and
/// triangles are required, on the boundary and inside, and a vertex is on its way to the model.
pub fn sample(n: u32, size: f64) -> (Model, Source, Piece) {
    let mut mesh = samples::cube(n);
    for t in 0..mesh.tets.len() {
        let sum: f64 = mesh.tets.nodes[t].iter().map(|&v| mesh.vertices[v as usize][0]).sum();
        mesh.tets.refs[t] = if sum < 2.0 { 7 } else { 4 };
    }
    complete_boundary(Team::alone(), &mut mesh);
    let (model, mut place) = Discrete::from_mesh(Team::alone(), &mesh, DEFAULT_RIDGE_ANGLE).unwrap();
    let (count, side) = (mesh.vertices.len() as u32, n + 1);
    let middle = (n / 2 * side + n / 2) * side + n / 2;
    mesh.vertex_refs = (0..count as i32).map(|v| v % 3).collect();
    mesh.required_vertices = vec![1, middle];
    let beside = middle + side * side;
    // Along an edge of the cube, inside, and from the interface inwards.
    for (nodes, reference) in [([0, 1], 5), ([beside, beside + side], 6), ([middle, beside], 9)] {
        mesh.required_edges.push(mesh.edges.len() as u32);
        mesh.edges.push(nodes, reference);
    }
    mesh.required_triangles = vec![3, mesh.triangles.len() as u32 - 1];
    let off = mesh.vertices.len() - 1 - side as usize / 2;
    place.projected[off][0] += 1e-3 / f64::from(n);
    let log = Sym3::diagonal(1.0, 1.0, 1.0).times(1.0 / (size * size)).ln();
    let logs = vec![log; mesh.vertices.len()];
    let background = Background::new(mesh.vertices.clone(), mesh.tets.nodes.clone(), logs.clone());
    let input = InMemory { mesh: &mesh, logs: &logs };
    let piece = Skin::of(Team::alone(), &mesh, &place).piece(&input, 0..mesh.tets.len()).unwrap();
    (Model::Discrete(model), Source::Background(background), piece)
}

/// A piece by the ids of its vertices, in order: what does not depend on the order of its lists. It says of each entity all that is known,
/// but whether a vertex is shared.
pub fn picture(piece: &Piece) -> Vec<String> {
    let Piece { mesh, place, logs, ids, marks, halves, cuts } = piece;
    let id = |v: u32| ids[v as usize];
    let ascending = |nodes: &[u32]| {
        let mut ids: Vec<u64> = nodes.iter().map(|&v| id(v)).collect();
        ids.sort_unstable();
        ids
    };
    let mut lines = Vec::new();
    for v in 0..ids.len() {
        let waits = marks[v] & super::piece::WAITING;
        let at = (mesh.vertices[v], mesh.vertex_refs[v], place.entities[v], place.parameters[v], place.projected[v]);
        lines.push(format!("vertex {} {at:?} {:?} {waits}", ids[v], logs[v]));
    }
    lines.extend(mesh.tets.iter().map(|(nodes, reference)| format!("tet {:?} {reference}", nodes.map(id))));
    for (t, (nodes, reference)) in mesh.triangles.iter().enumerate() {
        let is_required = mesh.required_triangles.contains(&(t as u32));
        let at = (reference, place.faces[t], halves[t], is_required);
        lines.push(format!("triangle {:?} {at:?}", nodes.map(id)));
    }
    assert_eq!(mesh.required_edges, (0..mesh.edges.len() as u32).collect::<Vec<_>>());
    lines.extend(mesh.edges.iter().map(|(nodes, reference)| format!("edge {:?} {reference}", ascending(&nodes))));
    lines.extend(place.ridges.iter().map(|(nodes, curve)| format!("ridge {:?} {curve}", ascending(nodes))));
    lines.extend(mesh.required_vertices.iter().map(|&v| format!("required {}", id(v))));
    lines.extend(cuts.iter().map(|nodes| format!("cut {:?}", ascending(nodes))));
    lines.sort_unstable();
    lines
}

/// For each tetrahedron its centroid.
pub fn centroids(piece: &Piece) -> Vec<[f64; 3]> {
    let at = |nodes: &[u32; 4]| {
        [0, 1, 2].map(|k| nodes.iter().map(|&v| piece.mesh.vertices[v as usize][k]).sum::<f64>() / 4.0)
    };
    piece.mesh.tets.nodes.iter().map(at).collect()
}
