//! The background metric: the input mesh with ln M at its vertices, kept unchanged while the mesh is adapted.
use super::Sym3;
use crate::mesh::locate::Locator;
use crate::mesh::vector::Vec3;

/// A mesh with ln M at its vertices. Shared by all threads; every caller keeps its own hint.
pub struct Background {
    locator: Locator,
    logs: Vec<Sym3>,
}

impl Background {
    /// From vertices (n, 3), tetrahedra (m, 4) and ln M at the vertices (n,).
    ///
    /// # Panics
    /// When the lengths of `vertices` and `logs` differ, an index is out of range, or there is no tetrahedron.
    pub fn new(vertices: Vec<Vec3>, tets: Vec<[u32; 4]>, logs: Vec<Sym3>) -> Self {
        assert_eq!(vertices.len(), logs.len(), "one ln M a vertex");
        Self { locator: Locator::new(vertices, tets), logs }
    }

    /// ln M at p, log-Euclidean in the tetrahedron that contains p, or in the nearest one at the point nearest to p.
    /// `hint` is the tetrahedron where the search starts (any number will do) and becomes the one found.
    #[inline]
    pub fn log_at(&self, p: Vec3, hint: &mut u32) -> Sym3 {
        let found = self.locator.locate(p, hint);
        let nodes = self.locator.tets()[found.tet as usize];
        let mut log = Sym3::ZERO;
        for (node, weight) in nodes.into_iter().zip(found.weights) {
            log = log.plus(self.logs[node as usize].times(weight));
        }
        log
    }

    /// Adds `log_factor` to the diagonal of every ln M: M is scaled by e^log_factor.
    pub fn scale(&mut self, log_factor: f64) {
        for log in &mut self.logs {
            *log = log.plus_identity(log_factor);
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
