//! What has to do with neighbours, vertex by vertex: each is checked with all tetrahedra at it, its star. What belongs to several vertices,
//! such as a face, is told at the least of them, so the order is that of the sorted nodes.
use super::super::adjacency::{FACES, NONE, sorted2};
use super::super::{FlawKind, TetMesh};
use super::{BoundaryFace, Found, Keyed, Tagged};
use crate::tasks::{Rows, Team};
use std::ops::Range;

/// Vertices a task.
const GRAIN: usize = 1 << 10;

/// For each node of a tetrahedron the faces at it, each with its two other nodes.
const AROUND: [[(usize, [usize; 2]); 3]; 4] = [
    [(1, [2, 3]), (2, [1, 3]), (3, [1, 2])],
    [(0, [2, 3]), (2, [0, 3]), (3, [0, 2])],
    [(0, [1, 3]), (1, [0, 3]), (3, [0, 1])],
    [(0, [1, 2]), (1, [0, 2]), (2, [0, 1])],
];

/// Some vertices of a mesh with all tetrahedra at them, maybe with numbers of their own.
pub struct Stars<'m> {
    /// The tetrahedra in the order of the mesh, fewer than 2³⁰.
    pub tets: &'m [[u32; 4]],
    /// Their numbers in the whole mesh, shape (t,), ascending; none where they are the same.
    pub tet_numbers: Option<&'m [u32]>,
    /// The vertices' numbers in the whole mesh, shape (n,), ascending; none where they are the same.
    pub numbers: Option<&'m [u32]>,
    /// The vertices that are checked: no tetrahedron at them is missing. In the whole mesh too they follow one another.
    pub own: Range<u32>,
}

/// What is found at vertices.
#[derive(Clone, Debug, Default)]
pub struct OfStars {
    /// Tetrahedra that are there twice.
    pub twice: Found,
    /// Flaws of faces and triangles.
    pub faces: Found,
    /// Tagged edges that are no edges.
    pub edges: Found,
    /// Flaws of vertices.
    pub vertices: Found,
    /// The faces of one tetrahedron, by their sorted nodes.
    pub boundary: Vec<BoundaryFace>,
}

impl OfStars {
    /// Takes in what was found at the vertices that follow.
    pub fn extend(&mut self, later: Self) {
        let join = |found: &mut Found, later| *found = std::mem::take(found).and(later);
        join(&mut self.twice, later.twice);
        join(&mut self.faces, later.faces);
        join(&mut self.edges, later.edges);
        join(&mut self.vertices, later.vertices);
        self.boundary.extend(later.boundary);
    }
}

impl<'m> Stars<'m> {
    /// All of a mesh.
    pub fn whole(mesh: &'m TetMesh) -> Self {
        Self { tets: &mesh.tets.nodes, tet_numbers: None, numbers: None, own: 0..mesh.vertices.len() as u32 }
    }

    /// Checks the vertices. Each edge of the tetrahedra at them whose lower node is one of them is shown to `edge` once, with what this has
    /// gathered of its task, from `nothing`; those come back in the order of the vertices.
    pub fn check<M: Clone + Send + Sync>(
        &self,
        team: Team<'_>,
        tagged: &Tagged,
        nothing: &M,
        edge: impl Fn(&mut M, [u32; 2]) + Sync,
    ) -> (OfStars, Vec<M>) {
        let count = self.own.len();
        let rows = Rows::by_key::<4>(team, count, self.tets.len(), |t| {
            self.tets[t].map(|v| if self.own.contains(&v) { v - self.own.start } else { Rows::NOWHERE })
        });
        let parts = team.chunks(GRAIN, count, |range| {
            let (mut star, mut found, mut gathered) = (Star::default(), OfStars::default(), nothing.clone());
            let mut tagged = TaggedFrom::new(tagged, self.number(self.own.start + range.start as u32));
            for place in range {
                let v = self.own.start + place as u32;
                let (triangles, edges) = tagged.next();
                star.gather(v, rows.row(place), self.tets);
                star.check_twice(self, &mut found.twice);
                star.check_faces(self, triangles, &mut found);
                star.check_edges(self, edges, &mut found.edges);
                star.check_vertex(self, &mut found.vertices);
                star.upper.iter().for_each(|&high| edge(&mut gathered, [v, high]));
            }
            (found, gathered)
        });
        let (mut all, mut gathered) = (OfStars::default(), Vec::with_capacity(parts.len()));
        for (found, part) in parts {
            all.extend(found);
            gathered.push(part);
        }
        (all, gathered)
    }

    /// A vertex's number in the whole mesh.
    fn number(&self, v: u32) -> u32 {
        // After the last vertex none is asked for.
        self.numbers.map_or(v, |numbers| numbers.get(v as usize).copied().unwrap_or(NONE))
    }

    /// A tetrahedron's number in the whole mesh.
    fn tet_number(&self, tet: usize) -> usize {
        self.tet_numbers.map_or(tet, |numbers| numbers[tet] as usize)
    }

    /// Whether the nodes of a face of a tetrahedron, seen from outside, turn as their ascending order does.
    fn is_even(&self, side: usize) -> bool {
        let [a, b, c] = FACES[side % 4].map(|i| self.tets[side / 4][i]);
        let inversions = u8::from(a > b) + u8::from(a > c) + u8::from(b > c);
        inversions % 2 == 0
    }
}

/// What is tagged, by its least node, from a vertex on.
struct TaggedFrom<'t> {
    v: u32,
    triangles: &'t [Keyed<3>],
    edges: &'t [Keyed<2>],
}

impl<'t> TaggedFrom<'t> {
    fn new(tagged: &'t Tagged, v: u32) -> Self {
        let triangles = &tagged.triangles[tagged.triangles.partition_point(|(nodes, _)| nodes[0] < v)..];
        let edges = &tagged.edges[tagged.edges.partition_point(|(nodes, _)| nodes[0] < v)..];
        Self { v, triangles, edges }
    }

    /// The triangles and edges of the next vertex.
    fn next(&mut self) -> (&'t [Keyed<3>], &'t [Keyed<2>]) {
        let v = self.v;
        let triangles = self.triangles.iter().take_while(|(nodes, _)| nodes[0] == v).count();
        let edges = self.edges.iter().take_while(|(nodes, _)| nodes[0] == v).count();
        let found = (&self.triangles[..triangles], &self.edges[..edges]);
        (self.triangles, self.edges) = (&self.triangles[triangles..], &self.edges[edges..]);
        self.v = v.wrapping_add(1);
        found
    }
}

/// A face at the vertex, of one tetrahedron.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Half {
    /// Its two other nodes, ascending: the lower one in the upper bits.
    key: u64,
    /// 4·tet + face.
    side: u32,
    /// Of the vertex in the tetrahedron: a place in the row.
    corner: u32,
}

impl Half {
    fn others(self) -> [u32; 2] {
        [(self.key >> 32) as u32, self.key as u32]
    }
}

/// A vertex with its tetrahedra.
#[derive(Default)]
struct Star {
    v: u32,
    /// The faces at it, sorted.
    halves: Vec<Half>,
    /// Its neighbours with greater numbers, ascending.
    upper: Vec<u32>,
    /// The other nodes, ascending, of the tetrahedra of which it is the least node; and the tetrahedron.
    tets: Vec<([u32; 3], u32)>,
    /// The corners that are joined across faces (disjoint sets): for each one of its set.
    above: Vec<u32>,
}

impl Star {
    /// Takes a vertex, with its row of 4·tet + node.
    fn gather(&mut self, v: u32, row: &[u32], tets: &[[u32; 4]]) {
        self.v = v;
        self.halves.clear();
        self.upper.clear();
        self.tets.clear();
        self.above.clear();
        self.above.extend(0..row.len() as u32);
        let mut first = 0;
        for (place, &entry) in row.iter().enumerate() {
            let (tet, k) = (entry / 4, entry as usize % 4);
            let nodes = tets[tet as usize];
            if row[first] / 4 != tet || place == 0 {
                first = place;
                self.upper.extend(nodes.into_iter().filter(|&other| other > v));
                if nodes.iter().all(|&other| v <= other) {
                    let mut nodes = nodes;
                    nodes.sort_unstable();
                    self.tets.push(([nodes[1], nodes[2], nodes[3]], tet));
                }
            }
            for (face, [i, j]) in AROUND[k] {
                // A face of a tetrahedron that names v twice may have been seen from its first node.
                if row[first..place].iter().any(|&before| before as usize % 4 != face) {
                    continue;
                }
                let [b, c] = sorted2([nodes[i], nodes[j]]);
                let key = u64::from(b) << 32 | u64::from(c);
                self.halves.push(Half { key, side: 4 * tet + face as u32, corner: first as u32 });
            }
        }
        self.halves.sort_unstable();
        self.upper.sort_unstable();
        self.upper.dedup();
    }

    fn check_twice(&mut self, stars: &Stars<'_>, found: &mut Found) {
        self.tets.sort_unstable();
        for pair in self.tets.windows(2) {
            if pair[0].0 == pair[1].0 {
                let tet = pair[1].1 as usize;
                let nodes = stars.tets[tet].map(|v| stars.number(v));
                found.add(FlawKind::DuplicateTet, Some(stars.tet_number(tet)), &nodes);
            }
        }
    }

    /// Faces of the tetrahedra against each other and against the triangles, and which corners they join.
    fn check_faces(&mut self, stars: &Stars<'_>, triangles: &[Keyed<3>], found: &mut OfStars) {
        let (v, above) = (self.v, &mut self.above);
        let mut next = 0;
        for same in self.halves.chunk_by(|a, b| a.key == b.key) {
            same[1..].iter().for_each(|other| join(above, same[0].corner, other.corner));
            let [b, c] = same[0].others();
            if b < v || same.len() == 2 && next == triangles.len() && are_opposite(stars, same) {
                continue;
            }
            let nodes = [v, b, c].map(|v| stars.number(v));
            while next < triangles.len() && triangles[next].0 < nodes {
                found.faces.add(FlawKind::LooseTriangle, Some(triangles[next].1 as usize), &triangles[next].0);
                next += 1;
            }
            let begin = next;
            while next < triangles.len() && triangles[next].0 == nodes {
                next += 1;
            }
            let (tet, face) = (same[0].side as usize / 4, same[0].side as usize % 4);
            let tet_number = Some(stars.tet_number(tet));
            if same.len() == 1 {
                let triangle = triangles[begin..next].first().map_or(NONE, |triangle| triangle.1);
                let nodes = FACES[face].map(|i| stars.number(stars.tets[tet][i]));
                found.boundary.push(BoundaryFace { triangle, nodes });
            }
            match same {
                [_] if begin == next => found.faces.add(FlawKind::OpenBoundary, tet_number, &nodes),
                [_] => {}
                [_, _] if are_opposite(stars, same) => {}
                [_, _] => found.faces.add(FlawKind::FoldedFace, tet_number, &nodes),
                _ => found.faces.add(FlawKind::NonManifoldFace, tet_number, &nodes),
            }
        }
        for (nodes, triangle) in &triangles[next..] {
            found.faces.add(FlawKind::LooseTriangle, Some(*triangle as usize), nodes);
        }
    }

    fn check_edges(&self, stars: &Stars<'_>, edges: &[Keyed<2>], found: &mut Found) {
        for ([low, high], index) in edges {
            if self.upper.binary_search_by_key(high, |&v| stars.number(v)).is_err() {
                found.add(FlawKind::LooseEdge, Some(*index as usize), &[*low, *high]);
            }
        }
    }

    /// Every vertex has tetrahedra, and they are connected by faces.
    fn check_vertex(&mut self, stars: &Stars<'_>, found: &mut Found) {
        let v = stars.number(self.v);
        let above = &mut self.above;
        if above.is_empty() {
            found.add(FlawKind::UnusedVertex, Some(v as usize), &[v]);
        } else if (1..above.len() as u32).any(|corner| first(above, corner) != first(above, 0)) {
            found.add(FlawKind::NonManifoldVertex, Some(v as usize), &[v]);
        }
    }
}

/// Whether two tetrahedra lie on different sides of their common face.
fn are_opposite(stars: &Stars<'_>, same: &[Half]) -> bool {
    stars.is_even(same[0].side as usize) != stars.is_even(same[1].side as usize)
}

/// The first corner of a corner's set; halves the way to it.
fn first(above: &mut [u32], mut corner: u32) -> u32 {
    while above[corner as usize] != corner {
        above[corner as usize] = above[above[corner as usize] as usize];
        corner = above[corner as usize];
    }
    corner
}

fn join(above: &mut [u32], a: u32, b: u32) {
    let (a, b) = (first(above, a), first(above, b));
    above[a.max(b) as usize] = a.min(b);
}
