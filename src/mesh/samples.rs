//! Small meshes for tests and benches; no part of the interface.
use super::adjacency::{FACES, NONE, neighbours, sorted3};
use super::stack::{Cell, Kind, Stack};
use super::vector::{Vec3, volume6};
use super::{Elements, TetMesh};
use std::collections::BTreeMap;

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

/// The unit cube of n³ cells with a layer of prisms of this height below it, on whose lower side the triangles have the reference 5; quadrilaterals
/// around the layer with the references of the cube's sides. Not joined.
pub fn on_prisms(n: u32, height: f64) -> (TetMesh, Stack) {
    let mut mesh = cube(n);
    let all: Vec<([u32; 3], i32)> = mesh.triangles.iter().collect();
    let mut below = BTreeMap::new();
    let mut lower = |mesh: &mut TetMesh, v: u32| {
        *below.entry(v).or_insert_with(|| {
            let [x, y, _] = mesh.vertices[v as usize];
            mesh.vertices.push([x, y, -height]);
            mesh.vertex_refs.push(0);
            mesh.vertices.len() as u32 - 1
        })
    };
    let mut stack = Stack::default();
    mesh.triangles = Elements::default();
    for (nodes, side) in all {
        if side != 5 {
            mesh.triangles.push(nodes, side);
            continue;
        }
        let [a, b, c] = nodes;
        let [d, e, f] = nodes.map(|v| lower(&mut mesh, v));
        stack.cells.push(Cell::new(Kind::Prism, &[a, b, c, d, e, f], 1));
        mesh.triangles.push([d, e, f], 5);
        for quad in [[a, b, e, d], [b, c, f, e], [c, a, d, f]] {
            let corners = [quad[0], quad[1], quad[2]].map(|v| mesh.vertices[v as usize]);
            if side_of(corners) != 7 {
                stack.quads.push(quad, side_of(corners));
            }
        }
    }
    (mesh, stack)
}

/// A unit cube of ten tetrahedra and a pyramid about its centre, on a hexahedron with a prism beside it; triangles and quadrilaterals on all of the
/// boundary. Not joined.
pub fn of_all_kinds() -> (TetMesh, Stack) {
    let corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
    let mut vertices: Vec<Vec3> = corners.iter().map(|corner| corner.map(f64::from)).collect();
    vertices.push([0.5, 0.5, 0.4]);
    vertices.extend([[0.0, 0.0, -0.3], [1.0, 0.0, -0.3], [1.0, 1.0, -0.3], [0.0, 1.0, -0.3]]);
    vertices.extend([[-0.7, 0.0, -0.3], [-0.7, 1.0, -0.3]]);
    let mut mesh = TetMesh { vertex_refs: vec![0; vertices.len()], vertices, ..TetMesh::default() };
    for ([a, b, c, d], side) in
        [([0, 1, 5, 4], 3), ([1, 2, 6, 5], 2), ([2, 3, 7, 6], 4), ([3, 0, 4, 7], 1), ([4, 5, 6, 7], 6)]
    {
        for [a, b, c] in [[a, b, c], [a, c, d]] {
            mesh.tets.push([a, c, b, 8], 1);
            mesh.triangles.push([a, b, c], side);
        }
    }
    let mut stack = Stack::default();
    stack.cells.push(Cell::new(Kind::Pyramid, &[0, 1, 2, 3, 8], 1));
    stack.cells.push(Cell::new(Kind::Prism, &[0, 13, 9, 3, 14, 12], 1));
    stack.cells.push(Cell::new(Kind::Hexahedron, &[9, 10, 11, 12, 0, 1, 2, 3], 1));
    mesh.triangles.push([0, 13, 9], 3);
    mesh.triangles.push([3, 12, 14], 4);
    for (quad, side) in [
        ([9, 12, 11, 10], 5),
        ([9, 13, 14, 12], 5),
        ([0, 3, 14, 13], 1),
        ([0, 9, 10, 1], 3),
        ([1, 10, 11, 2], 2),
        ([2, 11, 12, 3], 4),
    ] {
        stack.quads.push(quad, side);
    }
    (mesh, stack)
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
