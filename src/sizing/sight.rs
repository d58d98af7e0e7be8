//! Whether something of the surface stands between two points.
use super::tree::{Tree, box_of};
use crate::mesh::TetMesh;
use crate::mesh::vector::{Vec3, cross, dot, lerp, norm, sub};
use crate::tasks::{GRAIN, Team};

/// What stands at the ends of the line, by this share of it, belongs to them: the mesh's triangles are chords of the model.
const ENDS: f64 = 0.02;
/// A line whose sine with a triangle's plane is no more than this goes along it.
const PARALLEL: f64 = 1e-6;

/// The triangles of a mesh as obstacles.
pub struct Sight<'a> {
    mesh: &'a TetMesh,
    tree: Tree,
}

impl<'a> Sight<'a> {
    /// On a mesh.
    pub fn new(team: Team<'_>, mesh: &'a TetMesh) -> Self {
        let points = |t: usize| mesh.triangles.nodes[t].map(|v| mesh.vertices[v as usize]);
        let boxes = team.map(GRAIN, mesh.triangles.len(), |t| box_of(points(t)));
        Self { mesh, tree: Tree::new(team, &boxes) }
    }

    /// Whether no triangle stands between p and q but those that `is_own`.
    pub fn is_clear(&self, p: Vec3, q: Vec3, is_own: impl Fn(u32) -> bool) -> bool {
        let ends = [lerp(p, q, ENDS), lerp(p, q, 1.0 - ENDS)];
        self.tree.each_in(&box_of(ends), |triangle| {
            let corners = self.mesh.triangles.nodes[triangle as usize].map(|v| self.mesh.vertices[v as usize]);
            is_own(triangle) || !crosses(ends, corners)
        })
    }
}

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
    fn a_wall_stands_between() {
        let mesh = cube(2);
        let sight = Sight::new(Team::alone(), &mesh);
        let never = |_: u32| false;
        assert!(sight.is_clear([0.3, 0.2, 0.4], [0.6, 0.7, 0.8], never), "inside");
        assert!(!sight.is_clear([0.3, 0.2, 0.4], [0.3, 0.2, 1.5], never), "through the top");
        assert!(sight.is_clear([0.3, 0.2, 0.4], [0.3, 0.2, 1.0], never), "up to the top");
        assert!(sight.is_clear([-1.0, 0.5, 1.2], [2.0, 0.5, 1.2], never), "above");
        let top = |t: u32| mesh.triangles.refs[t as usize] == 6;
        assert!(sight.is_clear([0.3, 0.2, 0.4], [0.3, 0.2, 1.5], top), "what is its own does not stand in the way");
    }
}
