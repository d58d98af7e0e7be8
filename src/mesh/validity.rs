//! Whether a mesh is valid: positive tetrahedra, a closed manifold boundary that has its triangles, nothing twice, nothing loose.
use super::adjacency::{FACES, FaceKey, NONE, sorted_faces, sorted3, unique_edges};
use super::disjoint_sets::DisjointSets;
use super::flaw::{Flaw, FlawKind, Offender};
use super::predicate::orientation;
use super::vector::{Vec3, add, scale};
use super::{Elements, TetMesh, crossing};
use crate::tasks::Team;
use serde::Serialize;

/// Most flaws of a kind that are named.
const NAMED: usize = 3;

/// The result of [`check`].
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Validity {
    /// Kinds of flaws found; none in a valid mesh.
    pub flaws: Vec<Flaw>,
}

impl Validity {
    /// Whether nothing is wrong.
    pub fn is_valid(&self) -> bool {
        self.flaws.is_empty()
    }

    /// How often a kind of flaw was found.
    pub fn count(&self, kind: FlawKind) -> usize {
        self.flaws.iter().find(|flaw| flaw.kind == kind).map_or(0, |flaw| flaw.count)
    }
}

/// Checks a mesh whose indices are in range.
pub fn check(mesh: &TetMesh) -> Validity {
    check_on(Team::alone(), mesh)
}

/// As [`check`], with threads.
pub fn check_on(team: Team<'_>, mesh: &TetMesh) -> Validity {
    let mut found = Findings { mesh, validity: Validity::default() };
    check_tets(&mut found);
    let faces = sorted_faces(&mesh.tets.nodes);
    let triangles = sorted_triangles(&mesh.triangles);
    let boundary = check_faces(&mut found, &faces, &triangles);
    check_boundary_edges(&mut found, &faces);
    check_tagged_edges(&mut found);
    check_vertices(&mut found, &faces);
    check_crossings(&mut found, team, boundary);
    found.validity
}

struct Findings<'a> {
    mesh: &'a TetMesh,
    validity: Validity,
}

impl Findings<'_> {
    /// Counts a flaw.
    fn add(&mut self, kind: FlawKind, index: Option<usize>, nodes: &[u32]) {
        let mesh = self.mesh;
        let flaw = self.flaw(kind);
        flaw.count += 1;
        if flaw.first.len() < NAMED {
            let sum = nodes.iter().fold([0.0; 3], |sum, &v| add(sum, mesh.vertices[v as usize]));
            let at: Vec3 = scale(sum, 1.0 / nodes.len() as f64);
            flaw.first.push(Offender { index, other: None, nodes: nodes.to_vec(), at });
        }
    }

    /// What was found of a kind.
    fn flaw(&mut self, kind: FlawKind) -> &mut Flaw {
        let flaws = &mut self.validity.flaws;
        let at = flaws.iter().position(|flaw| flaw.kind == kind).unwrap_or_else(|| {
            flaws.push(Flaw { kind, count: 0, first: Vec::new() });
            flaws.len() - 1
        });
        &mut flaws[at]
    }

    /// Counts all equal elements but the first of each.
    fn add_duplicates<const N: usize>(&mut self, kind: FlawKind, elements: &[[u32; N]]) {
        let mut keys: Vec<([u32; N], usize)> = elements.iter().copied().zip(0..).collect();
        for (key, _) in &mut keys {
            key.sort_unstable();
        }
        keys.sort_unstable();
        for pair in keys.windows(2) {
            if pair[0].0 == pair[1].0 {
                self.add(kind, Some(pair[1].1), &elements[pair[1].1]);
            }
        }
    }
}

fn repeats<const N: usize>(nodes: &[u32; N]) -> bool {
    (1..N).any(|i| nodes[..i].contains(&nodes[i]))
}

fn check_tets(found: &mut Findings) {
    let mesh = found.mesh;
    for (t, nodes) in mesh.tets.nodes.iter().enumerate() {
        if repeats(nodes) {
            found.add(FlawKind::RepeatedNodes, Some(t), nodes);
            continue;
        }
        let [a, b, c, d] = nodes.map(|v| mesh.vertices[v as usize]);
        let sign = orientation(a, b, c, d);
        if sign < 0.0 {
            found.add(FlawKind::InvertedTet, Some(t), nodes);
        } else if sign.is_nan() || sign == 0.0 {
            found.add(FlawKind::FlatTet, Some(t), nodes);
        }
    }
    found.add_duplicates(FlawKind::DuplicateTet, &mesh.tets.nodes);
    for (t, nodes) in mesh.triangles.nodes.iter().enumerate() {
        if repeats(nodes) {
            found.add(FlawKind::RepeatedNodes, Some(t), nodes);
        }
    }
    found.add_duplicates(FlawKind::DuplicateTriangle, &mesh.triangles.nodes);
}

/// Triangles by their sorted nodes, with their indices.
fn sorted_triangles(triangles: &Elements<3>) -> Vec<([u32; 3], u32)> {
    let mut keys: Vec<([u32; 3], u32)> = triangles.nodes.iter().map(|&nodes| sorted3(nodes)).zip(0..).collect();
    keys.sort_unstable();
    keys
}

/// Whether the nodes of a face of a tetrahedron, seen from outside, turn as their ascending order does.
fn is_even(mesh: &TetMesh, side: u32) -> bool {
    let tet = mesh.tets.nodes[side as usize / 4];
    let [a, b, c] = FACES[side as usize % 4].map(|i| tet[i]);
    let inversions = u8::from(a > b) + u8::from(a > c) + u8::from(b > c);
    inversions % 2 == 0
}

/// A face of one tetrahedron.
struct BoundaryFace {
    /// Its first triangle, or [`NONE`].
    triangle: u32,
    /// Nodes, so that the normal points outwards.
    nodes: [u32; 3],
}

/// Faces of the tetrahedra against each other and against the triangles. Returns those on the boundary.
fn check_faces(found: &mut Findings, faces: &[FaceKey], triangles: &[([u32; 3], u32)]) -> Vec<BoundaryFace> {
    let mesh = found.mesh;
    let mut boundary = Vec::new();
    let mut next = 0;
    for same in faces.chunk_by(|a, b| a.nodes == b.nodes) {
        let nodes = same[0].nodes;
        while next < triangles.len() && triangles[next].0 < nodes {
            found.add(FlawKind::LooseTriangle, Some(triangles[next].1 as usize), &triangles[next].0);
            next += 1;
        }
        let begin = next;
        while next < triangles.len() && triangles[next].0 == nodes {
            next += 1;
        }
        let tet = same[0].side as usize / 4;
        if same.len() == 1 {
            let triangle = triangles[begin..next].first().map_or(NONE, |triangle| triangle.1);
            let nodes = FACES[same[0].side as usize % 4].map(|i| mesh.tets.nodes[tet][i]);
            boundary.push(BoundaryFace { triangle, nodes });
        }
        match same {
            [_] if begin == next => found.add(FlawKind::OpenBoundary, Some(tet), &nodes),
            [_] => {}
            [a, b] => {
                if is_even(mesh, a.side) == is_even(mesh, b.side) {
                    found.add(FlawKind::FoldedFace, Some(tet), &nodes);
                }
            }
            _ => found.add(FlawKind::NonManifoldFace, Some(tet), &nodes),
        }
    }
    for (nodes, triangle) in &triangles[next..] {
        found.add(FlawKind::LooseTriangle, Some(*triangle as usize), nodes);
    }
    boundary
}

/// The boundary does not pass through itself. (Triangles inside cannot cross, since the tetrahedra on both sides are positive. Where
/// tetrahedra are inverted or flat there is no outside, and nothing is checked.)
fn check_crossings(found: &mut Findings, team: Team<'_>, mut boundary: Vec<BoundaryFace>) {
    let hinders = [FlawKind::RepeatedNodes, FlawKind::InvertedTet, FlawKind::FlatTet];
    if hinders.into_iter().any(|kind| found.validity.count(kind) > 0) {
        return;
    }
    boundary.sort_unstable_by_key(|face| (face.triangle, face.nodes));
    let nodes: Vec<[u32; 3]> = boundary.iter().map(|face| face.nodes).collect();
    let crossings = crossing::crossings(team, &nodes, |v| found.mesh.vertices[v as usize], NAMED);
    if crossings.count == 0 {
        return;
    }
    let flaw = found.flaw(FlawKind::CrossingTriangles);
    flaw.count = crossings.count;
    for crossing in crossings.first {
        let [a, b] = crossing.triangles.map(|i| &boundary[i]);
        let index = |face: &BoundaryFace| (face.triangle != NONE).then_some(face.triangle as usize);
        let nodes = [a.nodes, b.nodes].concat();
        flaw.first.push(Offender { index: index(a), other: index(b), nodes, at: crossing.at });
    }
}

/// The boundary of the tetrahedra is a surface: two faces at every edge. More may meet on a tagged edge, where bodies touch. Interior
/// surfaces may end anywhere and meet in any number, so they do not count.
fn check_boundary_edges(found: &mut Findings, faces: &[FaceKey]) {
    let mut edges: Vec<[u32; 2]> = Vec::new();
    for same in faces.chunk_by(|a, b| a.nodes == b.nodes) {
        if let [FaceKey { nodes: [a, b, c], .. }] = *same {
            edges.extend([[a, b], [b, c], [a, c]]);
        }
    }
    edges.sort_unstable();
    let tagged = sorted_edges(&found.mesh.edges);
    for same in edges.chunk_by(|a, b| a == b) {
        let legal =
            same.len() == 2 || same.len() % 2 == 0 && tagged.binary_search_by_key(&same[0], |edge| edge.0).is_ok();
        if !legal {
            found.add(FlawKind::NonManifoldEdge, None, &same[0]);
        }
    }
}

/// Edges by their sorted nodes, with their indices.
fn sorted_edges(edges: &Elements<2>) -> Vec<([u32; 2], usize)> {
    let mut keys: Vec<_> = edges.nodes.iter().map(|&[a, b]| [a.min(b), a.max(b)]).zip(0..).collect();
    keys.sort_unstable();
    keys
}

fn check_tagged_edges(found: &mut Findings) {
    if found.mesh.edges.is_empty() {
        return;
    }
    let edges = unique_edges(&found.mesh.tets.nodes);
    for (nodes, index) in sorted_edges(&found.mesh.edges) {
        if edges.binary_search(&nodes).is_err() {
            found.add(FlawKind::LooseEdge, Some(index), &nodes);
        }
    }
}

/// Every vertex has tetrahedra, and they are connected by faces.
fn check_vertices(found: &mut Findings, faces: &[FaceKey]) {
    let mesh = found.mesh;
    // A corner is a pair (tetrahedron, node): 4t + i. Corners of one vertex are joined across common faces.
    let mut corners = DisjointSets::new(4 * mesh.tets.len());
    for same in faces.chunk_by(|a, b| a.nodes == b.nodes) {
        for other in &same[1..] {
            for node in same[0].nodes {
                corners.join(corner_of(mesh, same[0].side, node), corner_of(mesh, other.side, node));
            }
        }
    }
    let mut group = vec![u32::MAX; mesh.vertices.len()];
    let mut pinched = vec![false; mesh.vertices.len()];
    for corner in 0..corners.count() as u32 {
        let vertex = mesh.tets.nodes[corner as usize / 4][corner as usize % 4] as usize;
        let part = corners.first(corner);
        pinched[vertex] |= group[vertex] != u32::MAX && group[vertex] != part;
        group[vertex] = part;
    }
    for vertex in 0..mesh.vertices.len() {
        if group[vertex] == u32::MAX {
            found.add(FlawKind::UnusedVertex, Some(vertex), &[vertex as u32]);
        } else if pinched[vertex] {
            found.add(FlawKind::NonManifoldVertex, Some(vertex), &[vertex as u32]);
        }
    }
}

fn corner_of(mesh: &TetMesh, side: u32, node: u32) -> u32 {
    let tet = side / 4;
    let at = mesh.tets.nodes[tet as usize].iter().position(|&v| v == node);
    4 * tet + at.unwrap_or(0) as u32
}

#[cfg(test)]
mod tests {
    use super::super::samples::{cube, with_boundary};
    use super::*;

    fn kinds(mesh: &TetMesh) -> Vec<FlawKind> {
        check(mesh).flaws.iter().map(|flaw| flaw.kind).collect()
    }

    #[test]
    fn a_good_mesh_has_no_flaw() {
        assert_eq!(check(&cube(3)), Validity::default());
    }

    #[test]
    fn inverted_and_flat_tets() {
        let mut mesh = cube(2);
        mesh.tets.nodes[5].swap(0, 1);
        let validity = check(&mesh);
        assert_eq!(validity.count(FlawKind::InvertedTet), 1);
        assert_eq!(validity.flaws[0].first[0].index, Some(5));
        // A vertex inside, moved into the plane of a face of one of its tets.
        let mut mesh = cube(2);
        let inner = mesh.vertices.iter().position(|&p| p == [0.5; 3]).unwrap();
        mesh.vertices[inner] = [0.5, 0.5, 0.0];
        assert!(check(&mesh).count(FlawKind::FlatTet) > 0);
    }

    #[test]
    fn holes_in_the_boundary() {
        let mut mesh = cube(2);
        mesh.triangles.nodes.pop();
        mesh.triangles.refs.pop();
        assert_eq!(kinds(&mesh), [FlawKind::OpenBoundary]);
        // A missing tet inside leaves four faces, or fewer on the boundary with as many loose triangles.
        let mut mesh = cube(3);
        mesh.tets.nodes.remove(40);
        mesh.tets.refs.remove(40);
        let validity = check(&mesh);
        assert_eq!(validity.count(FlawKind::OpenBoundary) + validity.count(FlawKind::LooseTriangle), 4);
    }

    #[test]
    fn things_that_are_there_twice() {
        let mut mesh = cube(2);
        let [a, b, c] = mesh.triangles.nodes[7];
        mesh.triangles.push([c, a, b], 1);
        assert_eq!(kinds(&mesh), [FlawKind::DuplicateTriangle]);
        let mut mesh = cube(2);
        mesh.tets.push(mesh.tets.nodes[3], 1);
        let kinds = kinds(&mesh);
        assert!(kinds.contains(&FlawKind::DuplicateTet) && kinds.contains(&FlawKind::NonManifoldFace), "{kinds:?}");
    }

    #[test]
    fn loose_things() {
        let mut mesh = cube(2);
        mesh.vertices.push([0.3; 3]);
        mesh.triangles.push([0, 13, 26], 1);
        mesh.edges.push([0, 25], 1);
        let expected = [FlawKind::LooseTriangle, FlawKind::LooseEdge, FlawKind::UnusedVertex];
        assert_eq!(kinds(&mesh), expected);
        let text = check(&mesh).flaws[2].to_string();
        assert_eq!(text, "1 unused vertices (of no tetrahedron): no. 28, nodes [28] at (0.300000, 0.300000, 0.300000)");
    }

    /// Two tetrahedra that share the nodes given.
    fn two_tets(second: [u32; 4]) -> TetMesh {
        let vertices = vec![
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
            [0.0, -1.0, 0.0],
            [0.0, 0.0, -1.0],
            [-1.0, 0.0, 0.0],
        ];
        with_boundary(vertices, vec![[0, 1, 2, 3], second])
    }

    #[test]
    fn tets_that_touch_in_a_point_or_an_edge() {
        assert_eq!(kinds(&two_tets([6, 0, 4, 5])), [FlawKind::NonManifoldVertex]);
        let mut mesh = two_tets([0, 1, 4, 5]);
        mesh.vertices[6] = [0.0, 0.0, -2.0];
        let found = check(&mesh);
        assert_eq!(found.count(FlawKind::NonManifoldEdge), 1);
        assert_eq!(found.count(FlawKind::NonManifoldVertex), 2);
        // Bodies may touch along a tagged edge.
        mesh.edges.push([1, 0], 1);
        assert_eq!(check(&mesh).count(FlawKind::NonManifoldEdge), 0);
    }

    /// Bodies that overlap, though each is well: the tip of one is in the other.
    #[test]
    fn bodies_that_cross() {
        let beside = |x: f64| {
            let cube = cube(1);
            let mut vertices = cube.vertices.clone();
            let tip = vertices.len() as u32;
            vertices.extend([[x, 0.4, 0.5], [2.0, 0.3, 0.3], [2.0, 0.6, 0.3], [2.0, 0.4, 0.8]]);
            let mut tets = cube.tets.nodes.clone();
            tets.push([tip, tip + 1, tip + 2, tip + 3]);
            with_boundary(vertices, tets)
        };
        assert_eq!(kinds(&beside(1.5)), []);
        assert_eq!(kinds(&beside(0.9)), [FlawKind::CrossingTriangles]);
        let found = check(&beside(0.9));
        // The tip's three sides, and the two halves of the cube's.
        let flaw = &found.flaws[0];
        assert!((3..=6).contains(&flaw.count), "{flaw}");
        for offender in &flaw.first {
            assert!((offender.at[0] - 1.0).abs() < 1e-6, "{offender:?}");
            let corner = beside(0.9).triangles.nodes[offender.other.unwrap()];
            assert_eq!(sorted3(corner), sorted3([offender.nodes[3], offender.nodes[4], offender.nodes[5]]));
        }
        assert!(flaw.to_string().contains("pairs of boundary triangles that cross: no. "), "{flaw}");
        assert_eq!(kinds(&beside(1.0)), [], "a tip on the side");
    }

    #[test]
    fn tets_on_the_same_side_of_a_face() {
        let mut mesh = two_tets([0, 1, 2, 4]);
        mesh.vertices[4] = [0.2, 0.2, 0.5];
        assert!(kinds(&mesh).contains(&FlawKind::FoldedFace));
        mesh.tets.nodes[1] = [0, 1, 2, 2];
        assert!(kinds(&mesh).contains(&FlawKind::RepeatedNodes));
    }

    #[test]
    fn an_interior_surface_is_legal() {
        let mut mesh = cube(2);
        let tet = mesh.tets.nodes[17];
        for face in FACES {
            let nodes = face.map(|i| tet[i]);
            if !mesh.triangles.nodes.iter().any(|&t| sorted3(t) == sorted3(nodes)) {
                mesh.triangles.push(nodes, 9);
            }
        }
        assert_eq!(check(&mesh), Validity::default());
    }
}
