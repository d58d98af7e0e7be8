//! A metric beside triangles that stay as they are: there it has their sizes, and from there the sizes go over into those that are asked for.
//!
//! No metric can change such a triangle, and a tetrahedron on it is good only where the metric agrees with it. So at its vertices the metric is,
//! along the surface, the one in which the triangles have edges of length one, and across it the one that is asked for, within bounds.
use super::gradation::grade_again;
use super::{Eigen, Sym3};
use crate::mesh::TetMesh;
use crate::mesh::vector::{Vec3, area2, cross, distance, dot, norm, scale, sub};
use crate::mesh::vertex_neighbours::VertexNeighbours;
use crate::tasks::Team;
use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

/// What fitting did.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Fitted {
    /// Vertices of the triangles.
    pub vertices: usize,
    /// Vertices beside them that were given larger sizes, since sizes may not fall faster than they may grow.
    pub coarser: usize,
    /// Vertices beside them that were given smaller sizes.
    pub finer: usize,
}

/// Fits ln M at the vertices of a mesh, shape (n,), to triangles of its boundary that stay as they are. Beside them sizes grow by the `ratio` from
/// an edge to the next at most, and fall as fast.
pub fn fit(team: Team<'_>, mesh: &TetMesh, triangles: &[[u32; 3]], logs: &mut [Sym3], ratio: f64) -> Fitted {
    let around = VertexNeighbours::of_mesh(team, mesh);
    let mut at: BTreeMap<u32, Vec<[Vec3; 3]>> = BTreeMap::new();
    for &nodes in triangles {
        let corners = nodes.map(|v| mesh.vertices[v as usize]);
        nodes.iter().for_each(|&v| at.entry(v).or_default().push(corners));
    }
    let fitted: BTreeMap<u32, Sym3> =
        at.iter().map(|(&v, triangles)| (v, at_vertex(triangles, &logs[v as usize], ratio))).collect();
    let coarser = coarsen(mesh, &around, &fitted, logs, ratio);
    fitted.iter().for_each(|(&v, log)| logs[v as usize] = *log);
    let vertices: Vec<u32> = fitted.keys().copied().collect();
    let finer = grade_again(team, &mesh.vertices, &around, logs, (ratio, &vertices)).changed;
    // Triangles beside each other may differ by more than the ratio.
    fitted.iter().for_each(|(&v, log)| logs[v as usize] = *log);
    Fitted { vertices: vertices.len(), coarser, finer }
}

/// ln M at a vertex of triangles, where `asked` is wanted: along the surface the mean of their metrics, across it what is asked for, but no more than
/// the ratio times the size along it, and no less than what the triangles rise out of the plane: else their edges would be long.
fn at_vertex(triangles: &[[Vec3; 3]], asked: &Sym3, ratio: f64) -> Sym3 {
    let normals = triangles.iter().map(|&[a, b, c]| area2(a, b, c));
    let normal = normals
        .fold(Sym3::ZERO, |sum, n| sum.plus(Sym3::outer(n, 1.0 / norm(n).max(f64::MIN_POSITIVE))))
        .eigen()
        .vectors[2];
    let (sum, area) = triangles.iter().fold((Sym3::ZERO, 0.0), |(sum, all), &triangle| {
        let area = norm(area2(triangle[0], triangle[1], triangle[2]));
        (sum.plus(in_plane(triangle).ln().times(area)), all + area)
    });
    let along = without(&sum.times(1.0 / area).exp(), normal);
    let [_, least, _] = along.eigen().values;
    let edges = triangles.iter().flat_map(|&[a, b, c]| [sub(b, a), sub(c, b), sub(a, c)]);
    let rise = edges.map(|edge| dot(edge, normal).abs()).fold(0.0, f64::max);
    let wanted = asked.exp().quadratic(normal).sqrt().recip();
    let across = wanted.min(ratio / least.sqrt()).max(rise);
    along.plus(Sym3::outer(normal, 1.0 / (across * across))).ln()
}

/// A metric in which all edges of a triangle have length one, with their mean size across it: in the plane ½ Σ ∇λ_i ∇λ_iᵀ, λ_i the barycentric
/// coordinates, as of a tetrahedron ([`super::implied::unit_metric`]).
fn in_plane([a, b, c]: [Vec3; 3]) -> Sym3 {
    let normal = area2(a, b, c);
    let area = norm(normal);
    let gradients = [sub(c, b), sub(a, c), sub(b, a)].map(|edge| scale(cross(normal, edge), 1.0 / (area * area)));
    let sum = gradients.into_iter().fold(Sym3::ZERO, |sum, gradient| sum.plus(Sym3::outer(gradient, 0.5)));
    // An equilateral triangle of edge h has √3/2 h² as twice its area.
    let square = area * 2.0 / 3f64.sqrt();
    sum.plus(Sym3::outer(scale(normal, 1.0 / area), 1.0 / square))
}

/// M in the plane across a unit normal: P M P, P = I − n nᵀ.
fn without(m: &Sym3, normal: Vec3) -> Sym3 {
    let applied = m.apply(normal);
    let mixed = |i: usize, j: usize| {
        m.at(i, j) - normal[i] * applied[j] - applied[i] * normal[j] + m.quadratic(normal) * normal[i] * normal[j]
    };
    Sym3([mixed(0, 0), mixed(0, 1), mixed(1, 1), mixed(0, 2), mixed(1, 2), mixed(2, 2)])
}

/// A length that orders a heap.
#[derive(Clone, Copy, PartialEq)]
struct Length(f64);

impl Eq for Length {}

impl PartialOrd for Length {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Length {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}

/// Enlarges sizes near the fitted vertices: a size h there is h − (1 − 1/r) d at the distance d at least. Returns at how many vertices.
fn coarsen(
    mesh: &TetMesh,
    around: &VertexNeighbours,
    fitted: &BTreeMap<u32, Sym3>,
    logs: &mut [Sym3],
    ratio: f64,
) -> usize {
    let slope = 1.0 - 1.0 / ratio;
    let eigen: BTreeMap<u32, Eigen> = fitted.iter().map(|(&v, log)| (v, log.eigen())).collect();
    // The nearest fitted vertex, along edges.
    let mut from: Vec<u32> = vec![u32::MAX; logs.len()];
    let mut way = vec![f64::INFINITY; logs.len()];
    let mut heap: BinaryHeap<Reverse<(Length, u32, u32)>> =
        fitted.keys().map(|&v| Reverse((Length(0.0), v, v))).collect();
    fitted.keys().for_each(|&v| way[v as usize] = 0.0);
    let mut coarser = 0;
    while let Some(Reverse((Length(length), v, source))) = heap.pop() {
        if from[v as usize] != u32::MAX {
            continue;
        }
        from[v as usize] = source;
        let far = distance(mesh.vertices[v as usize], mesh.vertices[source as usize]);
        let of_source = eigen[&source];
        let sizes = of_source.values.map(|x| (-0.5 * x).exp());
        let left = sizes.map(|h| h - slope * far);
        if left.iter().all(|&h| h <= 0.0) {
            continue;
        }
        if length > 0.0 {
            // In directions in which nothing bounds them sizes may be as small as they like.
            let values = [0, 1, 2].map(|i| -2.0 * left[i].max(FREE * sizes[i]).ln());
            let bound = Sym3::from_eigen(&Eigen { values, ..of_source });
            let log = &mut logs[v as usize];
            let before = log.trace();
            // The least metric that is no coarser than both: the inverse of the intersection of the inverses.
            *log = log.times(-1.0).intersect_logs(&bound.times(-1.0)).times(-1.0);
            coarser += usize::from(before - log.trace() > CHANGE);
        }
        for &next in around.of_vertex(v) {
            let length = length + distance(mesh.vertices[v as usize], mesh.vertices[next as usize]);
            if length < way[next as usize] {
                way[next as usize] = length;
                heap.push(Reverse((Length(length), next, source)));
            }
        }
    }
    coarser
}

/// Share of a size that bounds nothing.
const FREE: f64 = 1e-6;

/// A change of ln det M that is none.
const CHANGE: f64 = 1e-6;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::samples::cube;

    #[test]
    fn a_triangle_has_edges_of_length_one_in_its_metric() {
        let triangle = [[0.0, 0.0, 1.0], [2.0, 0.0, 1.0], [0.5, 0.3, 1.0]];
        let m = in_plane(triangle);
        for [i, j] in [[0, 1], [1, 2], [2, 0]] {
            assert!((m.quadratic(sub(triangle[i], triangle[j])) - 1.0).abs() < 1e-12);
        }
        // Twice its area is 0.6.
        assert!((m.sqrt_det() - (3f64.sqrt() / 1.2).powf(1.5)).abs() < 1e-9, "{}", m.sqrt_det());
    }

    #[test]
    fn sizes_along_are_those_of_the_triangles_and_go_over_into_those_asked_for() {
        let mesh = cube(8);
        let bottom: Vec<[u32; 3]> =
            mesh.triangles.iter().filter(|(_, side)| *side == 5).map(|(nodes, _)| nodes).collect();
        for asked in [1.0, 0.01] {
            let size = |h: f64| Sym3::ZERO.plus_identity(-2.0 * f64::ln(h));
            let mut logs = vec![size(asked); mesh.vertices.len()];
            let fitted = fit(Team::alone(), &mesh, &bottom, &mut logs, 1.5);
            assert_eq!(fitted.vertices, 81);
            for (p, log) in mesh.vertices.iter().zip(&logs) {
                let along = |e: Vec3| log.exp().quadratic(e).sqrt().recip();
                let [x, z] = [along([1.0, 0.0, 0.0]), along([0.0, 0.0, 1.0])];
                if p[2] == 0.0 {
                    // Halves of squares: legs of 1/8.
                    assert!((0.1..0.18).contains(&x), "{x}");
                    assert!((0.01 - 1e-9..0.27).contains(&z) && (asked == 1.0 || z < 0.0101), "{z}");
                } else if p[2] == 0.125 {
                    assert!(if asked == 1.0 { x < 0.3 } else { x > 0.06 }, "{x}");
                } else if p[2] == 1.0 && asked < 1.0 {
                    assert!((x / asked - 1.0).abs() < 1e-9, "{x}");
                }
            }
        }
    }
}
