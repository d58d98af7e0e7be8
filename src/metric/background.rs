//! The background metric: the input mesh with ln M at its vertices, kept unchanged while the mesh is adapted.
use super::{Interpolation, Sym3};
use crate::mesh::TetMesh;
use crate::mesh::adjacency::MatchedFaces;
use crate::mesh::locate::Locator;
use crate::mesh::vector::Vec3;
use crate::tasks::{GRAIN, Team};
use std::sync::Arc;

/// A mesh with ln M at its vertices. Shared by all threads; every caller keeps its own hint.
pub struct Background {
    locator: Locator,
    logs: Vec<Sym3>,
    /// What is linear between the vertices.
    interpolation: Interpolation,
    /// What is interpolated, where that is not `logs`; else empty.
    values: Vec<Sym3>,
    /// Whether what lies between vertices may have to be cut to be held.
    is_wide: bool,
    cut: usize,
}

impl Background {
    /// From vertices (n, 3), tetrahedra (m, 4) and ln M at the vertices (n,).
    ///
    /// # Panics
    /// When the lengths of `vertices` and `logs` differ, an index is out of range, or there is no tetrahedron.
    pub fn new(vertices: Vec<Vec3>, tets: Vec<[u32; 4]>, logs: Vec<Sym3>) -> Self {
        assert_eq!(vertices.len(), logs.len(), "one ln M a vertex");
        Self::with(Team::alone(), Locator::new(vertices, tets), logs)
    }

    /// On a mesh that others use too, with its [`MatchedFaces`] and ln M at its vertices.
    ///
    /// # Panics
    /// As [`Background::new`].
    pub fn on(team: Team<'_>, mesh: Arc<TetMesh>, faces: MatchedFaces, logs: Vec<Sym3>) -> Self {
        assert_eq!(mesh.vertices.len(), logs.len(), "one ln M a vertex");
        Self::with(team, Locator::on(team, mesh, faces), logs)
    }

    /// Sizes that doubles do not hold beside the others at a vertex are cut ([`super::held`]).
    fn with(team: Team<'_>, locator: Locator, mut logs: Vec<Sym3>) -> Self {
        // The difference of the greatest and the least eigenvalue is convex: between vertices it is no more than at them.
        let is_wide =
            team.chunks(GRAIN, logs.len(), |range| !logs[range].iter().all(Sym3::is_narrow_log)).contains(&true);
        let mut cut = 0;
        for log in logs.iter_mut().filter(|_| is_wide) {
            let held = log.held_log();
            cut += usize::from(held != *log);
            *log = held;
        }
        Self { locator, logs, interpolation: Interpolation::default(), values: Vec::new(), is_wide, cut }
    }

    /// The same, interpolated in another way.
    pub fn interpolated(mut self, team: Team<'_>, interpolation: Interpolation) -> Self {
        self.values = match interpolation {
            Interpolation::Logarithms => Vec::new(),
            Interpolation::Sizes => team.map(GRAIN, self.logs.len(), |v| interpolation.of_log(&self.logs[v])),
        };
        self.interpolation = interpolation;
        self
    }

    /// Its complexity ∫ √det M.
    pub fn complexity(&self, team: Team<'_>) -> f64 {
        self.interpolation.complexity(team, self.locator.mesh(), &self.logs)
    }

    /// At how many vertices sizes were cut.
    pub fn cut(&self) -> usize {
        self.cut
    }

    /// ln M at p, interpolated in the tetrahedron that contains p, or in the nearest one at the point nearest to p.
    /// The search starts at the tetrahedron `hint` (any number will do), which becomes the one found.
    #[inline]
    pub fn log_at(&self, p: Vec3, hint: &mut u32) -> Sym3 {
        let found = self.locator.locate(p, hint);
        let nodes = self.locator.tets()[found.tet as usize];
        let values = if self.values.is_empty() { &self.logs } else { &self.values };
        let mut value = Sym3::ZERO;
        for (node, weight) in nodes.into_iter().zip(found.weights) {
            value = value.plus(values[node as usize].times(weight));
        }
        let log = self.interpolation.log(&value);
        if self.is_wide { log.held_log() } else { log }
    }

    /// Adds `log_factor` to the diagonal of every ln M: M is scaled by e^log_factor.
    pub fn scale(&mut self, team: Team<'_>, log_factor: f64) {
        team.fill(GRAIN, &mut self.logs, |_, logs| {
            logs.iter_mut().for_each(|log| *log = log.plus_identity(log_factor));
        });
        let factor = (-0.5 * log_factor).exp();
        team.fill(GRAIN, &mut self.values, |_, sizes| sizes.iter_mut().for_each(|size| *size = size.times(factor)));
    }

    /// The mesh, for searches.
    pub fn locator(&self) -> &Locator {
        &self.locator
    }

    /// ln M at its vertices, shape (n,).
    pub fn logs(&self) -> &[Sym3] {
        &self.logs
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::samples::cube;

    #[test]
    fn a_linear_logarithm_is_met() {
        let mesh = cube(4);
        let log = |p: Vec3| Sym3([p[0], 2.0 * p[1], 1.0 - p[2], p[0] - p[1], 0.5, p[2]]);
        let logs = mesh.vertices.iter().map(|&p| log(p)).collect();
        let mut background = Background::new(mesh.vertices, mesh.tets.nodes, logs);
        let mut hint = u32::MAX;
        for p in [[0.1, 0.2, 0.3], [0.99, 0.01, 0.5], [1.0, 1.0, 1.0], [0.5, 0.77, 0.123]] {
            let found = background.log_at(p, &mut hint);
            for i in 0..6 {
                assert!((found.0[i] - log(p).0[i]).abs() < 1e-14);
            }
        }
        // Outside: the value at the nearest point.
        let outside = background.log_at([0.3, 1.5, 0.6], &mut hint);
        assert!((outside.0[1] - 2.0).abs() < 1e-14 && (outside.0[0] - 0.3).abs() < 1e-14, "{outside:?}");
        background.scale(Team::alone(), 3.0);
        assert!((background.log_at([0.25, 0.5, 0.5], &mut hint).0[0] - 3.25).abs() < 1e-14);
    }
}
