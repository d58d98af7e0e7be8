//! The Hilbert curve: points that are near each other on it are near each other in space.
use super::vector::Vec3;

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
    // Undo excess work of the curve's turns, from the highest bit down.
    let mut q = 1u32 << (BITS - 1);
    while q > 1 {
        let lower = q - 1;
        for i in 0..3 {
            if x[i] & q != 0 {
                x[0] ^= lower;
            } else {
                let swap = (x[0] ^ x[i]) & lower;
                x[0] ^= swap;
                x[i] ^= swap;
            }
        }
        q >>= 1;
    }
    // Gray code.
    x[1] ^= x[0];
    x[2] ^= x[1];
    let mut flip = 0;
    let mut q = 1u32 << (BITS - 1);
    while q > 1 {
        if x[2] & q != 0 {
            flip ^= q - 1;
        }
        q >>= 1;
    }
    (0..BITS)
        .rev()
        .fold(0, |key, bit| x.iter().fold(key, |key, &coordinate| key << 1 | u64::from((coordinate ^ flip) >> bit & 1)))
}

/// The points in the order of the Hilbert curve through their box; those of one cell in the order given.
pub fn order(points: &[Vec3]) -> Vec<u32> {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for p in points {
        low = std::array::from_fn(|i| low[i].min(p[i]));
        high = std::array::from_fn(|i| high[i].max(p[i]));
    }
    let mut keys: Vec<(u64, u32)> = points.iter().map(|&p| key(p, low, high)).zip(0..).collect();
    keys.sort_unstable();
    keys.into_iter().map(|(_, point)| point).collect()
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

    #[test]
    fn a_flat_box_is_no_trouble() {
        assert_eq!(key([0.5, 0.5, 1.0], [0.0, 0.0, 1.0], [0.0, 1.0, 1.0]) >> 60, 0);
    }
}
