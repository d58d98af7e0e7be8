//! Mean ratios of many tetrahedra.
use super::Sym3;
use super::batch::Batch;
use super::lanes::{LANES, Lanes};
use crate::mesh::vector::Vec3;

/// Calls `each` with every tetrahedron and its mean ratio, 0 where it is not positive; `corners` gives the points of
/// its vertices and ln M there.
pub fn mean_ratios<T: Copy>(
    tets: impl Iterator<Item = T>,
    corners: impl Fn(T) -> ([Vec3; 4], [Sym3; 4]),
    mut each: impl FnMut(T, f64),
) {
    let mut tets = tets.fuse();
    let mut batch = Batch::default();
    let (mut apexes, mut apex_logs) = ([Lanes::ZERO; 3], [Lanes::ZERO; 6]);
    while let Some(first) = tets.next() {
        let mut some = [first; LANES];
        let mut count = 1;
        for (slot, tet) in some[1..].iter_mut().zip(&mut tets) {
            *slot = tet;
            count += 1;
        }
        for (lane, &tet) in some.iter().enumerate() {
            let (points, logs) = corners(tet);
            batch.set(lane, [points[0], points[1], points[2]], [&logs[0], &logs[1], &logs[2]]);
            (0..3).for_each(|i| apexes[i].0[lane] = points[3][i]);
            (0..6).for_each(|i| apex_logs[i].0[lane] = logs[3].0[i]);
        }
        batch.prepare();
        let ratios = batch.shapes_each(&apexes, &apex_logs).mean_ratios();
        some.iter().zip(ratios).take(count).for_each(|(&tet, ratio)| each(tet, ratio));
    }
}

#[cfg(test)]
mod tests {
    use super::super::quality::mean_ratio;
    use super::*;

    #[test]
    fn every_tetrahedron_has_its_own() {
        let corners = |k: usize| {
            let x = 0.1 + k as f64;
            let points = [[0.0; 3], [x, 0.0, 0.0], [0.3, 1.0, 0.0], [0.0, 0.2, if k == 3 { -1.0 } else { 1.0 }]];
            (points, [0, 1, 2, 3].map(|i| Sym3::diagonal(0.1 * f64::from(i), 0.0, -0.2 * x)))
        };
        for count in 0..10 {
            let mut found = Vec::new();
            mean_ratios(0..count, corners, |k, ratio| found.push((k, ratio)));
            assert_eq!(found.len(), count);
            for (place, (k, ratio)) in found.into_iter().enumerate() {
                let (points, logs) = corners(k);
                let expected = mean_ratio(points, logs.each_ref()).max(0.0);
                assert!(place == k && (ratio - expected).abs() < 1e-12, "{k} of {count}: {ratio} {expected}");
                assert_eq!(ratio == 0.0, k == 3);
            }
        }
    }
}
