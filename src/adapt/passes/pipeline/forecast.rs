//! What the passes say of themselves: how many vertices the metric asks for, and what share of the work is done.
use super::Pipeline;
use crate::adapt::core::ids::{FACE, TetId};
use crate::adapt::forecast::{Forecast, vertices};
use crate::mesh::vector::{add, cross, dot, norm, scale, sub};
use crate::metric::Sym3;
use crate::tasks::GRAIN;
use std::ops::Range;

/// Share of the time that the size passes take, as a rule.
const SIZES: f64 = 0.6;

/// Share that a shape pass takes of what was left before it.
const SHAPES: f64 = 0.5;

/// So many places of the boundary are asked, at the least.
const SAMPLES: f64 = 10_000.0;

/// About so many tetrahedra are asked at most.
const MOST_ASKED: usize = 100_000;

/// Chords of a coarse mesh cut through layers along a curved face. There the area is at most so many times that in the two greatest sizes.
const CURVED: f64 = 2.4;

/// The edges of a triangle are cut into so many parts at most.
const MOST_CUTS: f64 = 32.0;

/// Centroids of the triangles that come of the reference triangle (0,0), (1,0), (0,1) when its edges are cut into so many parts.
fn centres(cuts: usize) -> impl Iterator<Item = [f64; 2]> {
    let at = move |i: usize, k: usize, part: f64| [i, k].map(|index| (index as f64 + part) / cuts as f64);
    let row = move |i: usize| {
        let upright = (0..cuts - i).map(move |k| at(i, k, 1.0 / 3.0));
        upright.chain((0..cuts - i - 1).map(move |k| at(i, k, 2.0 / 3.0)))
    };
    (0..cuts).flat_map(row)
}

impl Pipeline<'_, '_> {
    /// Says what the run will take.
    pub(super) fn forecast(&mut self) {
        self.complexity_given = self.full_complexity();
        self.expect();
        self.observer.forecast(&Forecast::of(self.expected, self.input, self.execution.pool.threads()));
    }

    /// How many vertices are expected: the mesh as it is shows more and more of the metric.
    fn expect(&mut self) {
        self.expected = vertices(self.complexity_given.max(self.complexity(self.asked_each())), self.area_in_metric());
    }

    /// One tetrahedron in so many is asked where that is enough.
    fn asked_each(&self) -> usize {
        (self.context.store.tet_bound() / MOST_ASKED).max(1)
    }

    /// Area of the boundary and of interfaces in the metric. On a coarse mesh the source is asked between its vertices.
    fn area_in_metric(&self) -> f64 {
        let store = &self.context.store;
        let tagged = |range: Range<usize>, step: usize| {
            let faces = |t: TetId| (0..4).filter(move |&i| store.is_surface(t, i)).map(move |i| (t, i));
            store.live_tets_each(range, step).flat_map(faces)
        };
        // Of a fine mesh only one tetrahedron in so many is asked, for all.
        let counted = self.asked_each();
        let all =
            counted as f64 * self.team().sum(GRAIN, store.tet_bound(), |range| tagged(range, counted).count() as f64);
        let step = (all / SAMPLES).max(1.0) as usize;
        let cuts = (SAMPLES / all.max(1.0)).sqrt().clamp(1.0, MOST_CUTS) as usize;
        let of = |(t, i): (TetId, usize)| {
            let corners = FACE[i].map(|k| store.vertices(t)[k]);
            let [a, b, c] = corners.map(|v| store.position(v));
            let (ab, ac) = (sub(b, a), sub(c, a));
            let tag = store.tags(t)[i] as usize;
            let is_curved = tag != 0 && self.context.planes[tag - 1].is_none();
            let area = |log: &Sym3| {
                let metric = log.exp();
                let [bb, cc, bc] = [(ab, ab), (ac, ac), (ab, ac)].map(|(x, y)| dot(x, metric.apply(y)));
                let area = 0.5 * (bb * cc - bc * bc).max(0.0).sqrt();
                if !is_curved {
                    return area;
                }
                let [least, middle, _] = log.eigen().values;
                area.min(CURVED * 0.5 * norm(cross(ab, ac)) * (0.5 * (least + middle)).exp())
            };
            // An interface has its triangle on both sides.
            let sides = if store.neighbour(t, i).is_some() { 0.5 } else { 1.0 };
            if cuts == 1 {
                let logs = corners.map(|v| store.log(v));
                let mean = Sym3(std::array::from_fn(|k| logs.iter().map(|log| log.0[k]).sum::<f64>() / 3.0));
                return sides * area(&mean);
            }
            let mut hint = 0;
            let centres = centres(cuts).map(|[u, v]| add(a, add(scale(ab, u), scale(ac, v))));
            let sum: f64 = centres.map(|x| area(&self.context.source.log_at(x, &mut hint))).sum();
            sides * sum / (cuts * cuts) as f64
        };
        step as f64 * self.team().sum(GRAIN, store.tet_bound(), |range| tagged(range, step).map(of).sum())
    }

    /// Says how much is done after a pass for the sizes: as much as there is of the way from the vertices that were given to those expected.
    pub(super) fn tell_share_of_sizes(&mut self) {
        self.expect();
        let (input, live) = (self.input as f64, self.live() as f64);
        let way = (self.expected - input).abs().max(1.0);
        let share = (1.0 - (self.expected - live).abs() / way).clamp(0.0, 1.0);
        self.observer.share(SIZES * share, self.expected);
    }

    /// Says how much is done after a pass for the shapes, the first of which is 0.
    pub(super) fn tell_share_of_shapes(&self, pass: usize) {
        let left = (1.0 - SHAPES).powi(pass as i32 + 1);
        self.observer.share(1.0 - (1.0 - SIZES) * left, self.live() as f64);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_triangle_is_cut_into_squares_of_the_cuts_and_all_lie_in_it() {
        for cuts in [1, 2, 7] {
            let all: Vec<_> = centres(cuts).collect();
            assert_eq!(all.len(), cuts * cuts);
            assert!(all.iter().all(|[u, v]| *u > 0.0 && *v > 0.0 && u + v < 1.0));
            let mean = all.iter().map(|[u, _]| u).sum::<f64>() / all.len() as f64;
            assert!((mean - 1.0 / 3.0).abs() < 1e-12, "{mean}");
        }
    }
}
