//! Squared lengths of the edges of several tetrahedra at once: what the lists of long and short edges are made of.
use super::lanes::{LaneSym3, LaneVec3, Lanes, sub};
use crate::mesh::adjacency::EDGES;
use multiversion::multiversion;

/// Tetrahedra, one a lane, by the positions of their vertices and the metrics there.
pub struct TetLanes {
    /// Positions.
    pub points: [LaneVec3; 4],
    /// Metrics.
    pub metrics: [LaneSym3; 4],
}

impl Default for TetLanes {
    fn default() -> Self {
        Self { points: [[Lanes::ZERO; 3]; 4], metrics: [[Lanes::ZERO; 6]; 4] }
    }
}

impl TetLanes {
    /// Writes the squared lengths of each edge in the metrics of its two ends, in the order of [`EDGES`].
    #[inline]
    pub fn squared_lengths(&self, lengths: &mut [[Lanes; 2]; 6]) {
        squared_lengths(self, lengths);
    }
}

#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn squared_lengths(tets: &TetLanes, lengths: &mut [[Lanes; 2]; 6]) {
    // A loop: closures are not compiled for the features of the kernel.
    for (lengths, [i, j]) in lengths.iter_mut().zip(EDGES) {
        let v = sub(&tets.points[j], &tets.points[i]);
        *lengths = [quadratic(&tets.metrics[i], &v), quadratic(&tets.metrics[j], &v)];
    }
}

/// vᵀMv, to the bit as [`Sym3::quadratic`](super::Sym3::quadratic).
#[inline(always)]
fn quadratic(m: &LaneSym3, v: &LaneVec3) -> Lanes {
    m[0] * v[0] * v[0]
        + m[2] * v[1] * v[1]
        + m[5] * v[2] * v[2]
        + (m[1] * v[0] * v[1] + m[3] * v[0] * v[2] + m[4] * v[1] * v[2]) * 2.0
}

#[cfg(test)]
mod tests {
    use super::super::Sym3;
    use super::super::lanes::LANES;
    use super::*;
    use crate::mesh::vector::sub;

    #[test]
    fn every_edge_as_one_by_one_to_the_bit() {
        let number = |k: usize| ((k * 7919 % 1013) as f64 / 1013.0 - 0.5) * 3.0;
        let mut tets = TetLanes::default();
        for lane in 0..LANES {
            for k in 0..4 {
                (0..3).for_each(|i| tets.points[k][i].0[lane] = number(97 * lane + 11 * k + i));
                (0..6).for_each(|i| tets.metrics[k][i].0[lane] = number(31 * lane + 17 * k + i + 500));
            }
        }
        let mut found = [[Lanes::ZERO; 2]; 6];
        tets.squared_lengths(&mut found);
        for lane in 0..LANES {
            let point = |k: usize| tets.points[k].map(|x| x.0[lane]);
            let metric = |k: usize| Sym3(tets.metrics[k].map(|x| x.0[lane]));
            for (edge, [i, j]) in EDGES.into_iter().enumerate() {
                let v = sub(point(j), point(i));
                assert_eq!(found[edge].map(|x| x.0[lane]), [i, j].map(|k| metric(k).quadratic(v)));
            }
        }
    }
}
