//! The quadratic function that comes nearest to the value at a vertex and the values around it.
//!
//! u(x) ≈ a + g·d + ½ dᵀH d with d = x − v, by weighted least squares (METHOD.md §1.10). With the second moments Σ ddᵀ = CCᵀ of the points,
//! d = C y: the coordinates y do not change when the points go through an affine map, so a mesh stretched a thousand times is fitted as
//! well as one that is not. A row has the weight 1/(|y|² + ε²), ε² a quarter of the mean |y|². (Of some weights that were compared by the
//! interpolation error of adapted meshes, equal ones were clearly worse; the others lie within the noise.)
//! The system is solved by modified Gram–Schmidt with the right-hand side as one more column, which is as stable as Householder's
//! reflections (Björck 1967). All of it is products of columns, eight rows at a time.
use crate::metric::Sym3;
use crate::metric::lanes::{LANES, Lanes};
use multiversion::multiversion;

/// The terms: 1, three linear ones, then ½y₁², y₁y₂, ½y₂², y₁y₃, y₂y₃, ½y₃², as a tensor has them.
const TERMS: usize = 10;

/// The products of two coordinates, and the squares of these.
const PRODUCTS: [(usize, [usize; 2]); 3] = [(5, [4, 6]), (7, [4, 9]), (8, [6, 9])];

/// The first so many terms are not quadratic.
const LINEAR: usize = 4;

/// When a pivot of the second moments is less than this share of its term, the points lie in a plane, to rounding.
const FLAT: f64 = 1e-15;

/// A vertex and the points around it, eight a block, and room to work in.
#[derive(Default)]
pub struct Quadratic {
    /// Differences of the coordinates and the value from those of the vertex; then 1 for a point, 0 for none.
    blocks: Vec<[Lanes; 5]>,
    points: usize,
    /// The columns of the terms and the right-hand side, one after the other, each as long as there are blocks.
    columns: Vec<Lanes>,
    /// Whether [`Fitted::unexplained`] is computed, which is a quarter more work.
    explains: bool,
}

/// A fit.
#[derive(Clone, Copy, Debug)]
pub struct Fitted {
    /// The second derivatives.
    pub hessian: Sym3,
    /// How well the points determine the terms, in [0, 1]: the least share of a term's column that is no combination of the columns before it.
    /// A product of two coordinates is measured against their squares.
    pub quality: f64,
    /// The share of the values' variance that the fit leaves unexplained, per degree of freedom (1 - adjusted R²): small where the field is
    /// smooth at the distance of the points, near 1 across a jump; 1 where there are no more points than terms;
    /// 0 where it was not asked for.
    pub unexplained: f64,
}

impl Quadratic {
    /// One whose fits compute [`Fitted::unexplained`], or not.
    pub fn telling(explains: bool) -> Self {
        Self { explains, ..Self::default() }
    }

    /// Forgets all points, and adds the vertex itself.
    #[inline]
    pub fn start(&mut self) {
        self.blocks.clear();
        self.points = 0;
        self.push([0.0; 4]);
    }

    /// Adds a point by its differences from the vertex: those of the coordinates, then that of the value.
    #[inline]
    pub fn push(&mut self, [x, y, z, value]: [f64; 4]) {
        let lane = self.points % LANES;
        if lane == 0 {
            self.blocks.push([Lanes::ZERO; 5]);
        }
        self.points += 1;
        if let Some(block) = self.blocks.last_mut() {
            block.iter_mut().zip([x, y, z, value, 1.0]).for_each(|(lanes, x)| lanes.0[lane] = x);
        }
    }

    /// The least-squares fit; none where the points lie in a plane or are too few.
    #[inline]
    pub fn fit(&mut self) -> Option<Fitted> {
        if self.points < TERMS {
            return None;
        }
        self.columns.resize((TERMS + 1) * self.blocks.len(), Lanes::ZERO);
        fit(&self.blocks, self.points, &mut self.columns, self.explains)
    }
}

#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn fit(blocks: &[[Lanes; 5]], points: usize, columns: &mut [Lanes], explains: bool) -> Option<Fitted> {
    let to_y = whitening(blocks)?;
    // Σ |y|² = 3.
    fill(blocks, &to_y, 0.75 / points as f64, columns);
    let (factors, pivots, quality) = orthogonalise(blocks.len(), columns);
    let unexplained = if explains { unexplained(points, blocks.len(), columns, &factors) } else { 0.0 };
    // Back substitution from the last term; only the quadratic terms are needed.
    let mut h = [0.0; TERMS];
    for k in (LINEAR..TERMS).rev() {
        let rest: f64 = (k + 1..TERMS).map(|j| factors[k][j] * h[j]).sum();
        h[k] = factors[k][TERMS] - rest;
    }
    let hessian = congruent(&to_y, &[h[4], h[5], h[6], h[7], h[8], h[9]]);
    (pivots && hessian.0.iter().all(|x| x.is_finite())).then_some(Fitted { hessian, quality, unexplained })
}

/// The lower triangle of C⁻¹, y = C⁻¹ d: the inverse of Cholesky's factor of the points' second moments, row by row.
#[inline(always)]
fn whitening(blocks: &[[Lanes; 5]]) -> Option<[f64; 6]> {
    let mut moments = [Lanes::ZERO; 6];
    for [x, y, z, ..] in blocks {
        for (sum, product) in moments.iter_mut().zip([*x * *x, *x * *y, *y * *y, *x * *z, *y * *z, *z * *z]) {
            *sum = *sum + product;
        }
    }
    let [xx, xy, yy, xz, yz, zz] = moments.map(Lanes::sum);
    let (l10, l20) = (xy / xx, xz / xx);
    let d1 = yy - l10 * xy;
    let x = yz - l10 * xz;
    let l21 = x / d1;
    let d2 = zz - l20 * xz - l21 * x;
    // False for NaN too.
    if !(xx > f64::MIN_POSITIVE && d1 > FLAT * yy && d2 > FLAT * zz) {
        return None;
    }
    let [a, b, c] = [xx, d1, d2].map(|d| 1.0 / d.sqrt());
    Some([a, -l10 * b, b, (l10 * l21 - l20) * c, -l21 * c, c])
}

/// The columns of all terms and the right-hand side, each row weighted by 1/(|y|² + `soft`).
#[inline(always)]
fn fill(blocks: &[[Lanes; 5]], w: &[f64; 6], soft: f64, columns: &mut [Lanes]) {
    let height = blocks.len();
    for (at, [x, y, z, value, is_there]) in blocks.iter().enumerate() {
        let p = *x * w[0];
        let q = *x * w[1] + *y * w[2];
        let r = *x * w[3] + *y * w[4] + *z * w[5];
        let weight = *is_there / (p * p + q * q + r * r + soft);
        let (wp, wq, wr) = (p * weight, q * weight, r * weight);
        let row =
            [weight, wp, wq, wr, wp * p * 0.5, wp * q, wq * q * 0.5, wp * r, wq * r, wr * r * 0.5, *value * weight];
        for (k, term) in row.into_iter().enumerate() {
            columns[k * height + at] = term;
        }
    }
}

/// Makes the columns orthogonal, one after the other. Returns the factors (row k: how many times column k was taken off each later one),
/// whether no column vanished, and the least share that is left of a column.
#[inline(always)]
fn orthogonalise(height: usize, columns: &mut [Lanes]) -> ([[f64; TERMS + 1]; TERMS], bool, f64) {
    let mut factors = [[0.0; TERMS + 1]; TERMS];
    let mut lengths = [0.0; TERMS];
    for (length, column) in lengths.iter_mut().zip(columns.chunks_exact(height)) {
        *length = product(column, column);
    }
    // At a corner of the domain all points may lie on its three sides, and a product of coordinates is nothing but their rounding. Measured
    // against itself it would look like a good column, so it is measured against its bound by Cauchy and Schwarz.
    for (term, [first, second]) in PRODUCTS {
        lengths[term] = lengths[term].max((lengths[first] * lengths[second]).sqrt());
    }
    let mut least = f64::INFINITY;
    for k in 0..TERMS {
        let (before, behind) = columns.split_at_mut((k + 1) * height);
        let pivot = &before[k * height..];
        let square = product(pivot, pivot);
        // Once it is NaN it stays NaN.
        let share = square / lengths[k];
        least = if share >= least { least } else { share };
        for (j, column) in behind.chunks_exact_mut(height).enumerate() {
            let factor = product(pivot, column) / square;
            factors[k][k + 1 + j] = factor;
            for (x, p) in column.iter_mut().zip(pivot) {
                *x = *x - *p * factor;
            }
        }
    }
    (factors, least > 0.0, least.sqrt())
}

/// 1 - adjusted R² from the orthogonal columns: what is left of the right-hand side beside all but its constant.
#[inline(always)]
fn unexplained(points: usize, height: usize, columns: &[Lanes], factors: &[[f64; TERMS + 1]; TERMS]) -> f64 {
    let square = |k: usize| {
        let column = &columns[k * height..(k + 1) * height];
        product(column, column)
    };
    let rest = square(TERMS);
    let explained: f64 = (1..TERMS).map(|k| square(k) * factors[k][TERMS] * factors[k][TERMS]).sum();
    let (whole, free) = (rest + explained, points.saturating_sub(TERMS));
    if free == 0 {
        return 1.0;
    }
    let share = rest / free as f64 * (points - 1) as f64 / whole;
    // A constant field is explained.
    if whole > 0.0 { share } else { 0.0 }
}

/// The scalar product of two columns.
#[inline(always)]
fn product(a: &[Lanes], b: &[Lanes]) -> f64 {
    let mut sum = Lanes::ZERO;
    for (x, y) in a.iter().zip(b) {
        sum = sum + *x * *y;
    }
    sum.sum()
}

/// WᵀHW of a lower triangle W, row by row.
#[inline(always)]
fn congruent(w: &[f64; 6], h: &[f64; 6]) -> Sym3 {
    let [a, b, c, d, e, f] = *w;
    // HW, column by column.
    let first = [h[0] * a + h[1] * b + h[3] * d, h[1] * a + h[2] * b + h[4] * d, h[3] * a + h[4] * b + h[5] * d];
    let second = [h[1] * c + h[3] * e, h[2] * c + h[4] * e, h[4] * c + h[5] * e];
    let third = [h[3] * f, h[4] * f, h[5] * f];
    Sym3([
        a * first[0] + b * first[1] + d * first[2],
        c * first[1] + e * first[2],
        c * second[1] + e * second[2],
        f * first[2],
        f * second[2],
        f * third[2],
    ])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metric::random::{rotated, spd};
    use proptest::prelude::*;

    fn point() -> impl Strategy<Value = [f64; 3]> {
        prop::array::uniform3(-1.0..1.0f64)
    }

    proptest! {
        /// Points that were stretched along any axes up to a thousand times give the second derivatives of a quadratic function back.
        #[test]
        fn quadratics_are_met(
            points in prop::collection::vec(point(), 24..80),
            frame in rotated(),
            logs in prop::array::uniform3(0.0..6.9f64),
            h in spd(2.0), g in point(), sign in prop::bool::ANY,
        ) {
            let stretch = Sym3::from_eigen(&crate::metric::Eigen { values: logs.map(f64::exp), vectors: frame });
            let back = stretch.inverse();
            // In the coordinates before the stretch.
            let h = if sign { h } else { h.times(-1.0) };
            let mut quadratic = Quadratic::default();
            quadratic.start();
            for p in &points {
                let value = g[0] * p[0] + g[1] * p[1] + g[2] * p[2] + 0.5 * h.quadratic(*p);
                let [x, y, z] = stretch.apply(*p);
                quadratic.push([x, y, z, value]);
            }
            let fitted = quadratic.fit().unwrap();
            prop_assume!(fitted.quality > 0.05);
            let found = fitted.hessian.congruent(&stretch);
            let size = h.0.iter().fold(1.0f64, |a, x| a.max(x.abs()));
            for i in 0..6 {
                prop_assert!((found.0[i] - h.0[i]).abs() < 1e-8 * size, "{found:?} {h:?} {back:?}");
            }
        }
    }

    #[test]
    fn points_that_do_not_tell_are_no_fit_or_a_poor_one() {
        let mut quadratic = Quadratic::default();
        quadratic.start();
        for i in 1..8 {
            quadratic.push([f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2), 1.0]);
        }
        assert!(quadratic.fit().is_none(), "too few");
        quadratic.start();
        (0..30).for_each(|i| quadratic.push([f64::from(i % 5), f64::from(i / 5), 0.0, 1.0]));
        assert!(quadratic.fit().is_none(), "in a plane");
        quadratic.start();
        for i in 0..50 {
            let [x, y, z] = [i % 5 - 2, i / 5 % 5 - 2, i / 25].map(f64::from);
            quadratic.push([x, y, z, x * x + z]);
        }
        // Two layers: z² is z.
        assert!(quadratic.fit().is_none_or(|fitted| fitted.quality < 1e-6));
    }

    #[test]
    fn a_product_that_is_rounding_is_not_told() {
        // A corner whose points lie on its three sides, two of them beside one by a rounding: xy is nowhere but there.
        let mut quadratic = Quadratic::default();
        quadratic.start();
        let tiny = f64::EPSILON;
        for [x, y, z] in [
            [0.0, 0.0, 0.13],
            [0.11, 0.0, 0.0],
            [0.0, 0.0, 0.077],
            [0.049, 0.0, 0.0],
            [0.053, tiny, 0.04],
            [0.064, tiny, 0.064],
            [0.0, 0.049, 0.057],
            [0.0, 0.075, 0.0],
            [0.0, 0.125, 0.0],
            [0.02, 0.0, 0.09],
        ] {
            quadratic.push([x, y, z, (3.0 * x + 2.0 * y - z).sin()]);
        }
        assert!(quadratic.fit().is_none_or(|fitted| fitted.quality < 1e-6));
    }
}
