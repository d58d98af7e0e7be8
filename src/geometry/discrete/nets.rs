//! The cubic patches of a surface: from normals at the vertices to curves along the edges, and from these to triangles.
use super::cubic::{CubicCurve, CubicTriangle, curve_at, straight};
use super::polyline::is_straight;
use super::sectors::Sectors;
use super::vertex_normals::{SectorShape, Surface, sector_shapes};
use crate::mesh::vector::{Vec3, add, area2, cross, dot, norm, scale, sub, unit};
use crate::tasks::{GRAIN, Team};

/// Cosine of the greatest angle between the normals at the ends of a curved edge.
const LEAST_TURN: f64 = 0.34;
/// Cosine of the greatest angle between a curve's tangents and its chord.
const LEAST_ALONG: f64 = 0.7;
/// Cosine of the greatest angle between a patch's normal and its triangle's.
const LEAST_FACING: f64 = 0.5;
/// How often curves are straightened where patches turn too far: inner ones twice, then ridges too.
const PASSES: usize = 4;

/// The patches of all triangles.
pub(crate) struct Nets {
    /// Per triangle its patch; none where it is flat with straight sides.
    pub of_triangle: Vec<Option<CubicTriangle>>,
    /// The curve of each ridge as given, straight where a patch asked for that.
    pub ridges: Vec<CubicCurve>,
    /// Sector of each corner of the triangles.
    pub sectors: Sectors,
    /// Normal and curvature at each sector.
    pub shapes: Vec<SectorShape>,
}

impl Nets {
    /// Of a surface with the curves of its ridges: `ridge_of` is the curve of each edge that is a ridge, which runs from the edge's first
    /// node to its second.
    pub fn new(team: Team<'_>, surface: &Surface, mut ridges: Vec<CubicCurve>, ridge_of: &[Option<u32>]) -> Self {
        let Surface { points, triangles, features, .. } = *surface;
        let sectors = Sectors::new(team, triangles, features);
        let (shapes, flat_triangles) = sector_shapes(team, surface, &sectors, &ridges, ridge_of);
        let edges = &features.edges;
        let mut is_bent: Vec<bool> = (0..edges.len())
            .map(|edge| {
                let beside = || edges.triangles(edge);
                ridge_of[edge].is_some()
                    || !beside().any(|t| flat_triangles[t] || surface.is_flat[features.patch[t] as usize])
            })
            .collect();
        let mut of_triangle = Vec::new();
        for pass in 0..PASSES {
            let curve = |edge: usize| {
                let nodes = edges.nodes[edge];
                let [a, b] = nodes.map(|v| points[v as usize]);
                match ridge_of[edge] {
                    Some(ridge) => ridges[ridge as usize],
                    None if is_bent[edge] => {
                        inner_curve([a, b], nodes.map(|v| shapes[sectors.at(edges, triangles, edge, v)].normal))
                    }
                    None => straight(a, b),
                }
            };
            let net = |t: usize| {
                let along = [0, 1, 2].map(|k| {
                    let edge = edges.of_side[3 * t + k] as usize;
                    let mut curve = curve(edge);
                    if edges.nodes[edge][0] != triangles[t][k] {
                        curve.reverse();
                    }
                    curve
                });
                if along.iter().all(is_straight) {
                    return None;
                }
                let mut net = CubicTriangle::within(&along);
                let normals = [0, 1, 2].map(|k| shapes[sectors.of_corner[3 * t + k] as usize].normal);
                net.lean([0, 1, 2].map(|k| middle_normal(&along[k], [normals[k], normals[(k + 1) % 3]])));
                Some(net)
            };
            of_triangle = team.map(GRAIN, triangles.len(), net);
            let turned = team.collect(GRAIN, triangles.len(), |range, turned| {
                let turns = |&t: &usize| of_triangle[t].is_some_and(|net: CubicTriangle| turns_too_far(&net));
                turned.extend(range.filter(turns));
            });
            if turned.is_empty() || pass + 1 == PASSES {
                break;
            }
            for t in turned {
                for &edge in &edges.of_side[3 * t..3 * t + 3] {
                    match ridge_of[edge as usize] {
                        None => is_bent[edge as usize] = false,
                        Some(ridge) if pass > 0 => {
                            let curve = &mut ridges[ridge as usize];
                            *curve = straight(curve[0], curve[3]);
                        }
                        Some(_) => {}
                    }
                }
            }
        }
        Self { of_triangle, ridges, sectors, shapes }
    }
}

/// The curve of an edge inside a face. Its derivatives at the ends are the chord in the tangent planes there, longer in the direction m in
/// which the normal turns: by 2/((1 + cos β) cos β), with 2β the angle between the normals. Then arcs of spheres and helices on cylinders
/// come out to the sixth order, and what is ruled stays straight.
fn inner_curve([a, b]: [Vec3; 2], normals: [Vec3; 2]) -> CubicCurve {
    let (turn, chord) = (dot(normals[0], normals[1]), sub(b, a));
    let is_smooth = turn > LEAST_TURN;
    if !is_smooth {
        return straight(a, b);
    }
    let cosine = (0.5 * (1.0 + turn)).sqrt();
    let longer = 2.0 / ((1.0 + cosine) * cosine) - 1.0;
    let change = sub(normals[1], normals[0]);
    let [first, last] = normals.map(|n| {
        let in_plane = |v: Vec3| sub(v, scale(n, dot(v, n)));
        let (along, toward) = (in_plane(chord), unit(in_plane(change)));
        scale(add(along, scale(toward, longer * dot(along, toward))), 1.0 / 3.0)
    });
    let keeps = |handle: Vec3| dot(handle, chord) > LEAST_ALONG * norm(handle) * norm(chord);
    if keeps(first) && keeps(last) { [a, add(a, first), sub(b, last), b] } else { straight(a, b) }
}

/// The normal in the middle of a curve: the mean of those at its ends, perpendicular to it. None where they do not fit together.
fn middle_normal(curve: &CubicCurve, normals: [Vec3; 2]) -> Option<Vec3> {
    let along = unit(curve_at(curve, 0.5)[1]);
    let mean = unit(add(normals[0], normals[1]));
    let normal = sub(mean, scale(along, dot(mean, along)));
    (dot(normals[0], normals[1]) > LEAST_TURN && norm(normal) > LEAST_FACING).then(|| unit(normal))
}

/// Whether a patch's normal somewhere leaves that of its triangle too far.
fn turns_too_far(net: &CubicTriangle) -> bool {
    const AT: [[f64; 3]; 7] = [
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.5, 0.5, 0.0],
        [0.0, 0.5, 0.5],
        [0.5, 0.0, 0.5],
        [1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0],
    ];
    let [a, b, c] = net.corners;
    let facet = unit(area2(a, b, c));
    AT.iter().any(|&weights| {
        let [v, w] = net.at(weights).first;
        let normal = cross(v, w);
        let faces = dot(normal, facet) > LEAST_FACING * norm(normal);
        !faces
    })
}
