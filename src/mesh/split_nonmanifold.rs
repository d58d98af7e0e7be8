//! Splits a mesh where parts of it meet only in edges or vertices.
use super::adjacency::{sorted_faces, sorted3};
use super::disjoint_sets::DisjointSets;
use super::{Association, Elements, TetMesh};

/// Where the tetrahedra at a vertex are in several parts that share no face, gives each part a vertex of its own. Then no edge has four
/// triangles of the surface, and no vertex two umbrellas of them. Returns how many vertices are new; where there are such, what was said of edges and of
/// vertices (tagged edges, corners, the association) is dropped, since it is no longer clear whose it is.
pub fn split_nonmanifold(mesh: &mut TetMesh) -> usize {
    let tets = &mesh.tets.nodes;
    // Corner i of tetrahedron t is 4t + i.
    let corner = |tet: u32, node: u32| tets[tet as usize].iter().position(|&v| v == node).map(|i| 4 * tet + i as u32);
    let mut parts = DisjointSets::new(4 * tets.len());
    let faces = sorted_faces(tets);
    for pair in faces.windows(2).filter(|pair| pair[0].nodes == pair[1].nodes) {
        for node in pair[0].nodes {
            if let [Some(a), Some(b)] = [pair[0].side, pair[1].side].map(|side| corner(side / 4, node)) {
                parts.join(a, b);
            }
        }
    }
    // The first part at a vertex keeps it.
    let mut owner = vec![u32::MAX; mesh.vertices.len()];
    let mut own = vec![u32::MAX; parts.count()];
    let old = mesh.vertices.len();
    for at in 0..parts.count() as u32 {
        let node = tets[at as usize / 4][at as usize % 4];
        if parts.first(at) != at {
            continue;
        }
        own[at as usize] = if owner[node as usize] == u32::MAX {
            owner[node as usize] = at;
            node
        } else {
            mesh.vertices.push(mesh.vertices[node as usize]);
            mesh.vertex_refs.push(mesh.vertex_refs[node as usize]);
            mesh.vertices.len() as u32 - 1
        };
    }
    let added = mesh.vertices.len() - old;
    if added == 0 {
        return 0;
    }
    let mut now = |at: u32| own[parts.first(at) as usize];
    // A triangle goes with the first tetrahedron that has it: that of its other side is of the same part.
    for nodes in &mut mesh.triangles.nodes {
        let key = sorted3(*nodes);
        let at = faces.partition_point(|face| face.nodes < key);
        let Some(face) = faces.get(at).filter(|face| face.nodes == key) else { continue };
        *nodes = nodes.map(|node| corner(face.side / 4, node).map_or(node, &mut now));
    }
    let tets = (0..tets.len() as u32).map(|tet| [0, 1, 2, 3].map(|i| now(4 * tet + i))).collect();
    mesh.tets.nodes = tets;
    mesh.edges = Elements::default();
    mesh.association = Association::default();
    mesh.corners.clear();
    mesh.ridges.clear();
    mesh.required_edges.clear();
    added
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::adjacency::FACES;
    use crate::mesh::samples::cube;
    use crate::mesh::validity;

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

    #[test]
    fn what_hangs_together_by_faces_is_left_alone() {
        let mut mesh = cube(2);
        mesh.edges.push([0, 1], 1);
        let before = mesh.clone();
        assert_eq!(split_nonmanifold(&mut mesh), 0);
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
            mesh.edges.push([0, 1], 1);
            let vertices = mesh.vertices.len();
            assert_eq!(split_nonmanifold(&mut mesh), added);
            assert_eq!(
                (mesh.vertices.len(), mesh.vertex_refs.len(), mesh.edges.len()),
                (vertices + added, vertices + added, 0)
            );
            assert!(validity::check(&mesh).is_valid(), "{:?}", validity::check(&mesh));
            assert_eq!(split_nonmanifold(&mut mesh), 0);
        }
    }
}
