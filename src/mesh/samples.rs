//! Small meshes for tests and benches; no part of the interface.
use super::adjacency::{FACES, NONE, neighbours, sorted3};
use super::vector::{Vec3, volume6};
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

/// The mesh with its vertices and tetrahedra in an order without any sense.
pub fn shuffled(mesh: &TetMesh) -> TetMesh {
    let (vertices, tets) = (mesh.vertices.len(), mesh.tets.len());
    // Coprime to both.
    let place = |i: usize, count: usize| (i * 7919 + 13) % count;
    assert!(!vertices.is_multiple_of(7919) && !tets.is_multiple_of(7919));
    let mut new = mesh.clone();
    for v in 0..vertices {
        new.vertices[place(v, vertices)] = mesh.vertices[v];
    }
    let number = |v: u32| place(v as usize, vertices) as u32;
    for t in 0..tets {
        new.tets.nodes[place(t, tets)] = mesh.tets.nodes[t].map(number);
    }
    new.triangles.nodes.iter_mut().flatten().for_each(|v| *v = number(*v));
    new.edges.nodes.iter_mut().flatten().for_each(|v| *v = number(*v));
    new
}

/// A mesh of these tetrahedra with a triangle on every face of only one of them.
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

/// A rod of radius 1 in a bushing, two bodies of length 1 that are `gap` apart, with so many edges around: regions 1 and 2.
pub fn rod_in_bushing(gap: f64, around: u32, layers: u32) -> TetMesh {
    // Half an edge between the two, so that chords face corners.
    let at = |radius: f64, i: u32, shift: f64| {
        let (sin, cos) = (std::f64::consts::TAU * (f64::from(i) + shift) / f64::from(around)).sin_cos();
        [radius * cos, radius * sin]
    };
    let mut section = Section::default();
    let first = section.rings(4, around, |ring, i| at(f64::from(ring + 1) / 4.0, i, 0.0), 1);
    section.points.push([0.0; 2]);
    let middle = section.points.len() as u32 - 1;
    section.triangles.extend((0..around).map(|i| ([middle, first + i, first + (i + 1) % around], 1)));
    section.rings(4, around, |ring, i| at(1.0 + gap + f64::from(ring) / 4.0, i, 0.5), 2);
    section.extruded(layers)
}

/// The space about a lens of chord 2 and a thickness, sharp at both ends, out to a cylinder of radius 3, of length 1.
pub fn about_a_lens(thickness: f64, around: u32, layers: u32) -> TetMesh {
    let mut section = Section::default();
    section.rings(
        7,
        around,
        |ring, i| {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(i) / f64::from(around)).sin_cos();
            // Two parabolas: points at equal angles are closer at the ends.
            let lens = [cos, 0.5 * thickness * (1.0 - cos * cos) * sin.signum()];
            let share = (f64::from(ring) / 6.0).powi(2);
            [0, 1].map(|k| lens[k] + share * (3.0 * [cos, sin][k] - lens[k]))
        },
        1,
    );
    section.extruded(layers)
}

/// A triangulation of the plane, with a reference for each triangle.
#[derive(Default)]
struct Section {
    points: Vec<[f64; 2]>,
    triangles: Vec<([u32; 3], i32)>,
}

impl Section {
    /// Adds closed rings of points, outwards, with quadrilaterals cut in two between them; returns the first point.
    fn rings(&mut self, rings: u32, around: u32, at: impl Fn(u32, u32) -> [f64; 2], reference: i32) -> u32 {
        let first = self.points.len() as u32;
        for ring in 0..rings {
            self.points.extend((0..around).map(|i| at(ring, i)));
        }
        for ring in 1..rings {
            let [inner, outer] = [first + (ring - 1) * around, first + ring * around];
            for i in 0..around {
                let j = (i + 1) % around;
                self.triangles.push(([inner + i, outer + i, outer + j], reference));
                self.triangles.push(([inner + i, outer + j, inner + j], reference));
            }
        }
        first
    }

    /// Layers of prisms over it, up to height 1, each cut into three tetrahedra.
    fn extruded(&self, layers: u32) -> TetMesh {
        let count = self.points.len() as u32;
        let height = |layer: u32| f64::from(layer) / f64::from(layers);
        let layer = |layer: u32| self.points.iter().map(move |[x, y]| [*x, *y, height(layer)]);
        let vertices: Vec<Vec3> = (0..=layers).flat_map(layer).collect();
        let (mut tets, mut refs) = (Vec::new(), Vec::new());
        for layer in 0..layers {
            for (nodes, reference) in &self.triangles {
                let [a, b, c] = sorted3(*nodes).map(|v| v + layer * count);
                let [d, e, f] = [a, b, c].map(|v| v + count);
                // Diagonals of the sides leave the lesser vertex, so they match.
                for mut tet in [[a, b, c, f], [a, b, e, f], [a, d, e, f]] {
                    let [p, q, r, s] = tet.map(|v| vertices[v as usize]);
                    if volume6(p, q, r, s) < 0.0 {
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
}
