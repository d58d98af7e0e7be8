//! The 2-3 flip: a face goes, and the edge between the two vertices opposite to it comes. Where one face is not enough, several go
//! ([`super::multi_face_removal`]).
use super::criteria::{Criterion, mean_ratio_score, wanted_score};
use crate::adapt::core::access::Access;
use crate::adapt::core::commit::NewTet;
use crate::adapt::core::ids::{FACE, TetId, VertexId};
use crate::adapt::core::refusal::Refusal;
use crate::adapt::core::worker::Worker;
use crate::mesh::vector::volume6;
use crate::metric::lanes::LANES;

/// The face between two tetrahedra is removed alone only where their sum of 1/Q − 1 is at least this. That of the three that come is 0.806 at the
/// least, if the metric is constant; up to twice that one face in ten thousand gains (docs/decisions/kernel-speed.md).
const LEAST_COST: f64 = 1.6;

/// Where two tetrahedra have a lesser sum of 1/Q − 1, faces beside theirs are not looked at: that hardly ever gains.
const LEAST_COST_OF_SEVERAL: f64 = 0.5;

impl<A: Access> Worker<'_, '_, A> {
    /// Removes the face opposite to local vertex i of a claimed tetrahedron, alone or with faces beside it, when the criterion gains by it.
    pub fn remove_face(&mut self, t: TetId, i: usize, criterion: Criterion) -> Result<(), Refusal> {
        let other = self.store.neighbour(t, i);
        if !other.is_some() || self.store.tags(t)[i] != 0 {
            return Err(Refusal::Geometry);
        }
        let v = self.store.vertices(t);
        if !self.goes_first(t, other) {
            return Err(Refusal::Stale);
        }
        let cost = match criterion {
            Criterion::MeanRatio => [t, other].iter().map(|&t| -mean_ratio_score(self.store.quality(t))).sum(),
            // The others know no cost.
            _ => f64::INFINITY,
        };
        let several = cost > LEAST_COST_OF_SEVERAL && self.store.quality(t) < self.context.limits.several_below;
        let alone = cost >= LEAST_COST;
        if !alone && !several {
            return Err(Refusal::Shape);
        }
        let w = self.claim_tet(other)?;
        let below = w.into_iter().find(|x| !v.contains(x)).ok_or(Refusal::Topology)?;
        let face = FACE[i].map(|k| v[k]);
        let above = v[i];
        if alone {
            match self.flip_face([t, other], face, [above, below], criterion) {
                Err(Refusal::Shape) if several => {}
                result => return result,
            }
        }
        self.remove_faces(face, [t, other], [above, below], criterion)
    }

    /// Removes the face between two claimed tetrahedra, the upper one first, when the criterion gains by it.
    pub fn flip_face(
        &mut self,
        tets: [TetId; 2],
        face: [VertexId; 3],
        [above, below]: [VertexId; 2],
        criterion: Criterion,
    ) -> Result<(), Refusal> {
        let cavity = [face[0], face[1], face[2], above, below];
        let old = tets.map(|t| self.present_score(criterion, t, &cavity));
        let wanted = wanted_score(criterion.join(old[0], old[1]));
        // (face, above) is positive, so each side of the face makes a positive tetrahedron with below and above.
        let new = [0, 1, 2].map(|k| [face[k], face[(k + 1) % 3], below, above]);
        let qualities = self.qualities_of(&new).ok_or(Refusal::Shape)?;
        let scores = new.into_iter().zip(qualities).map(|(tet, quality)| match criterion {
            Criterion::MeanRatio => mean_ratio_score(quality),
            _ => self.score(criterion, tet, &cavity),
        });
        if scores.fold(criterion.nothing(), |x, y| criterion.join(x, y)) <= wanted {
            return Err(Refusal::Shape);
        }
        let region = self.store.region(tets[0]);
        self.state.replacement.clear();
        self.state.replacement.old.extend(tets);
        for (vertices, quality) in new.into_iter().zip(qualities) {
            self.state.replacement.new.push(NewTet { vertices, region, quality });
        }
        self.commit()
    }

    /// Mean ratios of the three tetrahedra; `None` when one of them is not positive in floating point.
    fn qualities_of(&mut self, new: &[[VertexId; 4]; 3]) -> Option<[f64; 3]> {
        let points = new.map(|tet| tet.map(|v| self.store.position(v)));
        if points.iter().any(|&[a, b, c, d]| volume6(a, b, c, d) <= 0.0) {
            return None;
        }
        let batch = &mut self.state.batch;
        for lane in 0..LANES {
            let which = lane.min(2);
            let [a, b, c, _] = points[which];
            let logs = [new[which][0], new[which][1], new[which][2]].map(|v| self.store.log(v));
            batch.set(lane, [a, b, c], logs.each_ref());
        }
        batch.prepare();
        let [x, y, z, ..] = batch.shapes(points[0][3], &self.store.log(new[0][3])).mean_ratios();
        Some([x, y, z])
    }
}
