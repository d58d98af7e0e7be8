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

/// A rod of radius 1 in a bushing, two bodies of length 1 that are `gap` apart, with so many edges around: references 1 and 2.
pub fn rod_in_bushing(gap: f64, around: u32, layers: u32) -> TetMesh {
    let rod: Vec<f64> = (1..=4).map(|ring| f64::from(ring) / 4.0).collect();
    let bushing: Vec<f64> = (0..=3).map(|ring| 1.0 + gap + f64::from(ring) / 4.0).collect();
    // Half an edge between the two, so that chords face corners.
    let at = |radius: f64, i: u32, shift: f64| {
        let (sin, cos) = (std::f64::consts::TAU * (f64::from(i) + shift) / f64::from(around)).sin_cos();
        [radius * cos, radius * sin]
    };
    let (mut plane, mut triangles): (Vec<[f64; 2]>, Vec<([u32; 3], i32)>) = (vec![[0.0; 2]], Vec::new());
    for (rings, shift, reference) in [(rod, 0.0, 1), (bushing, 0.5, 2)] {
        let first = plane.len() as u32;
        for radius in &rings {
            plane.extend((0..around).map(|i| at(*radius, i, shift)));
        }
        for i in 0..around {
            let j = (i + 1) % around;
            if reference == 1 {
                triangles.push(([0, first + i, first + j], 1));
            }
            for ring in 1..rings.len() as u32 {
                let [inner, outer] = [first + (ring - 1) * around, first + ring * around];
                triangles.push(([inner + i, outer + i, outer + j], reference));
                triangles.push(([inner + i, outer + j, inner + j], reference));
            }
        }
    }
    let count = plane.len() as u32;
    let height = |layer: u32| f64::from(layer) / f64::from(layers);
    let vertices: Vec<Vec3> =
        (0..=layers).flat_map(|layer| plane.iter().map(move |[x, y]| [*x, *y, height(layer)])).collect();
    let (mut tets, mut refs) = (Vec::new(), Vec::new());
    for layer in 0..layers {
        for (nodes, reference) in &triangles {
            let [a, b, c] = super::adjacency::sorted3(*nodes).map(|v| v + layer * count);
            let [d, e, f] = [a, b, c].map(|v| v + count);
            // Diagonals of the sides leave the lesser vertex, so they match.
            for mut tet in [[a, b, c, f], [a, b, e, f], [a, d, e, f]] {
                let [p, q, r, s] = tet.map(|v| vertices[v as usize]);
                if super::vector::volume6(p, q, r, s) < 0.0 {
                    tet.swap(0, 1);
                }
                tets.push(tet);
                refs.push(*reference);
            }
        }
    }
    let mut mesh = with_boundary(vertices, tets);
    mesh.tets.refs = refs;
    mesh
}
