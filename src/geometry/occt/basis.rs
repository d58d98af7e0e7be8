//! B-spline basis functions on one span, on the stack (Piegl, Tiller: The NURBS Book, 1997, 2.5; here each derivative
//! comes from the functions of the degree below, and the reciprocal widths of the knots are kept).

/// OCCT's greatest degree.
pub const MAX_DEGREE: usize = 25;
/// Room for the functions of any degree.
pub const MAX_ORDER: usize = MAX_DEGREE + 1;

/// Knots of one direction, copied once.
#[derive(Clone, Debug)]
pub struct Knots {
    degree: usize,
    /// The knots, each as often as its multiplicity. Those of a periodic spline go on beyond both ends.
    flat: Vec<f64>,
    /// The begins of spans that have a length, and the end of the last one.
    breaks: Vec<f64>,
    /// The place in `flat` of each span's first knot (the last of several equal ones).
    firsts: Vec<u32>,
    /// 1/(t[k+1+j] − t[k+1−r+j]) for r in 1..=degree, j in 0..r, span by span.
    inverses: Vec<f64>,
    period: Option<f64>,
}

/// Values, first and second derivatives of the functions that are not zero on a span.
pub type Functions<const N: usize> = [[f64; N]; 3];

impl Knots {
    /// Knots as they are given; none where they are no knots of this degree (not ascending, too few, no span).
    pub fn new(degree: usize, flat: &[f64], period: f64) -> Option<Self> {
        let sound = (1..=MAX_DEGREE).contains(&degree)
            && flat.len() >= 2 * (degree + 1)
            && flat.iter().all(|t| t.is_finite())
            && flat.windows(2).all(|pair| pair[0] <= pair[1]);
        if !sound {
            return None;
        }
        let (mut breaks, mut firsts, mut inverses) = (Vec::new(), Vec::new(), Vec::new());
        for k in degree..flat.len() - degree - 1 {
            if flat[k] == flat[k + 1] {
                continue;
            }
            breaks.push(flat[k]);
            firsts.push(k as u32);
            for r in 1..=degree {
                inverses.extend((0..r).map(|j| 1.0 / (flat[k + 1 + j] - flat[k + 1 + j - r])));
            }
        }
        breaks.push(flat[flat.len() - degree - 1]);
        let period = (period > 0.0).then_some(period);
        (!firsts.is_empty()).then(|| Self { degree, flat: flat.to_vec(), breaks, firsts, inverses, period })
    }

    /// Degree + 1.
    #[inline(always)]
    pub fn order(&self) -> usize {
        self.degree + 1
    }

    /// How many poles there are.
    pub fn poles(&self) -> usize {
        self.flat.len() - self.degree - 1
    }

    /// Ends of the spans.
    pub fn breaks(&self) -> &[f64] {
        &self.breaks
    }

    /// The parameter taken into the period, and its span: at a knot the one after it, beyond the ends the first or last.
    #[inline(always)]
    pub fn locate(&self, t: f64) -> (f64, usize) {
        let last = self.breaks.len() - 1;
        let t = match self.period {
            Some(period) if t < self.breaks[0] || t > self.breaks[last] => {
                t - period * ((t - self.breaks[0]) / period).floor()
            }
            _ => t,
        };
        (t, self.breaks[1..last].partition_point(|&knot| knot <= t))
    }

    /// The first pole of a span.
    #[inline(always)]
    pub fn first_pole(&self, span: usize) -> usize {
        self.firsts[span] as usize - self.degree
    }

    /// The knots about a span, t[k+1−p..=k+p], and its inverses.
    #[inline(always)]
    fn about(&self, span: usize, degree: usize) -> (&[f64], &[f64]) {
        let k = self.firsts[span] as usize;
        let count = degree * (degree + 1) / 2;
        (&self.flat[k + 1 - degree..k + 1 + degree], &self.inverses[span * count..(span + 1) * count])
    }

    /// The functions of a span with their derivatives. `order` is [`Knots::order`], handed in so that a caller who
    /// knows it has the loops unrolled; N is at least as large.
    #[inline(always)]
    pub fn functions<const N: usize>(&self, order: usize, span: usize, t: f64) -> Functions<N> {
        let degree = order - 1;
        let (knots, inverses) = self.about(span, degree);
        let (mut now, mut first, mut second) = ([0.0; N], [0.0; N], [0.0; N]);
        now[0] = 1.0;
        let mut offset = 0;
        for r in 1..=degree {
            let row = &inverses[offset..offset + r];
            if r + 1 == degree {
                // Second derivatives begin as first ones of the degree r = p − 1, from the functions of degree p − 2.
                differences(&now, row, r, &mut second);
            } else if r == degree {
                differences(&now, row, r, &mut first);
                let slopes = second;
                differences(&slopes, row, r, &mut second);
            }
            let mut saved = 0.0;
            for j in 0..r {
                let part = now[j] * row[j];
                now[j] = saved + (knots[degree + j] - t) * part;
                saved = (t - knots[degree - r + j]) * part;
            }
            now[r] = saved;
            offset += r;
        }
        [now, first, second]
    }

    /// The functions' blossoms: with all arguments equal they are the functions; with a^(p−m) b^m they give the m-th
    /// Bezier pole of [a, b], which lies in the span.
    pub fn blossom(&self, span: usize, argument: impl Fn(usize) -> f64) -> [f64; MAX_ORDER] {
        let degree = self.degree;
        let (knots, inverses) = self.about(span, degree);
        let mut now = [0.0; MAX_ORDER];
        now[0] = 1.0;
        let mut offset = 0;
        for r in 1..=degree {
            let t = argument(r - 1);
            let mut saved = 0.0;
            for j in 0..r {
                let part = now[j] * inverses[offset + j];
                now[j] = saved + (knots[degree + j] - t) * part;
                saved = (t - knots[degree - r + j]) * part;
            }
            now[r] = saved;
            offset += r;
        }
        now
    }
}

/// Derivatives of the r + 1 functions of degree r from the r below: r (N[j−1]/width[j−1] − N[j]/width[j]).
#[inline(always)]
fn differences<const N: usize>(below: &[f64; N], inverses: &[f64], r: usize, out: &mut [f64; N]) {
    let factor = r as f64;
    let mut before = 0.0;
    for j in 0..r {
        let part = factor * below[j] * inverses[j];
        out[j] = before - part;
        before = part;
    }
    out[r] = before;
}
