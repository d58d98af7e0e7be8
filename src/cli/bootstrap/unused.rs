//! Vertices that nothing uses: those in voids, whose tetrahedra are not taken into the mesh, and those inside a mesh whose surface is taken.
use crate::mesh::TetMesh;
use crate::mesh::vector::Vec3;

const NONE: u32 = u32::MAX;

/// Takes vertices of no tetrahedron and no triangle out of a mesh, whose vertices belong to `on_model`.
pub fn drop_unused(mesh: &mut TetMesh, on_model: &mut Vec<Vec3>) {
    *on_model = keep_used(mesh).into_iter().map(|v| on_model[v]).collect();
}

/// Takes vertices of no tetrahedron and no triangle out of a mesh, with what is said of them in edges, corners and association. Returns the
/// former numbers of those that are left.
pub fn keep_used(mesh: &mut TetMesh) -> Vec<usize> {
    let mut number = vec![NONE; mesh.vertices.len()];
    mesh.tets.nodes.iter().flatten().for_each(|&v| number[v as usize] = 0);
    mesh.triangles.nodes.iter().flatten().for_each(|&v| number[v as usize] = 0);
    let used: Vec<usize> = (0..number.len()).filter(|&v| number[v] != NONE).collect();
    if used.len() == number.len() {
        return used;
    }
    for (&v, new) in used.iter().zip(0..) {
        number[v] = new;
    }
    mesh.vertices = used.iter().map(|&v| mesh.vertices[v]).collect();
    mesh.vertex_refs = used.iter().map(|&v| mesh.vertex_refs[v]).collect();
    let renumber = |v: &mut u32| *v = number[*v as usize];
    mesh.tets.nodes.iter_mut().flatten().for_each(renumber);
    mesh.triangles.nodes.iter_mut().flatten().for_each(renumber);
    let mut edges = std::mem::take(&mut mesh.edges);
    edges.nodes.iter_mut().flatten().for_each(renumber);
    edges.iter().filter(|(nodes, _)| !nodes.contains(&NONE)).for_each(|(nodes, r)| mesh.edges.push(nodes, r));
    mesh.corners.iter_mut().for_each(renumber);
    mesh.corners.retain(|&v| v != NONE);
    let on = &mut mesh.association;
    on.vertices.iter_mut().for_each(|on| renumber(&mut on.vertex));
    on.edges.iter_mut().for_each(|on| renumber(&mut on.vertex));
    on.faces.iter_mut().for_each(|on| renumber(&mut on.vertex));
    on.vertices.retain(|on| on.vertex != NONE);
    on.edges.retain(|on| on.vertex != NONE);
    on.faces.retain(|on| on.vertex != NONE);
    used
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{OnFace, samples::cube};

    #[test]
    fn what_nothing_uses_goes_and_the_rest_is_renumbered() {
        let mut mesh = cube(1);
        let whole = mesh.clone();
        // In front, so that all numbers change.
        mesh.vertices.insert(0, [9.0; 3]);
        mesh.vertex_refs.insert(0, 0);
        mesh.tets.nodes.iter_mut().flatten().for_each(|v| *v += 1);
        mesh.triangles.nodes.iter_mut().flatten().for_each(|v| *v += 1);
        mesh.edges.nodes.iter_mut().flatten().for_each(|v| *v += 1);
        mesh.association.faces = [0, 3].map(|vertex| OnFace { vertex, id: 1, uv: [0.0; 2], r: 0.0 }).to_vec();
        let mut on_model = mesh.vertices.clone();
        drop_unused(&mut mesh, &mut on_model);
        assert_eq!((&mesh.vertices, &on_model), (&whole.vertices, &whole.vertices));
        assert_eq!((&mesh.tets, &mesh.triangles, &mesh.edges), (&whole.tets, &whole.triangles, &whole.edges));
        assert_eq!(mesh.association.faces.iter().map(|on| on.vertex).collect::<Vec<_>>(), [2]);
    }
}
