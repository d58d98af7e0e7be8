//! Takes a mesh apart where it hangs together in edges or vertices alone.
use super::TetMesh;
use super::adjacency::{EDGES, FACES, MatchedFaces, NONE, sorted3};
use super::disjoint_sets::DisjointSets;
use crate::tasks::{GRAIN, Team};
use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// An edge in which the boundary touches itself, and which vertices of its own on each side cannot take apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "the boundary touches itself along the edge of nodes {} {} alone, whose ends it shares with more: {triangles} of its triangles meet \
     there; put a vertex on that edge, or take the mesh apart there",
    nodes[0] + 1, nodes[1] + 1
)]
pub struct Touching {
    /// Its nodes, from 0.
    pub nodes: [u32; 2],
    /// Boundary triangles that meet there.
    pub triangles: usize,
}

/// Gives each part of the tetrahedra at a vertex that hang together by faces a vertex of its own: then no edge has four triangles of the
/// boundary. Returns for each new vertex, at the end of the list, the one that it is a copy of.
///
/// The triangles go with their tetrahedra. A tagged or required edge, a corner and a required vertex become one on each side. What is said
/// of the doubled vertices' places on a CAD model is dropped, since it is not clear whose it is. `faces` stays true. A mesh with a face of
/// more than two tetrahedra is none, and stays as it is.
///
/// # Errors
/// [`Touching`] where a single edge of the mesh is all that its sides have in common, but for vertices at its ends about which all hangs together.
pub fn split_nonmanifold(team: Team<'_>, mesh: &mut TetMesh, faces: &MatchedFaces) -> Result<Vec<u32>, Touching> {
    if faces.crowded.is_some() {
        return Ok(Vec::new());
    }
    let vertices = mesh.vertices.len();
    let near = NearBoundary::of(team, &mesh.tets.nodes, mesh.vertices.len(), &faces.neighbours);
    let mut parts = near.parts(&mesh.tets.nodes, &faces.neighbours);
    // The first part at a vertex keeps it.
    let mut owner: Vec<u32> = vec![u32::MAX; mesh.vertices.len()];
    let mut own = vec![u32::MAX; parts.count()];
    let mut origins = Vec::new();
    for at in 0..parts.count() as u32 {
        let node = near.node(&mesh.tets.nodes, at);
        if !near.on_boundary[node as usize] || parts.first(at) != at {
            continue;
        }
        let owner = &mut owner[node as usize];
        own[at as usize] = if *owner == u32::MAX {
            *owner = at;
            node
        } else {
            origins.push(node);
            (mesh.vertices.len() + origins.len()) as u32 - 1
        };
    }
    if !origins.is_empty() {
        let mut copies = Copies::of(mesh, &origins);
        for (&tet, at) in near.tets.iter().zip(0..) {
            let nodes = mesh.tets.nodes[tet as usize];
            let now = [0, 1, 2, 3].map(|i| match copies.is_doubled[nodes[i] as usize] {
                true => own[parts.first(4 * at + i as u32) as usize],
                false => nodes[i],
            });
            copies.note(nodes, now);
            mesh.tets.nodes[tet as usize] = now;
        }
        copies.write(mesh, &origins);
    }
    match near.touching(team, &mesh.tets.nodes, &faces.neighbours) {
        Some(Touching { nodes, triangles }) => {
            let origin = |v: u32| (v as usize).checked_sub(vertices).map_or(v, |copy| origins[copy]);
            Err(Touching { nodes: nodes.map(origin), triangles })
        }
        None => Ok(origins),
    }
}

/// Gives new vertices the values of those that they are copies of.
pub fn copy_values<T: Copy>(values: &mut Vec<T>, origins: &[u32]) {
    values.reserve(origins.len());
    for &origin in origins {
        values.push(values[origin as usize]);
    }
}

/// The tetrahedra with a vertex on the boundary: elsewhere nothing is pinched.
struct NearBoundary {
    on_boundary: Vec<bool>,
    tets: Vec<u32>,
}

impl NearBoundary {
    fn of(team: Team<'_>, tets: &[[u32; 4]], vertices: usize, neighbours: &[[u32; 4]]) -> Self {
        let marks: Vec<AtomicBool> = bytemuck::allocation::zeroed_vec(vertices);
        team.for_each(GRAIN, tets.len(), |range| {
            for t in range.filter(|&t| neighbours[t].contains(&NONE)) {
                for face in (0..4).filter(|&i| neighbours[t][i] == NONE) {
                    FACES[face].iter().for_each(|&k| marks[tets[t][k] as usize].store(true, Relaxed));
                }
            }
        });
        let on_boundary: Vec<bool> = marks.into_iter().map(AtomicBool::into_inner).collect();
        let tets = team.collect(GRAIN, tets.len(), |range, near| {
            let is_near = |&t: &usize| tets[t].iter().any(|&v| on_boundary[v as usize]);
            near.extend(range.filter(is_near).map(|t| t as u32));
        });
        Self { on_boundary, tets }
    }

    /// The node of a corner: 4 · place of the tetrahedron + its place there.
    fn node(&self, tets: &[[u32; 4]], corner: u32) -> u32 {
        tets[self.tets[corner as usize / 4] as usize][corner as usize % 4]
    }

    /// The corners, joined across the faces that have their vertices.
    fn parts(&self, tets: &[[u32; 4]], neighbours: &[[u32; 4]]) -> DisjointSets {
        let mut parts = DisjointSets::new(4 * self.tets.len());
        let mut place = vec![u32::MAX; tets.len()];
        self.tets.iter().zip(0..).for_each(|(&t, at)| place[t as usize] = at);
        for (&t, at) in self.tets.iter().zip(0..) {
            for (face, &n) in neighbours[t as usize].iter().enumerate().filter(|&(_, &n)| n != NONE && n < t) {
                for k in FACES[face] {
                    let node = tets[t as usize][k];
                    let across = tets[n as usize].iter().position(|&v| v == node);
                    if let (Some(across), true) = (across, self.on_boundary[node as usize]) {
                        parts.join(4 * at + k as u32, 4 * place[n as usize] + across as u32);
                    }
                }
            }
        }
        parts
    }

    /// The first edge of more than two boundary faces.
    fn touching(&self, team: Team<'_>, tets: &[[u32; 4]], neighbours: &[[u32; 4]]) -> Option<Touching> {
        let mut edges: Vec<[u32; 2]> = Vec::new();
        for &t in &self.tets {
            for face in (0..4).filter(|&i| neighbours[t as usize][i] == NONE) {
                let [a, b, c] = sorted3(FACES[face].map(|k| tets[t as usize][k]));
                edges.extend([[a, b], [b, c], [a, c]]);
            }
        }
        team.sort(&mut edges);
        let mut shared = edges.chunk_by(|a, b| a == b).filter(|same| same.len() > 2);
        shared.next().map(|same| Touching { nodes: same[0], triangles: same.len() })
    }
}

/// What became of edges and faces with doubled vertices.
struct Copies {
    is_doubled: Vec<bool>,
    edges: HashMap<[u32; 2], Vec<[u32; 2]>>,
    faces: HashMap<[u32; 3], [u32; 3]>,
}

impl Copies {
    fn of(mesh: &TetMesh, origins: &[u32]) -> Self {
        let mut is_doubled = vec![false; mesh.vertices.len()];
        origins.iter().for_each(|&v| is_doubled[v as usize] = true);
        Self { is_doubled, edges: HashMap::new(), faces: HashMap::new() }
    }

    /// Notes what the nodes of a tetrahedron are now.
    fn note(&mut self, nodes: [u32; 4], now: [u32; 4]) {
        let Self { is_doubled, edges, faces } = self;
        for [i, j] in EDGES.map(|[i, j]| if nodes[i] < nodes[j] { [i, j] } else { [j, i] }) {
            if is_doubled[nodes[i] as usize] || is_doubled[nodes[j] as usize] {
                let copies = edges.entry([nodes[i], nodes[j]]).or_default();
                if !copies.contains(&[now[i], now[j]]) {
                    copies.push([now[i], now[j]]);
                }
            }
        }
        for face in FACES.map(|face| face.map(|k| nodes[k])) {
            if face.iter().any(|&v| is_doubled[v as usize]) {
                // Both tetrahedra of a face have the same copies.
                let key = sorted3(face);
                let now_of = |v: u32| nodes.iter().zip(now).find(|(node, _)| **node == v).map_or(v, |(_, now)| now);
                faces.insert(key, key.map(now_of));
            }
        }
    }

    /// Writes new vertices, triangles and edges, and what is said of them.
    fn write(&self, mesh: &mut TetMesh, origins: &[u32]) {
        let old = mesh.vertices.len() as u32;
        for &origin in origins {
            mesh.vertices.push(mesh.vertices[origin as usize]);
            mesh.vertex_refs.push(mesh.vertex_refs[origin as usize]);
        }
        for nodes in &mut mesh.triangles.nodes {
            let key = sorted3(*nodes);
            if let Some(copy) = self.faces.get(&key) {
                *nodes = nodes.map(|v| key.iter().zip(copy).find(|(node, _)| **node == v).map_or(v, |(_, &now)| now));
            }
        }
        self.write_edges(mesh);
        for listed in [&mut mesh.corners, &mut mesh.required_vertices] {
            let copies = (old..).zip(origins).filter(|(_, origin)| listed.contains(origin));
            let copies: Vec<u32> = copies.map(|(copy, _)| copy).collect();
            listed.extend(copies);
        }
        let is_one = |v: u32| !self.is_doubled[v as usize];
        mesh.association.vertices.retain(|on| is_one(on.vertex));
        mesh.association.edges.retain(|on| is_one(on.vertex));
        mesh.association.faces.retain(|on| is_one(on.vertex));
    }

    fn write_edges(&self, mesh: &mut TetMesh) {
        let mut more: Vec<(u32, [u32; 2])> = Vec::new();
        for (nodes, edge) in mesh.edges.nodes.iter_mut().zip(0..) {
            let [a, b] = *nodes;
            let Some([first, others @ ..]) = self.edges.get(&[a.min(b), a.max(b)]).map(Vec::as_slice) else { continue };
            *nodes = if a < b { *first } else { [first[1], first[0]] };
            more.extend(others.iter().map(|&copy| (edge, copy)));
        }
        let first = mesh.edges.len() as u32;
        for &(edge, nodes) in &more {
            mesh.edges.push(nodes, mesh.edges.refs[edge as usize]);
        }
        for listed in [&mut mesh.ridges, &mut mesh.required_edges] {
            let copies = (first..).zip(&more).filter(|(_, (edge, _))| listed.contains(edge));
            let copies: Vec<u32> = copies.map(|(copy, _)| copy).collect();
            listed.extend(copies);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::adjacency::sorted_faces;
    use crate::mesh::samples::cube;
    use crate::mesh::validity;
    use crate::mesh::{Elements, OnVertex};

    /// The cells of the cube of 2³ that are meant, with all their faces on the boundary as triangles.
    fn cells(is_meant: impl Fn([bool; 3]) -> bool) -> TetMesh {
        let mut mesh = cube(2);
        let all = std::mem::take(&mut mesh.tets);
        mesh.triangles = Elements::default();
        for (nodes, reference) in all.iter() {
            let middle = |k: usize| nodes.iter().map(|&v| mesh.vertices[v as usize][k]).sum::<f64>() > 2.0;
            if is_meant([middle(0), middle(1), middle(2)]) {
                mesh.tets.push(nodes, reference);
            }
        }
        let faces = sorted_faces(&mesh.tets.nodes);
        for (i, face) in faces.iter().enumerate() {
            let is_same =
                |other: Option<&crate::mesh::adjacency::FaceKey>| other.is_some_and(|f| f.nodes == face.nodes);
            if !is_same(faces.get(i + 1)) && !is_same(i.checked_sub(1).and_then(|i| faces.get(i))) {
                let nodes = mesh.tets.nodes[face.side as usize / 4];
                mesh.triangles.push(FACES[face.side as usize % 4].map(|k| nodes[k]), 1);
            }
        }
        let mut is_used = vec![u32::MAX; mesh.vertices.len()];
        mesh.tets.nodes.iter().flatten().for_each(|&v| is_used[v as usize] = 0);
        let mut vertices = Vec::new();
        for (v, used) in is_used.iter_mut().enumerate().filter(|(_, used)| **used == 0) {
            *used = vertices.len() as u32;
            vertices.push(mesh.vertices[v]);
        }
        mesh.vertex_refs = vec![0; vertices.len()];
        mesh.vertices = vertices;
        mesh.tets.nodes.iter_mut().flatten().for_each(|v| *v = is_used[*v as usize]);
        mesh.triangles.nodes.iter_mut().flatten().for_each(|v| *v = is_used[*v as usize]);
        mesh
    }

    fn apart(mesh: &mut TetMesh) -> Result<Vec<u32>, Touching> {
        let faces = MatchedFaces::of(Team::alone(), &mesh.tets.nodes);
        let copies = split_nonmanifold(Team::alone(), mesh, &faces);
        // What was matched is so still.
        assert_eq!(MatchedFaces::of(Team::alone(), &mesh.tets.nodes).neighbours, faces.neighbours);
        copies
    }

    #[test]
    fn what_hangs_together_by_faces_is_left_alone() {
        let mut mesh = cube(2);
        mesh.edges.push([0, 1], 1);
        let before = mesh.clone();
        assert_eq!(apart(&mut mesh), Ok(Vec::new()));
        assert_eq!(mesh, before);
    }

    #[test]
    fn an_edge_and_a_vertex_are_doubled() {
        // Two cells at one edge, of two nodes; two at the middle alone.
        for (meant, added) in [
            (&(|[x, y, z]: [bool; 3]| x == y && !z) as &dyn Fn([bool; 3]) -> bool, 2),
            (&|[x, y, z]: [bool; 3]| x == y && y == z, 1),
        ] {
            let mut mesh = cells(meant);
            assert!(!validity::check(&mesh).is_valid());
            let vertices = mesh.vertices.len();
            assert_eq!(apart(&mut mesh).unwrap().len(), added);
            assert_eq!((mesh.vertices.len(), mesh.vertex_refs.len()), (vertices + added, vertices + added));
            assert!(validity::check(&mesh).is_valid(), "{:?}", validity::check(&mesh));
            assert_eq!(apart(&mut mesh), Ok(Vec::new()));
        }
    }

    #[test]
    fn what_is_said_of_a_doubled_edge_holds_on_both_sides() {
        let mut mesh = cells(|[x, y, z]| x == y && !z);
        let at = |mesh: &TetMesh, p| mesh.vertices.iter().position(|&q| q == p).unwrap() as u32;
        let [low, high, aside] = [[0.5, 0.5, 0.0], [0.5, 0.5, 0.5], [0.0, 0.5, 0.0]].map(|p| at(&mesh, p));
        mesh.edges = Elements { nodes: vec![[aside, low], [high, low]], refs: vec![7, 8] };
        (mesh.ridges, mesh.required_edges) = (vec![0, 1], vec![1]);
        (mesh.corners, mesh.required_vertices) = (vec![high], vec![aside]);
        mesh.association.vertices = [high, aside].map(|vertex| OnVertex { vertex, id: 1 }).to_vec();
        let copies = apart(&mut mesh).unwrap();
        assert_eq!(copies.len(), 2);
        assert!(validity::check(&mesh).is_valid(), "{:?}", validity::check(&mesh));
        assert_eq!(mesh.edges.refs, [7, 8, 8]);
        let points = |nodes: [u32; 2]| nodes.map(|v| mesh.vertices[v as usize]);
        assert_eq!(points(mesh.edges.nodes[1]), points([high, low]));
        assert_ne!(mesh.edges.nodes[1], mesh.edges.nodes[2]);
        assert_eq!((&mesh.ridges[..], &mesh.required_edges[..]), (&[0, 1, 2][..], &[1, 2][..]));
        assert_eq!((mesh.corners.len(), &mesh.required_vertices[..]), (2, &[aside][..]));
        assert_eq!(mesh.association.vertices, [OnVertex { vertex: aside, id: 1 }]);
    }

    #[test]
    fn an_edge_whose_ends_hang_together_is_an_error() {
        // Two voids of one cell each share a short edge, about whose ends all else hangs together.
        let mesh = cube(4);
        let is_void = |middle: [f64; 3]| {
            let cell = middle.map(|x| (4.0 * x) as u32);
            cell == [1, 1, 1] || cell == [2, 2, 1]
        };
        let mut holed =
            TetMesh { vertices: mesh.vertices.clone(), vertex_refs: mesh.vertex_refs, ..TetMesh::default() };
        for (nodes, reference) in mesh.tets.iter() {
            let sum = |k: usize| nodes.iter().map(|&v| mesh.vertices[v as usize][k]).sum::<f64>() / 4.0;
            if !is_void([sum(0), sum(1), sum(2)]) {
                holed.tets.push(nodes, reference);
            }
        }
        let error = apart(&mut holed).unwrap_err();
        assert_eq!(error.triangles, 4);
        let ends = error.nodes.map(|v| mesh.vertices[v as usize]);
        assert!(ends.contains(&[0.5, 0.5, 0.25]) && ends.contains(&[0.5, 0.5, 0.5]), "{ends:?}");
    }
}
