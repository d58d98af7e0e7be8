//! Whether something of the surface stands between two points.
use super::tree::{Box3, Tree, box_of, meet};
use crate::mesh::TetMesh;
use crate::mesh::vector::{Vec3, cross, dot, lerp, norm, scale, sub};
use crate::tasks::{GRAIN, Team};

/// What the line meets within this share of its length from an end belongs to that end: the mesh's triangles are chords of the model.
const ENDS: f64 = 0.02;
/// A line whose sine with a triangle's plane is no more than this goes along it.
const PARALLEL: f64 = 1e-6;

/// The triangles of a mesh as obstacles.
pub struct Obstacles<'a> {
    mesh: &'a TetMesh,
    tree: Tree,
}

impl<'a> Obstacles<'a> {
    /// On a mesh.
    pub fn new(team: Team<'_>, mesh: &'a TetMesh) -> Self {
        let points = |t: usize| mesh.triangles.nodes[t].map(|v| mesh.vertices[v as usize]);
        let boxes = team.map(GRAIN, mesh.triangles.len(), |t| box_of(points(t)));
        Self { mesh, tree: Tree::new(team, &boxes) }
    }

    /// Whether no triangle stands between p and q but those that `is_own`.
    pub fn is_clear(&self, p: Vec3, q: Vec3, is_own: impl Fn(u32) -> bool) -> bool {
        let ends = [lerp(p, q, ENDS), lerp(p, q, 1.0 - ENDS)];
        let about = box_of(ends);
        self.tree.each_where(
            |items| meet(items, &about) && passes(ends, items),
            |triangle| {
                let corners = self.mesh.triangles.nodes[triangle as usize].map(|v| self.mesh.vertices[v as usize]);
                is_own(triangle) || !crosses(ends, corners)
            },
        )
    }
}

/// Whether a segment may go through a box that its own box meets: no cross product of the segment and an axis separates them.
fn passes([p, q]: [Vec3; 2], [low, high]: &Box3) -> bool {
    let half = scale(sub(q, p), 0.5);
    let (arm, size) = (sub(lerp(*low, *high, 0.5), lerp(p, q, 0.5)), scale(sub(*high, *low), 0.5));
    (0..3).all(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        let rounding = ROUNDING * (half[i].abs() + half[j].abs()) * (arm[i].abs() + arm[j].abs());
        let most = size[i] * half[j].abs() + size[j] * half[i].abs() + rounding;
        (half[i] * arm[j] - half[j] * arm[i]).abs() <= most
    })
}

/// What counts as rounding, relative.
const ROUNDING: f64 = 1e-9;

/// Whether a segment goes through a triangle (Möller and Trumbore 1997); one within its plane does not.
fn crosses([p, q]: [Vec3; 2], [a, b, c]: [Vec3; 3]) -> bool {
    let (along, ab, ac, arm) = (sub(q, p), sub(b, a), sub(c, a), sub(p, a));
    let h = cross(along, ac);
    let determinant = dot(ab, h);
    if determinant.abs() <= PARALLEL * norm(along) * norm(cross(ab, ac)) {
        return false;
    }
    let side = cross(arm, ab);
    let (u, v, s) = (dot(arm, h) / determinant, dot(along, side) / determinant, dot(ac, side) / determinant);
    u >= 0.0 && v >= 0.0 && u + v <= 1.0 && (0.0..=1.0).contains(&s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::samples::cube;

    #[test]
    fn a_segment_passes_the_boxes_that_it_has_points_in() {
        let mut state = 7u64;
        let mut random = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 33) as f64 / (1u64 << 31) as f64
        };
        let mut counts = [0; 2];
        for _ in 0..20_000 {
            let ends: [Vec3; 2] = std::array::from_fn(|_| std::array::from_fn(|_| random()));
            let low: Vec3 = std::array::from_fn(|_| random());
            let part = [low, low.map(|x| x + 0.2 * random())];
            if !meet(&part, &box_of(ends)) {
                continue;
            }
            let holds = |p: Vec3| (0..3).all(|k| part[0][k] <= p[k] && p[k] <= part[1][k]);
            let is_in = (0..=500).any(|i| holds(lerp(ends[0], ends[1], f64::from(i) / 500.0)));
            assert!(!is_in || passes(ends, &part));
            counts[usize::from(passes(ends, &part))] += 1;
        }
        assert!(counts[0] > 100 && counts[1] > 100, "{counts:?}");
    }

    #[test]
    fn a_wall_stands_between() {
        let mesh = cube(2);
        let sight = Obstacles::new(Team::alone(), &mesh);
        let never = |_: u32| false;
        assert!(sight.is_clear([0.3, 0.2, 0.4], [0.6, 0.7, 0.8], never), "inside");
        assert!(!sight.is_clear([0.3, 0.2, 0.4], [0.3, 0.2, 1.5], never), "through the top");
        assert!(sight.is_clear([0.3, 0.2, 0.4], [0.3, 0.2, 1.0], never), "up to the top");
        assert!(sight.is_clear([-1.0, 0.5, 1.2], [2.0, 0.5, 1.2], never), "above");
        let top = |t: u32| mesh.triangles.refs[t as usize] == 6;
        assert!(sight.is_clear([0.3, 0.2, 0.4], [0.3, 0.2, 1.5], top), "what is its own does not stand in the way");
    }
}
