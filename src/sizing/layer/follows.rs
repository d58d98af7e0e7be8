//! How thick the layers along a curved wall must be for a mesh to follow the wall.
use super::foot::Foot;
use super::growth::{Growth, Outside};
use super::metric::Asked;
use crate::geometry::classify::Classification;
use crate::geometry::{Evaluator, Geometry, Model};
use crate::mesh::TetMesh;
use crate::mesh::vector::{Vec3, add, dot, norm, scale, sub};
use crate::sizing::walls::own_faces;
use crate::tasks::Team;

/// A mesh follows a wall where its edges rise by no more than so many first heights.
const RISE: f64 = 2.0;
/// Edges follow the wall, too, that are no longer than this in the metric of the layers along it: their middles rise by six heights at most where sizes
/// are half the chord of one height, and no others could take their place.
const LONG: f64 = 5.0;
/// A mesh may have this share of edges on curved walls that do not follow them: at the tip of a wing those of few vertices.
const FEW: f64 = 1e-3;
/// Layers are made thicker by powers of ten.
pub const THICKER: f64 = 10.0;
/// The greatest power.
const MOST: usize = 8;

/// Triangles a task. Each task makes an evaluator.
const TRIANGLES: usize = 1 << 9;

/// The least power of ten by which the first heights of some walls must be multiplied so that a mesh follows their curved faces: 0 where it does as they
/// are, 8 at most.
///
/// An edge of the length L between two points of a face whose normals there make the angle θ has its middle L θ/8 off the face. Where that is many times
/// the first height, the metric that is asked for at the vertices of the mesh says little of the layers between them.
pub fn thickness(
    team: Team<'_>,
    (mesh, place, model): (&TetMesh, &Classification, &Model),
    asked: &[Asked],
    outside: &Outside,
) -> u32 {
    let mut powers = [0; MOST + 1];
    for (wall, growth) in asked.iter().filter_map(|asked| Some((asked, asked.wall.growth?))) {
        let is_curved = |face: &u32| wall.faces.binary_search(face).is_ok() && !model.is_plane(*face);
        let triangles: Vec<usize> =
            place.faces.iter().enumerate().filter(|(_, face)| is_curved(face)).map(|(triangle, _)| triangle).collect();
        let parts = team.chunks(TRIANGLES, triangles.len(), |range| {
            let (mut evaluator, mut powers) = (model.evaluator(), [0; MOST + 1]);
            for &triangle in &triangles[range] {
                let ends = mesh.triangles.nodes[triangle]
                    .map(|v| End::of(&mut evaluator, (place, model), (v as usize, place.faces[triangle])));
                for [a, b] in [[0, 1], [1, 2], [2, 0]] {
                    if let (Some(a), Some(b)) = (&ends[a], &ends[b]) {
                        powers[power(a, b, &growth, outside)] += 1;
                    }
                }
            }
            powers
        });
        parts.iter().for_each(|part| powers.iter_mut().zip(part).for_each(|(all, count)| *all += count));
    }
    let few = FEW * powers.iter().sum::<usize>() as f64;
    let mut above = 0;
    let least = (1..=MOST).rev().find(|&power| {
        above += powers[power];
        above as f64 > few
    });
    least.unwrap_or(0) as u32
}

/// An end of an edge on a face.
struct End {
    point: Vec3,
    foot: Foot,
}

impl End {
    /// A vertex of the mesh on a face of the model; none where the face has no normal.
    fn of(
        evaluator: &mut Evaluator,
        (place, model): (&Classification, &Model),
        (v, face): (usize, u32),
    ) -> Option<Self> {
        let topology = model.topology();
        let (_, uv) = own_faces(topology, place, evaluator, v).into_iter().find(|own| own.0 == face)?;
        let foot = Foot::on_wall(evaluator, topology, face, uv);
        foot.is_inside.then_some(Self { point: place.projected[v], foot })
    }
}

/// The least power of ten, up to the greatest, by which the layers must be thicker so that an edge follows the wall.
fn power(a: &End, b: &End, growth: &Growth, outside: &Outside) -> usize {
    let edge = sub(b.point, a.point);
    let angle = dot(a.foot.normal, b.foot.normal).clamp(-1.0, 1.0).acos();
    let rise = norm(edge) * angle / 8.0;
    let follows = |&power: &usize| {
        let growth = growth.thicker(THICKER.powi(power as i32));
        let lengths = [&a.foot, &b.foot].map(|foot| {
            let along = add(edge, scale(foot.normal, -dot(edge, foot.normal)));
            growth.log(foot, outside, 1.0).map_or(0.0, |log| log.exp().quadratic(along).sqrt())
        });
        rise <= RISE * growth.first || 0.5 * (lengths[0] + lengths[1]) <= LONG
    };
    (0..MOST).find(follows).unwrap_or(MOST)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On a cylinder of the radius 0.5 about z: an angle about the axis, and a height.
    fn end(angle: f64, z: f64) -> End {
        let (sine, cosine) = angle.sin_cos();
        let foot = Foot {
            distance: 0.0,
            normal: [cosine, sine, 0.0],
            directions: [[-sine, cosine, 0.0], [0.0, 0.0, 1.0]],
            curvatures: [2.0, 0.0],
            bends: [2.0, 0.0],
            radii: [0.5, f64::INFINITY],
            is_inside: true,
        };
        End { point: [0.5 * cosine, 0.5 * sine, z], foot }
    }

    #[test]
    fn long_edges_about_a_cylinder_need_thick_layers_and_those_along_it_none() {
        let outside = Outside { greatest: 0.3, segments: 2.0 };
        let growth = |first| Growth { first, growth: 1.2, tangential: None, chord: Some(0.5) };
        let about = |length: f64, first| power(&end(0.3, 0.0), &end(0.3 + 2.0 * length, 0.0), &growth(first), &outside);
        // L²/8R = 0.0025 for 0.1.
        assert_eq!([1e-2, 1.3e-3, 5e-4, 5e-5, 5e-6].map(|first| about(0.1, first)), [0, 0, 0, 1, 2]);
        // Five times 0.5 √(8 h R) is 0.005 at h = 1e-6.
        assert_eq!([0.0049, 0.0051, 0.0157, 0.051].map(|length| about(length, 1e-6)), [0, 1, 1, 3]);
        assert_eq!(about(0.1, 1e-16), MOST);
        assert_eq!(power(&end(0.3, 0.0), &end(0.3, 1.0), &growth(1e-6), &outside), 0);
    }
}
