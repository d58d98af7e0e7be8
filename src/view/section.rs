//! A cut along the plane itself: the polygons in which the plane meets tetrahedra, and what of triangles and edges is behind it.
//!
//! ```text
//!        d                a behind the plane, b, c and d in front: a triangle.
//!      / | \              a and b behind, c and d in front: a quadrilateral, as two triangles
//!  ───+──+──+── plane     with the diagonal from ac to bd.
//!    a───b───c
//! ```
use super::cut::Plane;
use crate::mesh::vector::{Vec3, dot, lerp};
use crate::tasks::{GRAIN, Team};

/// A point on the edge between two vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// The vertices; the same twice for a vertex itself.
    pub ends: [u32; 2],
    /// How far it is from the first to the second, from 0 to 1.
    pub t: f64,
}

impl Corner {
    fn of_vertex(v: u32) -> Self {
        Self { ends: [v, v], t: 0.0 }
    }

    /// The point.
    pub fn point(&self, vertices: &[Vec3]) -> Vec3 {
        let [a, b] = self.ends.map(|v| vertices[v as usize]);
        lerp(a, b, self.t)
    }

    /// The value there of a field at vertices.
    pub fn value(&self, values: &[f32]) -> f32 {
        let [a, b] = self.ends.map(|v| values[v as usize]);
        a + self.t as f32 * (b - a)
    }
}

/// What a piece belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Of {
    /// A triangle of the surface.
    Triangle(u32),
    /// A tetrahedron.
    Tet(u32),
}

/// A triangle of a polygon.
#[derive(Clone, Copy, Debug)]
pub struct Piece {
    /// Its corners.
    pub corners: [Corner; 3],
    /// What it belongs to.
    pub of: Of,
    /// A bit for each side, opposite to the corner of that number, that is a side of the polygon.
    pub sides: u8,
}

/// Distances of the vertices from the plane, negative behind it.
pub struct Heights(pub Vec<f64>);

impl Heights {
    /// Of a mesh's vertices.
    pub fn of(team: Team<'_>, vertices: &[Vec3], plane: Plane) -> Self {
        Self(team.map(GRAIN, vertices.len(), |v| dot(plane.normal, vertices[v]) - plane.offset))
    }

    fn at(&self, v: u32) -> f64 {
        self.0[v as usize]
    }

    /// The point of the plane between a vertex behind it and one that is not.
    fn between(&self, behind: u32, front: u32) -> Corner {
        let (a, b) = (self.at(behind), self.at(front));
        Corner { ends: [behind, front], t: a / (a - b) }
    }

    /// Vertices behind the plane, then the others.
    fn parted<const N: usize>(&self, nodes: [u32; N]) -> (Vec<u32>, Vec<u32>) {
        nodes.into_iter().partition(|&v| self.at(v) < 0.0)
    }

    /// Appends the polygon in which the plane meets a tetrahedron.
    pub fn cut_tet(&self, tet: u32, nodes: [u32; 4], pieces: &mut Vec<Piece>) {
        let (behind, front) = self.parted(nodes);
        match (&behind[..], &front[..]) {
            (&[a], &[b, c, d]) => push(pieces, Of::Tet(tet), &[b, c, d].map(|v| self.between(a, v))),
            (&[a, b, c], &[d]) => push(pieces, Of::Tet(tet), &[a, b, c].map(|v| self.between(v, d))),
            (&[a, b], &[c, d]) => {
                push(pieces, Of::Tet(tet), &[[a, c], [a, d], [b, d], [b, c]].map(|[p, q]| self.between(p, q)));
            }
            _ => {}
        }
    }

    /// Appends the part of a triangle that is behind the plane, where it goes through. Returns whether all of it is behind.
    pub fn clip_triangle(&self, triangle: u32, nodes: [u32; 3], pieces: &mut Vec<Piece>) -> bool {
        let (behind, front) = self.parted(nodes);
        let (of, vertex) = (Of::Triangle(triangle), Corner::of_vertex);
        match (&behind[..], &front[..]) {
            (&[a], &[b, c]) => push(pieces, of, &[vertex(a), self.between(a, b), self.between(a, c)]),
            (&[a, b], &[c]) => push(pieces, of, &[vertex(a), vertex(b), self.between(b, c), self.between(a, c)]),
            _ => {}
        }
        front.is_empty()
    }

    /// The part of an edge that is behind the plane.
    pub fn clip_edge(&self, [a, b]: [u32; 2]) -> Option<[Corner; 2]> {
        match [a, b].map(|v| self.at(v) < 0.0) {
            [true, true] => Some([a, b].map(Corner::of_vertex)),
            [true, false] => Some([Corner::of_vertex(a), self.between(a, b)]),
            [false, true] => Some([self.between(b, a), Corner::of_vertex(b)]),
            [false, false] => None,
        }
    }
}

/// Appends a triangle, or a quadrilateral as two.
fn push(pieces: &mut Vec<Piece>, of: Of, polygon: &[Corner]) {
    match *polygon {
        [a, b, c] => pieces.push(Piece { corners: [a, b, c], of, sides: 0b111 }),
        [a, b, c, d] => {
            pieces.push(Piece { corners: [a, b, c], of, sides: 0b101 });
            pieces.push(Piece { corners: [a, c, d], of, sides: 0b011 });
        }
        _ => {}
    }
}

/// The lines on which a field has one of these values, on a piece: ends as shares of its corners.
pub fn isolines(values: [f32; 3], levels: &[f32], mut found: impl FnMut([[f32; 3]; 2])) {
    let [low, high] = [f32::min, f32::max].map(|f| values.into_iter().reduce(f).unwrap_or(f32::NAN));
    if values.iter().any(|value| !value.is_finite()) {
        return;
    }
    let first = levels.partition_point(|&level| level < low);
    for &level in levels[first..].iter().take_while(|&&level| level <= high) {
        let mut ends = Vec::with_capacity(2);
        for (i, j) in [(0, 1), (1, 2), (2, 0)] {
            // Each value counts as above or below, so that a line ends on two sides or on none.
            if (values[i] < level) != (values[j] < level) {
                let t = (level - values[i]) / (values[j] - values[i]);
                let mut at = [0.0; 3];
                (at[i], at[j]) = (1.0 - t, t);
                ends.push(at);
            }
        }
        if let [a, b] = ends[..] {
            found([a, b]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::samples::cube;
    use crate::mesh::vector::{area2, norm};

    fn area(piece: &Piece, vertices: &[Vec3]) -> f64 {
        let [a, b, c] = piece.corners.map(|corner| corner.point(vertices));
        0.5 * norm(area2(a, b, c))
    }

    #[test]
    fn the_section_of_a_cube_is_whole_and_lies_in_the_plane() {
        let mesh = cube(4);
        // x + y = 0.9: a rectangle of √2 · 0.9 by 1.
        for (text, expected) in [("x=0.3", 1.0), ("x=0.5", 1.0), ("1,1,0=0.9", 2.0f64.sqrt() * 0.9)] {
            let plane: Plane = text.parse().unwrap();
            let heights = Heights::of(Team::alone(), &mesh.vertices, plane);
            let mut pieces = Vec::new();
            (0..).zip(&mesh.tets.nodes).for_each(|(tet, &nodes)| heights.cut_tet(tet, nodes, &mut pieces));
            let sum: f64 = pieces.iter().map(|piece| area(piece, &mesh.vertices)).sum();
            assert!((sum - expected).abs() < 1e-12, "{text}: {sum}");
            let x: Vec<f32> = mesh.vertices.iter().map(|p| p[0] as f32).collect();
            for corner in pieces.iter().flat_map(|piece| piece.corners) {
                let p = corner.point(&mesh.vertices);
                assert!((dot(plane.normal, p) - plane.offset).abs() < 1e-14, "{p:?}");
                assert!((f64::from(corner.value(&x)) - p[0]).abs() < 1e-6, "{p:?}");
            }
        }
    }

    #[test]
    fn of_the_surface_what_is_behind_is_left() {
        let mesh = cube(3);
        let plane: Plane = "x=0.4".parse().unwrap();
        let heights = Heights::of(Team::alone(), &mesh.vertices, plane);
        let mut pieces = Vec::new();
        let mut sum = 0.0;
        for (t, &nodes) in (0..).zip(&mesh.triangles.nodes) {
            if heights.clip_triangle(t, nodes, &mut pieces) {
                let [a, b, c] = nodes.map(|v| mesh.vertices[v as usize]);
                sum += 0.5 * norm(area2(a, b, c));
            }
        }
        assert!(pieces.iter().any(|piece| piece.sides != 0b111));
        sum += pieces.iter().map(|piece| area(piece, &mesh.vertices)).sum::<f64>();
        assert!((sum - (1.0 + 4.0 * 0.4)).abs() < 1e-12, "{sum}");
        let [a, b] = heights.clip_edge([0, 3]).unwrap();
        let length = norm(crate::mesh::vector::sub(a.point(&mesh.vertices), b.point(&mesh.vertices)));
        assert!((0.0..=1.0).contains(&length));
    }

    #[test]
    fn isolines_are_where_the_value_is() {
        let values = [0.0, 1.0, 2.0];
        let mut found = Vec::new();
        isolines(values, &[-1.0, 0.5, 1.0, 1.5, 3.0], |ends| found.push(ends));
        assert_eq!(found.len(), 3);
        let at = |shares: [f32; 3]| (0..3).map(|i| shares[i] * values[i]).sum::<f32>();
        for (ends, level) in found.iter().zip([0.5, 1.0, 1.5]) {
            assert!(ends.iter().all(|&end| (at(end) - level).abs() < 1e-6), "{level}");
        }
        isolines([f32::NAN, 0.0, 1.0], &[0.5], |_| panic!("no value, no line"));
    }
}
