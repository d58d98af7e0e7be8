//! The order in which points are inserted: random rounds that double, each along a Hilbert curve (BRIO, Amenta, Choi and
//! Rote 2003).
use crate::mesh::vector::Vec3;

/// Bits per coordinate of a cell on the curve.
const BITS: u32 = 20;

/// Indices of the points in the order of insertion. The same points give the same order.
pub fn insertion_order(points: &[Vec3]) -> Vec<u32> {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for p in points {
        for k in 0..3 {
            low[k] = low[k].min(p[k]);
            high[k] = high[k].max(p[k]);
        }
    }
    let extent = (0..3).fold(f64::MIN_POSITIVE, |m, k| (high[k] - low[k]).max(m));
    let scale = f64::from((1 << BITS) - 1) / extent;
    // The last round takes half of the points, the one before a quarter, ...; the first 1000 or so are one round.
    let rounds = (points.len() / 1000).checked_ilog2().map_or(0, |r| r + 1);
    let mut random = 0x9e37_79b9_7f4a_7c15_u64;
    let mut keys: Vec<(u64, u32)> = Vec::with_capacity(points.len());
    for (i, p) in points.iter().enumerate() {
        random ^= random << 13;
        random ^= random >> 7;
        random ^= random << 17;
        let round = rounds - (random >> 11).trailing_zeros().min(rounds);
        let cell = std::array::from_fn(|k| ((p[k] - low[k]) * scale) as u32);
        keys.push((u64::from(round) << (3 * BITS) | hilbert(cell), i as u32));
    }
    keys.sort_unstable();
    keys.into_iter().map(|(_, i)| i).collect()
}

/// Distance along the Hilbert curve of a cell (Skilling 2004).
fn hilbert(mut x: [u32; 3]) -> u64 {
    let mut q = 1_u32 << (BITS - 1);
    while q > 1 {
        let mask = q - 1;
        for k in 0..3 {
            if x[k] & q != 0 {
                x[0] ^= mask;
            } else {
                let t = (x[0] ^ x[k]) & mask;
                x[0] ^= t;
                x[k] ^= t;
            }
        }
        q >>= 1;
    }
    x[1] ^= x[0];
    x[2] ^= x[1];
    let mut t = 0;
    let mut q = 1_u32 << (BITS - 1);
    while q > 1 {
        if x[2] & q != 0 {
            t ^= q - 1;
        }
        q >>= 1;
    }
    x.iter_mut().for_each(|c| *c ^= t);
    (0..BITS).rev().fold(0, |key, bit| {
        let digit = ((x[0] >> bit & 1) << 2) | ((x[1] >> bit & 1) << 1) | (x[2] >> bit & 1);
        key << 3 | u64::from(digit)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curve_steps_to_neighbours() {
        // Cells of a coarse grid, in the order of the curve, differ by one step in one coordinate.
        let step = 1 << (BITS - 3);
        let mut cells: Vec<(u64, [u32; 3])> = (0..512)
            .map(|i| [i % 8 * step, i / 8 % 8 * step, i / 64 * step])
            .map(|c| (hilbert(c) >> (3 * (BITS - 3)), c))
            .collect();
        cells.sort_unstable();
        for pair in cells.windows(2) {
            assert_eq!(pair[0].0 + 1, pair[1].0);
            let moved: u32 = (0..3).map(|k| pair[0].1[k].abs_diff(pair[1].1[k])).sum();
            assert_eq!(moved, step);
        }
    }

    #[test]
    fn order_is_a_permutation() {
        let points: Vec<Vec3> = (0..5000).map(|i| [(i % 17) as f64, (i % 23) as f64, i as f64]).collect();
        let mut order = insertion_order(&points);
        order.sort_unstable();
        assert!(order.iter().enumerate().all(|(i, &v)| i as u32 == v));
        assert!(insertion_order(&[]).is_empty());
    }
}
