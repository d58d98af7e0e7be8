//! Where triangles come nearer to others than to their own surface.
//!
//! Such triangles do not cross, but whoever moves their points onto the model has no room for that: between a hole and the side of a plate, in
//! the wall of a pipe, a chord is as far off its arc as the arc is from what lies behind it.
use super::{GoOn, Surface};
use crate::mesh::box_tree::{Bounds, BoxTree};
use crate::mesh::locate::nearest_on_triangle;
use crate::mesh::vector::{Vec3, add, area2, distance, dot, lerp, scale, unit};
use crate::tasks::Team;

/// Cosine of the normals of two triangles below which they look at each other or away from each other.
const OPPOSITE: f64 = -0.5;
/// Triangles nearer to their surface than this share of their longest edge are flat.
const FLAT: f64 = 1e-6;

/// The triangles that are too near to others, sorted. `off` is how far each triangle is off its surface, model units. Of two triangles it is the
/// one that is farther off; both if neither is twice as far off as the other. Ends early where `go_on` says no.
pub fn too_near(team: Team<'_>, surface: &Surface, off: &[f64], go_on: GoOn<'_>) -> Vec<u32> {
    let corners = |t: u32| surface.triangles[t as usize].map(|v| surface.points[v as usize]);
    let reach = |t: u32| {
        let (off, longest) = (off[t as usize], super::whole::longest(&corners(t)).1);
        if off > FLAT * longest { off } else { 0.0 }
    };
    let bounds = |t: u32| -> Bounds {
        let ([p, q, r], reach) = (corners(t), reach(t));
        [[0, 1, 2].map(|k| p[k].min(q[k]).min(r[k]) - reach), [0, 1, 2].map(|k| p[k].max(q[k]).max(r[k]) + reach)]
    };
    let tree = BoxTree::new(surface.triangles.len(), bounds);
    // The two sides of a wall or of a gap. Of one face they may meet in a tip, which is as narrow however fine it is.
    let are_opposite = |i: u32, j: u32| {
        let [a, b] = [i, j].map(corners).map(|[p, q, r]| unit(area2(p, q, r)));
        surface.faces[i as usize] != surface.faces[j as usize] && dot(a, b) < OPPOSITE
    };
    let are_beside = |i: u32, j: u32| {
        let [a, b] = [i, j].map(|t| surface.triangles[t as usize]);
        a.iter().any(|v| b.contains(v))
    };
    let parts = tree.overlapping_pairs(
        team,
        bounds,
        |_, node| node > 0 || go_on(),
        |found: &mut Vec<u32>, i, j| {
            let [a, b] = [i, j].map(reach);
            if a + b > 0.0 && are_opposite(i, j) && !are_beside(i, j) && apart(&corners(i), &corners(j)) < a + b {
                found.extend((a > 0.5 * b).then_some(i));
                found.extend((b > 0.5 * a).then_some(j));
            }
        },
    );
    let mut found = parts.concat();
    found.sort_unstable();
    found.dedup();
    found
}

/// How far two triangles are from each other, looked at from the corners and the middles of the sides of both.
fn apart(a: &[Vec3; 3], b: &[Vec3; 3]) -> f64 {
    let from = |a: &[Vec3; 3], b: &[Vec3; 3]| {
        let places = (0..3).flat_map(|i| [a[i], lerp(a[i], a[(i + 1) % 3], 0.5)]);
        let nearest = |p: Vec3| {
            let weights = nearest_on_triangle(p, *b);
            distance(p, b.iter().zip(weights).fold([0.0; 3], |q, (&x, w)| add(q, scale(x, w))))
        };
        places.map(nearest).fold(f64::INFINITY, f64::min)
    };
    from(a, b).min(from(b, a))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two triangles of faces of their own, the second above the first and turned over, so far off their faces.
    fn facing(gap: f64, off: [f64; 2]) -> Vec<u32> {
        let points =
            vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.1, 0.1, gap], [0.9, 0.1, gap], [0.1, 0.9, gap]];
        let surface =
            Surface { points, triangles: vec![[0, 1, 2], [3, 5, 4]], faces: vec![0, 1], ..Surface::default() };
        too_near(Team::alone(), &surface, &off, &|| true)
    }

    #[test]
    fn what_is_farther_off_its_face_than_from_another_is_found() {
        assert_eq!(facing(0.1, [0.06, 0.06]), [0, 1]);
        assert_eq!(facing(0.1, [0.2, 0.0]), [0]);
        assert_eq!(facing(0.1, [0.01, 0.15]), [1]);
        assert!(facing(0.1, [0.04, 0.04]).is_empty() && facing(0.1, [0.0, 0.0]).is_empty());
    }
}
