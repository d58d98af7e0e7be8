//! B-spline curves and surfaces, rational or not, evaluated from their poles without allocation.
use super::basis::{Functions, Knots, MAX_ORDER};
use super::bridge::ffi;
use super::surface::Jet;
use crate::geometry::CurveFrame;
use crate::mesh::vector::Vec3;

/// A pole times its weight, and the weight: (wx, wy, wz, w).
type Pole = [f64; 4];

/// A B-spline curve.
#[derive(Clone, Debug)]
pub struct SplineCurve {
    knots: Knots,
    poles: Vec<Pole>,
    rational: bool,
}

/// A B-spline surface; poles with v fastest.
#[derive(Clone, Debug)]
pub struct SplineSurface {
    u: Knots,
    v: Knots,
    poles: Vec<Pole>,
    columns: usize,
    rational: bool,
}

fn poles(numbers: &[f64]) -> Vec<Pole> {
    numbers.chunks_exact(4).map(|p| [p[0], p[1], p[2], p[3]]).collect()
}

/// sum += s·p.
#[inline(always)]
fn gather(sum: &mut Pole, s: f64, p: &Pole) {
    for k in 0..4 {
        sum[k] += s * p[k];
    }
}

#[inline(always)]
fn head(p: Pole) -> Vec3 {
    [p[0], p[1], p[2]]
}

/// (a − Σ s·b)/w: one line of the quotient rule.
#[inline(always)]
fn quotient<const K: usize>(a: Pole, weight: f64, parts: [(f64, Vec3); K]) -> Vec3 {
    let inverse = 1.0 / weight;
    std::array::from_fn(|k| (a[k] - parts.iter().map(|(s, b)| s * b[k]).sum::<f64>()) * inverse)
}

impl SplineCurve {
    /// The copy that the bridge gave; none where it is no sound spline.
    pub fn new(record: &ffi::Spline) -> Option<Self> {
        let knots = Knots::new(record.degrees[0] as usize, &record.knots, record.periods[0])?;
        let poles = poles(&record.poles);
        let sound = poles.len() == knots.poles() && poles.iter().all(|p| p[3] > 0.0);
        sound.then_some(Self { knots, poles, rational: record.rational })
    }

    /// C, C′ and C″.
    pub fn frame(&self, t: f64) -> CurveFrame {
        match self.knots.order() {
            4 => self.sized::<4>(4, t),
            6 => self.sized::<6>(6, t),
            order @ ..=9 => self.sized::<9>(order, t),
            order => self.sized::<MAX_ORDER>(order, t),
        }
    }

    #[inline(always)]
    fn sized<const N: usize>(&self, order: usize, t: f64) -> CurveFrame {
        let (t, span) = self.knots.locate(t);
        let functions: Functions<N> = self.knots.functions(order, span, t);
        let first = self.knots.first_pole(span);
        let mut sums = [[0.0; 4]; 3];
        for (j, pole) in self.poles[first..first + order].iter().enumerate() {
            for d in 0..3 {
                gather(&mut sums[d], functions[d][j], pole);
            }
        }
        let [a, a1, a2] = sums;
        if !self.rational {
            return CurveFrame { point: head(a), d1: head(a1), d2: head(a2) };
        }
        let w = a[3];
        let point = quotient(a, w, []);
        let d1 = quotient(a1, w, [(a1[3], point)]);
        CurveFrame { point, d1, d2: quotient(a2, w, [(2.0 * a1[3], d1), (a2[3], point)]) }
    }

    /// Ends of the spans.
    pub fn breaks(&self) -> &[f64] {
        self.knots.breaks()
    }

    /// Degree.
    pub fn degree(&self) -> usize {
        self.knots.order() - 1
    }

    /// Points whose hull holds the curve between `a` and `b`, which lie in one span: its Bezier poles.
    pub fn hull(&self, [a, b]: [f64; 2], out: &mut Vec<Vec3>) {
        let (span, shift) = span_of(&self.knots, [a, b]);
        let order = self.knots.order();
        let first = self.knots.first_pole(span);
        for m in 0..order {
            let row = self.knots.blossom(span, |r| if r < m { b - shift } else { a - shift });
            let mut sum = [0.0; 4];
            for (j, pole) in self.poles[first..first + order].iter().enumerate() {
                gather(&mut sum, row[j], pole);
            }
            out.push(quotient(sum, sum[3], []));
        }
    }
}

/// The span of an interval, and the periods that it lies off.
fn span_of(knots: &Knots, [a, b]: [f64; 2]) -> (usize, f64) {
    let middle = 0.5 * (a + b);
    let (placed, span) = knots.locate(middle);
    (span, middle - placed)
}

impl SplineSurface {
    /// The copy that the bridge gave; none where it is no sound spline.
    pub fn new(record: &ffi::Spline) -> Option<Self> {
        let (u, v) = record.knots.split_at_checked(record.first_knots as usize)?;
        let u = Knots::new(record.degrees[0] as usize, u, record.periods[0])?;
        let v = Knots::new(record.degrees[1] as usize, v, record.periods[1])?;
        let (poles, columns) = (poles(&record.poles), v.poles());
        let sound = poles.len() == u.poles() * columns && poles.iter().all(|p| p[3] > 0.0);
        sound.then_some(Self { u, v, poles, columns, rational: record.rational })
    }

    /// S and its derivatives to the second.
    pub fn jet(&self, uv: [f64; 2]) -> Jet {
        self.evaluated::<true>(uv)
    }

    /// S and its first derivatives; the second ones are zero.
    pub fn tangents(&self, uv: [f64; 2]) -> Jet {
        self.evaluated::<false>(uv)
    }

    #[inline(always)]
    fn evaluated<const SECOND: bool>(&self, uv: [f64; 2]) -> Jet {
        match (self.u.order(), self.v.order()) {
            (4, 4) => self.sized::<4, 4, SECOND>(4, 4, uv),
            (6, 6) => self.sized::<6, 6, SECOND>(6, 6, uv),
            (3, 3) => self.sized::<3, 3, SECOND>(3, 3, uv),
            (a @ ..=9, b @ ..=9) => self.sized::<9, 9, SECOND>(a, b, uv),
            (a, b) => self.sized::<MAX_ORDER, MAX_ORDER, SECOND>(a, b, uv),
        }
    }

    #[inline(always)]
    fn sized<const M: usize, const N: usize, const SECOND: bool>(
        &self,
        rows: usize,
        columns: usize,
        uv: [f64; 2],
    ) -> Jet {
        let ((u, i), (v, j)) = (self.u.locate(uv[0]), self.v.locate(uv[1]));
        let a: Functions<M> = self.u.functions(rows, i, u);
        let b: Functions<N> = self.v.functions(columns, j, v);
        let mut start = self.u.first_pole(i) * self.columns + self.v.first_pole(j);
        // S, Su, Sv, Suu, Suv, Svv of the weighted poles.
        let mut sums = [[0.0; 4]; 6];
        for r in 0..rows {
            let mut line = [[0.0; 4]; 3];
            for (c, pole) in self.poles[start..start + columns].iter().enumerate() {
                for d in 0..if SECOND { 3 } else { 2 } {
                    gather(&mut line[d], b[d][c], pole);
                }
            }
            gather(&mut sums[0], a[0][r], &line[0]);
            gather(&mut sums[1], a[1][r], &line[0]);
            gather(&mut sums[2], a[0][r], &line[1]);
            if SECOND {
                gather(&mut sums[3], a[2][r], &line[0]);
                gather(&mut sums[4], a[1][r], &line[1]);
                gather(&mut sums[5], a[0][r], &line[2]);
            }
            start += self.columns;
        }
        let [s, su, sv, suu, suv, svv] = sums;
        if !self.rational {
            let [point, du, dv, duu, duv, dvv] = sums.map(head);
            return Jet { point, du, dv, duu, duv, dvv };
        }
        let w = s[3];
        let point = quotient(s, w, []);
        let (du, dv) = (quotient(su, w, [(su[3], point)]), quotient(sv, w, [(sv[3], point)]));
        if !SECOND {
            return Jet { point, du, dv, duu: [0.0; 3], duv: [0.0; 3], dvv: [0.0; 3] };
        }
        Jet {
            point,
            du,
            dv,
            duu: quotient(suu, w, [(2.0 * su[3], du), (suu[3], point)]),
            duv: quotient(suv, w, [(su[3], dv), (sv[3], du), (suv[3], point)]),
            dvv: quotient(svv, w, [(2.0 * sv[3], dv), (svv[3], point)]),
        }
    }

    /// Ends of the spans in u (0) or v (1).
    pub fn breaks(&self, k: usize) -> &[f64] {
        if k == 0 { self.u.breaks() } else { self.v.breaks() }
    }

    /// Degree in u (0) or v (1).
    pub fn degree(&self, k: usize) -> usize {
        [&self.u, &self.v][k].order() - 1
    }

    /// Points whose hull holds the surface over a rectangle that lies in one span of u and one of v: its Bezier poles.
    pub fn hull(&self, rectangle: [[f64; 2]; 2], out: &mut Vec<Vec3>) {
        let ((i, u_shift), (j, v_shift)) = (span_of(&self.u, rectangle[0]), span_of(&self.v, rectangle[1]));
        let (rows, columns) = (self.u.order(), self.v.order());
        let start = self.u.first_pole(i) * self.columns + self.v.first_pole(j);
        let row = |knots: &Knots, span: usize, [a, b]: [f64; 2], shift: f64, m: usize| {
            knots.blossom(span, |r| if r < m { b - shift } else { a - shift })
        };
        let across: Vec<_> = (0..columns).map(|n| row(&self.v, j, rectangle[1], v_shift, n)).collect();
        for m in 0..rows {
            let along = row(&self.u, i, rectangle[0], u_shift, m);
            let mut line = [[0.0; 4]; MAX_ORDER];
            for (r, &s) in along[..rows].iter().enumerate() {
                let poles = &self.poles[start + r * self.columns..][..columns];
                line.iter_mut().zip(poles).for_each(|(sum, pole)| gather(sum, s, pole));
            }
            for row in &across {
                let mut sum = [0.0; 4];
                line[..columns].iter().zip(row).for_each(|(pole, &s)| gather(&mut sum, s, pole));
                out.push(quotient(sum, sum[3], []));
            }
        }
    }
}
