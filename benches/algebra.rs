//! The kernel's own tensor algebra beside nalgebra's: what docs/decisions/linear-algebra.md says comes from here. Times are the thread's own CPU
//! time, so that other programs disturb them little.
//!
//!     cargo bench --bench algebra -- --quick
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use geo_adapt::mesh::TetMesh;
use geo_adapt::mesh::samples::cube;
use geo_adapt::mesh::vector::{Vec3, cross, sub, unit};
use geo_adapt::metric::Sym3;
use geo_adapt::metric::batch::Batch;
use geo_adapt::metric::lanes::LANES;
use geo_adapt::metric::quality::mean_ratio;
use geo_adapt::metric::recovery::{Recovery, Rings};
use geo_adapt::tasks::Team;
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use std::hint::black_box;
use std::time::Duration;

/// Inputs of a kernel.
const INPUTS: usize = 1024;

/// Terms of a quadratic function.
const TERMS: usize = 10;

/// Numbers in [0, 1), the same every time (Knuth's linear congruence).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn point(&mut self) -> Vec3 {
        [self.next(), self.next(), self.next()]
    }

    /// Sizes within a factor of `anisotropy`, the least and the greatest of which are there.
    fn sizes(&mut self, anisotropy: f64) -> [f64; 3] {
        [1.0, anisotropy.powf(-self.next()), 1.0 / anisotropy]
    }

    fn metric(&mut self, sizes: [f64; 3]) -> Sym3 {
        let a = unit(self.point());
        let b = unit(cross(a, self.point()));
        Sym3::from_sizes([a, b, cross(a, b)], sizes)
    }
}

/// Nanoseconds that this thread has run.
fn ran() -> u64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    text.split(' ').next().and_then(|word| word.parse().ok()).unwrap_or(0)
}

/// CPU time of so many calls.
fn timed<R>(times: u64, mut call: impl FnMut() -> R) -> Duration {
    let from = ran();
    for _ in 0..times {
        black_box(call());
    }
    // The clock is kept at the scheduler's ticks: nothing would look like no time at all.
    Duration::from_nanos((ran() - from).max(1))
}

/// Times `kernel` over the inputs: an iteration is all of them.
fn over<T, R>(c: &mut Criterion, name: &str, inputs: &[T], kernel: impl Fn(&T) -> R) {
    let all = || {
        inputs.iter().for_each(|input| {
            black_box(kernel(black_box(input)));
        });
    };
    let mut group = c.benchmark_group("algebra");
    group.throughput(Throughput::Elements(inputs.len() as u64));
    group.bench_function(name, |b| b.iter_custom(|times| timed(times, all)));
    group.finish();
}

/// P f(D) Pᵀ.
fn mapped(m: &Matrix3<f64>, f: impl Fn(f64) -> f64) -> Matrix3<f64> {
    let eigen = m.symmetric_eigen();
    eigen.eigenvectors * Matrix3::from_diagonal(&eigen.eigenvalues.map(f)) * eigen.eigenvectors.transpose()
}

fn tensors(c: &mut Criterion) {
    let mut numbers = Numbers(1);
    for anisotropy in [1.05, 100.0, 1e5] {
        let metrics: Vec<Sym3> = (0..INPUTS)
            .map(|_| {
                let sizes = numbers.sizes(anisotropy);
                numbers.metric(sizes)
            })
            .collect();
        let logs: Vec<Sym3> = metrics.iter().map(Sym3::ln).collect();
        let theirs = |tensors: &[Sym3]| tensors.iter().map(|&m| m.into()).collect::<Vec<Matrix3<f64>>>();
        over(c, &format!("exp, anisotropy {anisotropy}, ours"), &logs, Sym3::exp);
        over(c, &format!("exp, anisotropy {anisotropy}, nalgebra"), &theirs(&logs), |m| mapped(m, f64::exp));
        over(c, &format!("ln, anisotropy {anisotropy}, ours"), &metrics, Sym3::ln);
        over(c, &format!("ln, anisotropy {anisotropy}, nalgebra"), &theirs(&metrics), |m| mapped(m, f64::ln));
        over(c, &format!("eigen, anisotropy {anisotropy}, ours"), &metrics, Sym3::eigen_spd);
        over(c, &format!("eigen, anisotropy {anisotropy}, nalgebra"), &theirs(&metrics), |m| m.symmetric_eigen());
    }
    let forms: Vec<(Sym3, Vec3)> = (0..INPUTS).map(|_| (numbers.metric([1.0, 0.1, 0.01]), numbers.point())).collect();
    let theirs: Vec<(Matrix3<f64>, Vector3<f64>)> = forms.iter().map(|&(m, v)| (m.into(), v.into())).collect();
    over(c, "quadratic form, ours", &forms, |(m, v)| m.quadratic(*v));
    over(c, "quadratic form, nalgebra", &theirs, |(m, v)| v.dot(&(m * v)));
}

/// How many figures the eigenvalues keep: each metric is known by its sizes.
fn accuracy(_: &mut Criterion) {
    let mut numbers = Numbers(5);
    for anisotropy in [100.0, 1e4, 1e6] {
        let mut worst = [0.0f64; 2];
        for _ in 0..10_000 {
            let sizes = numbers.sizes(anisotropy);
            let m = numbers.metric(sizes);
            let mut theirs = Matrix3::from(m).symmetric_eigenvalues();
            theirs.as_mut_slice().sort_by(f64::total_cmp);
            for (worst, least) in worst.iter_mut().zip([m.eigen_spd().values[0], theirs[0]]) {
                // The greatest size is 1.
                *worst = worst.max((least - 1.0).abs());
            }
        }
        let [ours, theirs] = worst;
        println!(
            "anisotropy {anisotropy:e}: the least eigenvalue is off by {ours:.1e} at most, nalgebra's by {theirs:.1e}"
        );
    }
}

/// Mean ratio in the log-Euclidean mean of the metrics of the corners, as `metric::quality` defines it.
fn mean_ratio_by_nalgebra(corners: &[Vector3<f64>; 4], logs: &[Matrix3<f64>; 4]) -> f64 {
    let m = mapped(&((logs[0] + logs[1] + logs[2] + logs[3]) * 0.25), f64::exp);
    let [u, v, w] = [1, 2, 3].map(|i| corners[i] - corners[0]);
    let squares: f64 = [u, v, w, v - u, w - u, w - v].iter().map(|e| e.dot(&(m * e))).sum();
    let volume = m.determinant().sqrt() * Matrix3::from_columns(&[u, v, w]).determinant();
    12.0 * (0.5 * volume).powf(2.0 / 3.0) / squares
}

fn quality(c: &mut Criterion) {
    let mut numbers = Numbers(2);
    let tets: Vec<([Vec3; 4], [Sym3; 4])> = (0..INPUTS)
        .map(|_| {
            let mut corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
            for x in corners.iter_mut().flatten() {
                *x += 0.2 * numbers.next();
            }
            let log = numbers.metric([1.0, 0.1, 0.01]).ln();
            (corners, [0.0, 0.1, 0.2, 0.3].map(|x| log.times(1.0 + x)))
        })
        .collect();
    let theirs: Vec<_> = tets.iter().map(|(p, logs)| (p.map(Vector3::from), logs.map(Matrix3::from))).collect();
    for ((p, logs), (q, matrices)) in tets.iter().zip(&theirs) {
        let [ours, theirs] = [mean_ratio(*p, logs.each_ref()), mean_ratio_by_nalgebra(q, matrices)];
        assert!((ours - theirs).abs() < 1e-9, "{ours} {theirs}");
    }
    over(c, "mean ratio, ours", &tets, |(p, logs)| mean_ratio(*p, logs.each_ref()));
    over(c, "mean ratio, nalgebra", &theirs, |(p, logs)| mean_ratio_by_nalgebra(p, logs));
    let batches: Vec<(Batch, Vec3, Sym3)> = tets
        .chunks_exact(LANES)
        .map(|some| {
            let mut batch = Batch::default();
            for (lane, (p, logs)) in some.iter().enumerate() {
                batch.set(lane, [p[0], p[1], p[2]], [&logs[0], &logs[1], &logs[2]]);
            }
            batch.prepare();
            (batch, some[0].0[3], some[0].1[3])
        })
        .collect();
    over(c, "mean ratio, ours, eight at once", &batches, |(batch, p, log)| batch.shapes(*p, log).mean_ratios());
}

/// The Hessian of the quadratic function nearest to the values of a vertex's neighbours and theirs, by Householder's reflections.
fn fit_by_nalgebra(mesh: &TetMesh, rings: &Rings, values: &[f64], vertex: u32) -> Option<Matrix3<f64>> {
    let mut around: Vec<u32> = rings.neighbours(vertex).to_vec();
    if around.len() < 14 {
        let first = around.clone();
        around.extend(first.iter().flat_map(|&near| rings.neighbours(near)));
        around.sort_unstable();
        around.dedup();
    }
    let mut rows = DMatrix::zeros(around.len() + 1, TERMS);
    let mut right = DVector::zeros(around.len() + 1);
    for (row, &node) in around.iter().chain([&vertex]).enumerate() {
        let [x, y, z] = sub(mesh.vertices[node as usize], mesh.vertices[vertex as usize]);
        let terms = [1.0, x, y, z, 0.5 * x * x, x * y, 0.5 * y * y, x * z, y * z, 0.5 * z * z];
        terms.iter().enumerate().for_each(|(term, value)| rows[(row, term)] = *value);
        right[row] = values[node as usize] - values[vertex as usize];
    }
    let (q, r) = rows.qr().unpack();
    let h = r.solve_upper_triangular(&q.tr_mul(&right))?;
    Some(Matrix3::new(h[4], h[5], h[7], h[5], h[6], h[8], h[7], h[8], h[9]))
}

fn recovery(c: &mut Criterion) {
    let mesh = cube(12);
    let values: Vec<f64> = mesh.vertices.iter().map(|p| (3.0 * p[0] - p[1]).sin() * p[2].cos()).collect();
    let rings = Rings::of(Team::alone(), &mesh);
    println!("fits of a quadratic function: {} vertices an iteration", mesh.vertices.len());
    let mut group = c.benchmark_group("fit of a quadratic function");
    group.throughput(Throughput::Elements(mesh.vertices.len() as u64)).sample_size(10);
    let ours = || Recovery::Fit.hessians(Team::alone(), &mesh, &rings, &values);
    group.bench_function("ours", |b| b.iter_custom(|times| timed(times, ours)));
    let theirs = || (0..values.len() as u32).map(|v| fit_by_nalgebra(&mesh, &rings, &values, v)).collect::<Vec<_>>();
    group.bench_function("nalgebra", |b| b.iter_custom(|times| timed(times, theirs)));
    group.finish();
}

#[allow(missing_docs, reason = "the macro writes a public function")]
mod group {
    use super::*;
    criterion_group!(benches, accuracy, tensors, quality, recovery);
}

criterion_main!(group::benches);
