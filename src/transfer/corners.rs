//! A linear function on one new tetrahedron, from the old field on the pieces of it.
use super::clip::{Piece, Planes};
use crate::mesh::vector::{Vec3, add, dot, scale, sub};

/// What one component gathers.
#[derive(Clone, Copy)]
struct Gathered {
    /// ∫ u over the pieces, in units of the tetrahedron's volume.
    mass: f64,
    /// ∫ ∇u.
    gradient: Vec3,
    /// Bounds of the old field over the old tetrahedra that are met.
    bounds: [f64; 2],
}

const NOTHING: Gathered = Gathered { mass: 0.0, gradient: [0.0; 3], bounds: [f64::INFINITY, f64::NEG_INFINITY] };

/// The field on a new tetrahedron, each component linear, as far as it is gathered. It keeps its memory for the next one.
pub struct Corners {
    /// First corner: lengths are counted from here.
    origin: Vec3,
    covered: f64,
    /// ∫ (x − origin) over the pieces.
    moment: Vec3,
    components: Vec<Gathered>,
}

impl Corners {
    /// Of so many components.
    pub fn new(width: usize) -> Self {
        Self { origin: [0.0; 3], covered: 0.0, moment: [0.0; 3], components: vec![NOTHING; width] }
    }

    /// For another tetrahedron.
    pub fn clear(&mut self, origin: Vec3) {
        (self.origin, self.covered, self.moment) = (origin, 0.0, [0.0; 3]);
        self.components.fill(NOTHING);
    }

    /// A piece in an old tetrahedron with these corners and rows of values at them.
    #[inline]
    pub fn add(&mut self, x: [Vec3; 4], rows: [&[f64]; 4], planes: &Planes, piece: &Piece) {
        let (share, at) = (piece.share, piece.centroid());
        let centroid = (0..4).fold([0.0; 3], |sum, k| add(sum, scale(sub(x[k], self.origin), at[k])));
        self.moment = add(self.moment, scale(centroid, share));
        self.covered += share;
        let [_, g1, g2, g3] = planes.gradients;
        for (c, into) in self.components.iter_mut().enumerate() {
            let [a, b, c, d] = rows.map(|row| row[c]);
            into.mass += share * ((at[0] * a + at[1] * b) + (at[2] * c + at[3] * d));
            let (ab, ac, ad) = (share * (b - a), share * (c - a), share * (d - a));
            for i in 0..3 {
                into.gradient[i] += ab * g1[i] + ac * g2[i] + ad * g3[i];
            }
            let [low, high] = &mut into.bounds;
            *low = low.min(a.min(b).min(c.min(d)));
            *high = high.max(a.max(b).max(c.max(d)));
        }
    }

    /// Component c at the corners x, and its bounds. It is the linear function with the mean and the mean gradient of the pieces, brought
    /// within the bounds with its mean over x kept, where that is within them.
    pub fn values(&self, c: usize, x: &[Vec3; 4]) -> ([f64; 4], [f64; 2]) {
        let Gathered { mass, gradient, bounds } = self.components[c];
        let per = 1.0 / self.covered;
        let (mean, gradient) = (mass * per, scale(gradient, per));
        let centroid = add(self.origin, scale(self.moment, per));
        (within(x.map(|p| mean + dot(gradient, sub(p, centroid))), bounds), bounds)
    }
}

/// Brings values within bounds. What is cut off is given to the others in proportion to their room, so that the sum stays as far as the
/// bounds allow.
fn within(values: [f64; 4], [low, high]: [f64; 2]) -> [f64; 4] {
    let cut = values.map(|value| value.max(low).min(high));
    let surplus: f64 = (0..4).map(|i| values[i] - cut[i]).sum();
    let toward = if surplus > 0.0 { high } else { low };
    let room: f64 = cut.iter().map(|value| toward - value).sum();
    // Both have the same sign; where there is none, nothing was cut off or nothing can be given.
    let part = if room == 0.0 { 0.0 } else { (surplus / room).clamp(0.0, 1.0) };
    cut.map(|value| (value + part * (toward - value)).max(low).min(high))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_mean_stays_and_the_bounds_hold(
            values in prop::array::uniform4(-3.0..3.0f64),
            low in -2.0..0.0f64,
            size in 0.0..3.0f64,
        ) {
            let high = low + size;
            let found = within(values, [low, high]);
            prop_assert!(found.iter().all(|x| (low..=high).contains(x)), "{found:?}");
            let [mean, kept] = [values, found].map(|v| v.iter().sum::<f64>() / 4.0);
            prop_assert!((kept - mean.clamp(low, high)).abs() < 1e-14, "{values:?} {found:?}");
        }

        #[test]
        fn values_within_their_bounds_stay(values in prop::array::uniform4(-3.0..3.0f64)) {
            prop_assert_eq!(within(values, [-3.0, 3.0]), values);
        }
    }
}
