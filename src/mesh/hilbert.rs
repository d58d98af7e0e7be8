//! The Hilbert curve: points that are near each other on it are near each other in space.
use super::vector::Vec3;
use crate::tasks::{GRAIN, Team};

/// Bits of each coordinate.
const BITS: u32 = 20;

/// Place of a point on the Hilbert curve through a box: greater is later. Transposed form after Skilling,
/// *Programming the Hilbert curve* (AIP Conf. Proc. 707, 2004).
pub fn key(p: Vec3, low: Vec3, high: Vec3) -> u64 {
    let cells = f64::from((1u32 << BITS) - 1);
    let mut x: [u32; 3] = std::array::from_fn(|i| {
        let extent = high[i] - low[i];
        if extent > 0.0 { ((p[i] - low[i]) / extent * cells).clamp(0.0, cells) as u32 } else { 0 }
    });
    // Undo the curve's turns, from the highest bit down: where the bit is set, the lower bits of x[0] are inverted, else those of x[0] and
    // x[i] are exchanged. Both cases are as frequent, so it is done without branches.
    for bit in (1..BITS).rev() {
        let lower = (1u32 << bit) - 1;
        for i in 0..3 {
            let set = (x[i] >> bit & 1).wrapping_neg() & lower;
            let exchange = (x[0] ^ x[i]) & (lower ^ set);
            x[i] ^= exchange;
            x[0] ^= exchange ^ set;
        }
    }
    // Gray code.
    x[1] ^= x[0];
    x[2] ^= x[1];
    // Each bit of the others is flipped when an odd number of the higher bits of x[2] is set.
    let mut flip = x[2] >> 1;
    for shift in [1, 2, 4, 8, 16] {
        flip ^= flip >> shift;
    }
    let [x, y, z] = x.map(|coordinate| spread(coordinate ^ flip));
    x << 2 | y << 1 | z
}

/// The lowest 21 bits with two zeros between neighbours.
fn spread(bits: u32) -> u64 {
    let mut x = u64::from(bits);
    for (shift, mask) in [
        (32, 0x001F_0000_0000_FFFF),
        (16, 0x001F_0000_FF00_00FF),
        (8, 0x100F_00F0_0F00_F00F),
        (4, 0x10C3_0C30_C30C_30C3),
        (2, 0x1249_2492_4924_9249),
    ] {
        x = (x | x << shift) & mask;
    }
    x
}

/// The numbers of points in the order of the Hilbert curve through their box. Points of one cell keep their order.
pub fn order(team: Team<'_>, count: usize, point: impl Fn(usize) -> Vec3 + Sync) -> Vec<u32> {
    let [low, high] = box_of(team, count, &point);
    let mut keys = team.map(GRAIN, count, |i| (key(point(i), low, high), i as u32));
    team.sort(&mut keys);
    team.map(GRAIN, count, |i| keys[i].1)
}

/// The box of points.
fn box_of(team: Team<'_>, count: usize, point: impl Fn(usize) -> Vec3 + Sync) -> [Vec3; 2] {
    const NOTHING: [Vec3; 2] = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    let join = |[low, high]: [Vec3; 2], [p, q]: [Vec3; 2]| {
        [std::array::from_fn(|i| low[i].min(p[i])), std::array::from_fn(|i| high[i].max(q[i]))]
    };
    let boxes = team.chunks(GRAIN, count, |range| range.map(&point).fold(NOTHING, |all, p| join(all, [p, p])));
    boxes.into_iter().fold(NOTHING, join)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_goes_from_cell_to_neighbouring_cell() {
        // Centres of 8×8×8 cells, in the order of the curve, are one cell apart.
        let n = 8;
        let mut cells: Vec<(u64, [i32; 3])> = Vec::new();
        for i in 0..n {
            for j in 0..n {
                for k in 0..n {
                    let p = [i, j, k].map(|c| (f64::from(c) + 0.5) / f64::from(n));
                    cells.push((key(p, [0.0; 3], [1.0; 3]), [i, j, k]));
                }
            }
        }
        cells.sort_unstable();
        for pair in cells.windows(2) {
            let steps: i32 = (0..3).map(|c| (pair[0].1[c] - pair[1].1[c]).abs()).sum();
            assert_eq!(steps, 1, "{pair:?}");
        }
    }

    /// The curve as Skilling writes it, bit by bit.
    fn by_bits(mut x: [u32; 3]) -> u64 {
        for bit in (1..BITS).rev() {
            let lower = (1u32 << bit) - 1;
            for i in 0..3 {
                if x[i] >> bit & 1 == 1 {
                    x[0] ^= lower;
                } else {
                    let swap = (x[0] ^ x[i]) & lower;
                    x[0] ^= swap;
                    x[i] ^= swap;
                }
            }
        }
        x[1] ^= x[0];
        x[2] ^= x[1];
        let flip = (1..BITS).filter(|bit| x[2] >> bit & 1 == 1).fold(0, |flip, bit| flip ^ ((1u32 << bit) - 1));
        let bits = (0..BITS).rev().flat_map(|bit| x.map(|coordinate| u64::from((coordinate ^ flip) >> bit & 1)));
        bits.fold(0, |key, bit| key << 1 | bit)
    }

    #[test]
    fn the_key_is_that_of_the_definition() {
        let cells = (1u32 << BITS) - 1;
        let mut cell = [12_345u32, 999_999, 77];
        for _ in 0..2000 {
            cell = cell.map(|x| x.wrapping_mul(1_103_515_245).wrapping_add(12_345 + cell[0]) & cells);
            let p = cell.map(|x| (f64::from(x) + 0.5) / f64::from(cells));
            assert_eq!(key(p, [0.0; 3], [1.0; 3]), by_bits(cell));
        }
    }

    #[test]
    fn a_flat_box_is_no_trouble() {
        assert_eq!(key([0.5, 0.5, 1.0], [0.0, 0.0, 1.0], [0.0, 1.0, 1.0]) >> 60, 0);
    }
}
