//! Metrics of an image's content at the vertices of a mesh: of its second derivatives, or of the distance to its borders.
use super::multiscale::{Unreachable, reach};
use super::{Eigen, Limits, Sym3, field, gradation};
use crate::mesh::TetMesh;
use crate::mesh::box_tree::BoxTree;
use crate::mesh::vector::{Vec3, distance};
use crate::tasks::{GRAIN, Team};

/// Second derivatives are raised to at least this share of the image's greatest. Below it is the rounding of single precision.
const NOISE: f64 = 1e-6;

/// What the metric has to be.
#[derive(Clone, Copy, Debug)]
pub struct Wish {
    /// Complexity Σ_v √det(M_v)·V_v, with limits and gradation.
    pub complexity: f64,
    /// Bounds of the sizes.
    pub limits: Limits,
    /// Greatest growth of sizes, above 1; none for no gradation.
    pub gradation: Option<f64>,
}

impl Wish {
    /// ln M from `make`, at the scale that meets the wish.
    fn meet(&self, team: Team<'_>, mesh: &TetMesh, make: impl Fn(f64) -> Vec<Sym3>) -> Result<Vec<Sym3>, Unreachable> {
        let mut logs = Vec::new();
        reach(self.complexity, |scale| {
            logs = make(scale);
            self.limits.apply(team, &mut logs);
            if let Some(ratio) = self.gradation {
                gradation::grade(team, mesh, &mut logs, ratio);
            }
            field::complexity_of_logs(team, mesh, &logs)
        })?;
        Ok(logs)
    }
}

/// ln M of the L² metric det(|H|)^(−1/7) |H| of second derivatives at the vertices, shape (n,) (Loseille & Alauzet 2011), scaled to
/// meet the wish. Second derivatives up to `rounding`, in value/length², are noise; none when all are.
///
/// # Errors
/// [`Unreachable`] when the limits do not let the complexity come near.
pub fn of_hessians(
    team: Team<'_>,
    mesh: &TetMesh,
    hessians: &[Sym3],
    rounding: f64,
    wish: &Wish,
) -> Result<Option<Vec<Sym3>>, Unreachable> {
    let absolute = team.map(GRAIN, hessians.len(), |v| {
        let Eigen { values, vectors } = hessians[v].eigen();
        Eigen { values: values.map(f64::abs), vectors }
    });
    let greatest = absolute.iter().flat_map(|eigen| eigen.values).fold(0.0, f64::max);
    if greatest <= rounding {
        return Ok(None);
    }
    let floor = rounding.max(NOISE * greatest);
    let raw = team.map(GRAIN, absolute.len(), |v| {
        let Eigen { values, vectors } = absolute[v];
        let values = values.map(|x| x.max(floor).ln());
        Sym3::from_eigen(&Eigen { values, vectors }).plus_identity(-values.iter().sum::<f64>() / 7.0)
    });
    wish.meet(team, mesh, |scale| team.map(GRAIN, raw.len(), |v| raw[v].plus_identity(scale))).map(Some)
}

/// ln M of the sizes h0 + d·ln r at the distance d from the nearest of some points: fine at borders, coarse away from them. r is the growth
/// wished for (e if there is none), and h0 is found so that the complexity is met.
///
/// # Errors
/// [`Unreachable`] when limits, or a mesh with no vertices near the points, do not let the complexity come near.
///
/// # Panics
/// Without a point.
pub fn of_borders(team: Team<'_>, mesh: &TetMesh, points: &[Vec3], wish: &Wish) -> Result<Vec<Sym3>, Unreachable> {
    let tree = BoxTree::new(points.len(), |i| [points[i as usize]; 2]);
    let away = team.map(GRAIN / 16, mesh.vertices.len(), |v| {
        let (p, mut least) = (mesh.vertices[v], f64::INFINITY);
        tree.nearest(p, f64::INFINITY, |item| {
            least = least.min(distance(p, points[item as usize]));
            least * least
        });
        least
    });
    let growth = wish.gradation.map_or(1.0, f64::ln);
    let farthest = away.iter().copied().fold(0.0, f64::max);
    let first = if farthest > 0.0 { 0.1 * farthest } else { 1.0 };
    wish.meet(team, mesh, |scale| {
        let least = first * (-0.5 * scale).exp();
        team.map(GRAIN, away.len(), |v| Sym3::ZERO.plus_identity(-2.0 * (least + growth * away[v]).ln()))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::samples::cube;

    const WISH: Wish = Wish {
        complexity: 2000.0,
        limits: Limits { hmin: None, hmax: Some(2.0), aspect_ratio: None },
        gradation: Some(1.5),
    };

    fn complexity(mesh: &TetMesh, logs: &[Sym3]) -> f64 {
        field::complexity_of_logs(Team::alone(), mesh, logs)
    }

    #[test]
    fn sizes_are_small_at_borders() {
        let mesh = cube(8);
        let points: Vec<Vec3> = (0..400).map(|i| [0.5, f64::from(i % 20) / 19.0, f64::from(i / 20) / 19.0]).collect();
        let logs = of_borders(Team::alone(), &mesh, &points, &WISH).unwrap();
        assert!((complexity(&mesh, &logs) / 2000.0 - 1.0).abs() < 1e-2);
        let size = |at: Vec3| {
            let vertex = mesh.vertices.iter().position(|&p| p == at).unwrap();
            (-0.5 * logs[vertex].0[0]).exp()
        };
        let grown = size([0.0, 0.5, 0.5]) - size([0.5; 3]);
        assert!((grown - 0.5 * 1.5f64.ln()).abs() < 0.02, "{grown}");
        // Greater sizes only: no complexity like that.
        let coarse = Wish { limits: Limits { hmin: Some(0.5), ..WISH.limits }, ..WISH };
        assert!(of_borders(Team::alone(), &mesh, &points, &coarse).is_err());
    }

    #[test]
    fn second_derivatives_give_anisotropy() {
        let mesh = cube(8);
        let hessians = vec![Sym3::diagonal(100.0, -4.0, 1.0); mesh.vertices.len()];
        let logs = of_hessians(Team::alone(), &mesh, &hessians, 0.0, &WISH).unwrap().unwrap();
        assert!((complexity(&mesh, &logs) / 2000.0 - 1.0).abs() < 1e-2);
        let h = logs[0].exp().sizes();
        assert!((h[0] / h[2] - 10.0).abs() < 1e-6 && (h[1] / h[2] - 5.0).abs() < 1e-6, "{h:?}");
        let flat = vec![Sym3::ZERO; mesh.vertices.len()];
        assert!(of_hessians(Team::alone(), &mesh, &flat, 0.0, &WISH).unwrap().is_none());
    }
}
