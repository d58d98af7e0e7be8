//! Small meshes for tests and benches; no part of the interface.
use super::adjacency::{FACES, NONE, neighbours};
use super::vector::Vec3;
use super::{Elements, TetMesh};

/// The unit cube as n³ cells of six tetrahedra (Kuhn), boundary triangles of reference 1 to 6 by the side.
pub fn cube(n: u32) -> TetMesh {
    let index = |i: u32, j: u32, k: u32| (i * (n + 1) + j) * (n + 1) + k;
    let mut vertices = Vec::new();
    for i in 0..=n {
        for j in 0..=n {
            for k in 0..=n {
                vertices.push([i, j, k].map(|x| f64::from(x) / f64::from(n)));
            }
        }
    }
    let mut tets = Vec::new();
    for cell in 0..n * n * n {
        let [i, j, k] = [cell / (n * n), cell / n % n, cell % n];
        for order in [[0, 1, 2], [1, 2, 0], [2, 0, 1], [1, 0, 2], [0, 2, 1], [2, 1, 0]] {
            let mut at = [i, j, k];
            let mut nodes = [index(i, j, k); 4];
            for step in 0..3 {
                at[order[step]] += 1;
                nodes[step + 1] = index(at[0], at[1], at[2]);
            }
            let odd = matches!(order, [1, 0, 2] | [0, 2, 1] | [2, 1, 0]);
            if odd {
                nodes.swap(0, 1);
            }
            tets.push(nodes);
        }
    }
    with_boundary(vertices, tets)
}

/// A mesh of these tetrahedra with a triangle on every face that has but one of them.
pub fn with_boundary(vertices: Vec<Vec3>, tets: Vec<[u32; 4]>) -> TetMesh {
    let mut triangles = Elements::default();
    for (tet, around) in tets.iter().zip(neighbours(&tets)) {
        for face in (0..4).filter(|&face| around[face] == NONE) {
            let nodes = FACES[face].map(|i| tet[i]);
            triangles.push(nodes, side_of(nodes.map(|v| vertices[v as usize])));
        }
    }
    let refs = vec![1; tets.len()];
    TetMesh {
        vertex_refs: vec![0; vertices.len()],
        vertices,
        triangles,
        tets: Elements { nodes: tets, refs },
        ..TetMesh::default()
    }
}

/// 1 to 6: x = 0, x = 1, y = 0 and so on; 7 elsewhere.
fn side_of(corners: [Vec3; 3]) -> i32 {
    let on = |axis: usize, value: f64| corners.iter().all(|p| p[axis] == value);
    (0..6).find(|&side| on(side / 2, (side % 2) as f64)).map_or(7, |side| side as i32 + 1)
}
