//! A crowded mesh is thinned before the passes: they would list and judge each of its edges again and again.
use super::{LITTLE, Pipeline, size_limits};
use crate::adapt::context::Limits;
use crate::adapt::ids::{TetId, VertexId};
use crate::adapt::schedule::Thin;
use crate::adapt::store::Store;
use crate::adapt::work::Kind;
use crate::mesh::vector::volume6;

/// A mesh of so many times the tetrahedra that the metric asks for is thinned.
const CROWDED: f64 = 4.0;

/// The store is renumbered when it has shrunk by this factor: by 2 costs as much as it saves.
const SHRUNK: usize = 4;

/// Rounds of thinning, with flips between them.
const THINNINGS: usize = 3;

/// Limits while a crowded mesh is thinned: what gets too long or bad is split and flipped afterwards, when the mesh is small.
fn thin_limits() -> Limits {
    Limits { longest_new: 3.0, collapse_floor: 0.05, flip_below: 0.3, ..size_limits() }
}

/// Whether the tetrahedra are several times those that the metric asks for. Between sweeps only.
pub fn is_crowded(store: &Store) -> bool {
    let volume = |t: TetId| {
        let vertices = store.vertices(t);
        let trace = |v: VertexId| store.log(v).0[0] + store.log(v).0[2] + store.log(v).0[5];
        let [a, b, c, d] = vertices.map(|v| store.position(v));
        volume6(a, b, c, d) * (0.125 * vertices.map(trace).iter().sum::<f64>()).exp()
    };
    let (sum, count) = store.live_tets().fold((0.0, 0.0), |(sum, count), t| (sum + volume(t), count + 1.0));
    // Six times the volume of a regular tetrahedron of unit edges is 1/√2.
    count > CROWDED * std::f64::consts::SQRT_2 * sum
}

impl Pipeline<'_, '_> {
    /// Removes vertices that are too near to others, with flips where that gets stuck.
    pub(super) fn thin(&mut self) {
        self.context.limits = thin_limits();
        for round in 0..THINNINGS {
            if round > 0 {
                self.reconnect(self.criterion, 1);
            }
            self.thin_in_sweeps();
        }
        self.reorder();
        self.context.limits = size_limits();
    }

    /// Sweeps over the vertices whose neighbourhood changed, until few of them go.
    fn thin_in_sweeps(&mut self) {
        let mut since = 0;
        loop {
            let store = &self.context.store;
            let mut live = 0;
            let changed = store.live_vertices().inspect(|_| live += 1);
            let changed = changed.filter(|&v| store.stamp(store.tet_of(v)) >= since);
            let items: Vec<VertexId> = changed.collect();
            since = store.clock() + 1;
            let done = if self.observer.stop() { 0 } else { self.sweep(Kind::Collapse, &Thin, &items).done as usize };
            if (done as f64) < LITTLE * items.len() as f64 {
                break;
            }
            if SHRUNK * (live - done) < self.context.store.vertex_bound() {
                self.reorder();
                // A vertex no longer knows the tetrahedron that changed last.
                since = 0;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::adapt::build;
    use crate::geometry::Discrete;
    use crate::geometry::discrete::DEFAULT_RIDGE_ANGLE;
    use crate::mesh::samples::cube;
    use crate::metric::{Background, Source, Sym3};

    #[test]
    fn crowded_is_what_has_several_times_the_tetrahedra_asked_for() {
        let mesh = cube(4);
        let (_, place) = Discrete::from_mesh(&mesh, DEFAULT_RIDGE_ANGLE).unwrap();
        // Edges of 0.25 to 0.43: about right for a size of 0.3. A size is a factor of eight in the number.
        for (size, crowded) in [(0.1, false), (0.3, false), (0.7, true), (2.0, true)] {
            let log = -2.0 * f64::ln(size);
            let logs = vec![Sym3([log, 0.0, log, 0.0, 0.0, log]); mesh.vertices.len()];
            let source = Source::Background(Background::new(mesh.vertices.clone(), mesh.tets.nodes.clone(), logs));
            let store = build::fill(&mesh, &place, &source).unwrap().store;
            assert_eq!(is_crowded(&store), crowded, "size {size}");
        }
    }
}
