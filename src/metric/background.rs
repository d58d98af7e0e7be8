//! The background metric: the input mesh with ln M at its vertices, kept unchanged while the mesh is adapted.
use super::Sym3;
use super::between::Ordered;
use super::field::complexity_between;
use super::quadratic::{Quadratic, Rise};
use crate::mesh::TetMesh;
use crate::mesh::adjacency::MatchedFaces;
use crate::mesh::locate::{Location, Locator};
use crate::mesh::vector::{Vec3, sub};
use crate::tasks::{GRAIN, Team};
use std::sync::Arc;

/// Steps to the point of a tetrahedron of second degree.
const STEPS: usize = 3;

/// A mesh with ln M at its vertices. Shared by all threads; every caller keeps its own hint.
pub struct Background {
    locator: Locator,
    logs: Vec<Sym3>,
    /// The eigenvalues of ln M at the vertices, ascending, where sizes are steep in some tetrahedron; else empty.
    ordered: Vec<[f64; 3]>,
    /// What lies between the boundary's edges and the model, where that is much.
    quadratic: Option<Box<Quadratic>>,
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
        let ordered = ordered(team, locator.tets(), &logs);
        Self { locator, logs, ordered, quadratic: None, is_wide, cut }
    }

    /// The same on a mesh whose boundary is of second degree: with the edges that rise to the model, ascending. What is between their chords and the
    /// model belongs to the tetrahedra at them.
    pub fn of_second_degree(mut self, team: Team<'_>, edges: &[Rise]) -> Self {
        self.quadratic = Quadratic::of(team, self.logs.len(), self.locator.tets(), edges).map(Box::new);
        self
    }

    /// Its complexity ∫ √det M.
    pub fn complexity(&self, team: Team<'_>) -> f64 {
        complexity_between(team, self.locator.mesh(), &self.logs)
    }

    /// At how many vertices sizes were cut.
    pub fn cut(&self) -> usize {
        self.cut
    }

    /// ln M at p, interpolated in the tetrahedron that contains p, or in the nearest one at the point nearest to p.
    /// The search starts at the tetrahedron `hint` (any number will do), which becomes the one found.
    #[inline]
    pub fn log_at(&self, p: Vec3, hint: &mut u32) -> Sym3 {
        let found = self.located(p, hint);
        let nodes = self.locator.tets()[found.tet as usize];
        let mut log = Sym3::ZERO;
        for (node, weight) in nodes.into_iter().zip(found.weights) {
            log = log.plus(self.logs[node as usize].times(weight));
        }
        if !self.ordered.is_empty() {
            let ordered = Ordered::new(nodes.map(|node| self.ordered[node as usize]));
            if ordered.is_steep() {
                log = ordered.log(&log, found.weights);
            }
        }
        if self.is_wide { log.held_log() } else { log }
    }

    /// Where p is, by its weights in a tetrahedron.
    #[inline]
    fn located(&self, p: Vec3, hint: &mut u32) -> Location {
        let mut found = self.locator.locate(p, hint);
        if let Some(quadratic) = &self.quadratic {
            for _ in 0..STEPS {
                let Some(shift) = quadratic.shift(found.tet, found.weights) else { break };
                found = self.locator.locate(sub(p, shift), hint);
            }
        }
        found
    }

    /// Adds `log_factor` to the diagonal of every ln M: M is scaled by e^log_factor.
    pub fn scale(&mut self, team: Team<'_>, log_factor: f64) {
        team.fill(GRAIN, &mut self.logs, |_, logs| {
            logs.iter_mut().for_each(|log| *log = log.plus_identity(log_factor));
        });
        if !self.ordered.is_empty() {
            // Not those before with the factor: as of a background that is made of these logarithms, to the bit.
            self.ordered = ordered(team, self.locator.tets(), &self.logs);
        }
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

/// The eigenvalues of each ln M, ascending, if sizes are steep in some tetrahedron; else none.
fn ordered(team: Team<'_>, tets: &[[u32; 4]], logs: &[Sym3]) -> Vec<[f64; 3]> {
    let ordered = team.map(GRAIN, logs.len(), |v| logs[v].eigen().values);
    let is_steep = |tet: &[u32; 4]| Ordered::new(tet.map(|v| ordered[v as usize])).is_steep();
    let is_any = team.chunks(GRAIN, tets.len(), |range| tets[range].iter().any(is_steep)).contains(&true);
    if is_any { ordered } else { Vec::new() }
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

    /// The edge from the origin along x rises by 0.2 along −y: between the chord and the model sizes are those of the edge, and behind it they are as far
    /// away as they were.
    #[test]
    fn what_is_between_a_chord_and_the_model_belongs_to_the_tetrahedra_at_the_chord() {
        let mesh = cube(2);
        let vertex = |p: Vec3| mesh.vertices.iter().position(|&q| q == p).unwrap() as u32;
        let mut ends = [vertex([0.0, 0.0, 0.0]), vertex([0.5, 0.0, 0.0])];
        ends.sort_unstable();
        // ln of sizes that grow by e from y = 0 to 1, and from z = 0 to 1.
        let log = |p: Vec3| Sym3::ZERO.plus_identity(-2.0 * (p[1] + p[2]));
        let logs: Vec<Sym3> = mesh.vertices.iter().map(|&p| log(p)).collect();
        let straight = Background::new(mesh.vertices.clone(), mesh.tets.nodes.clone(), logs.clone());
        let bent = Background::new(mesh.vertices.clone(), mesh.tets.nodes.clone(), logs);
        let bent = bent.of_second_degree(Team::alone(), &[(ends, [0.0, -0.2, 0.0])]);
        let size = |of: &Background, p: Vec3| -0.5 * of.log_at(p, &mut 0).0[0];
        for (y, expected) in [(-0.2, 0.0), (-0.1, 0.084), (0.2, 0.234)] {
            let p = [0.25, y, 0.0];
            assert!((size(&straight, p) - y.max(0.0)).abs() < 1e-14);
            assert!((size(&bent, p) - expected).abs() < 0.01, "{y}: {}", size(&bent, p));
        }
        // Other tetrahedra are as they were.
        for p in [[0.75, 0.1, 0.1], [0.1, 0.8, 0.3]] {
            assert_eq!(size(&straight, p), size(&bent, p));
        }
        assert!(Quadratic::of(Team::alone(), 27, bent.locator.tets(), &[]).is_none());
    }
}
