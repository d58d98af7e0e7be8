//! Meshes for tests.
use super::complete_boundary;
use crate::mesh::TetMesh;
use crate::mesh::vector::{sub, unit};
use crate::tasks::Team;

/// The unit cube, n³ cells of six tetrahedra around their diagonal; no triangles.
pub(crate) fn cube(n: u32) -> TetMesh {
    let mut mesh = TetMesh::default();
    let side = n + 1;
    let at = |i: u32, j: u32, k: u32| (k * side + j) * side + i;
    for k in 0..side {
        for j in 0..side {
            for i in 0..side {
                mesh.vertices.push([i, j, k].map(|x| f64::from(x) / f64::from(n)));
            }
        }
    }
    mesh.vertex_refs = vec![0; mesh.vertices.len()];
    for cell in 0..n * n * n {
        let base = [cell % n, cell / n % n, cell / n / n];
        for order in [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]] {
            let mut corner = base;
            let mut tet = [at(base[0], base[1], base[2]); 4];
            for (step, axis) in order.into_iter().enumerate() {
                corner[axis] += 1;
                tet[step + 1] = at(corner[0], corner[1], corner[2]);
            }
            if order[1] == (order[0] + 2) % 3 {
                tet.swap(2, 3);
            }
            mesh.tets.push(tet, 0);
        }
    }
    mesh
}

/// The sphere of radius 2 about the origin: a cube's surface blown up, triangles only.
pub(crate) fn sphere(n: u32) -> TetMesh {
    let mut mesh = cube(n);
    complete_boundary(Team::alone(), &mut mesh);
    for p in &mut mesh.vertices {
        *p = unit(sub(*p, [0.5; 3])).map(|x| 2.0 * x);
    }
    mesh.tets = Default::default();
    mesh
}
