//! The hot kernels of the metric: tensor maps, edge length, mean ratio, location. One call an iteration, over inputs that
//! vary as they do in a mesh; those "eight at once" are one call for eight edges or tetrahedra.
//!
//!     cargo bench --bench metric -- --quick             # all; without --quick finer, and compared with the last time
//!     cargo bench --bench metric -- --quick mean_ratio  # those whose name holds the word
use criterion::{Criterion, criterion_group, criterion_main};
use geo_adapt::mesh::TetMesh;
use geo_adapt::mesh::samples::cube;
use geo_adapt::mesh::vector::{Vec3, cross, unit};
use geo_adapt::metric::batch::{Batch, IncidentEdges};
use geo_adapt::metric::energy::Energy;
use geo_adapt::metric::lanes::{LANES, Lanes, everywhere_tensor};
use geo_adapt::metric::quality::{edge_length, mean_ratio, mean_ratio_in};
use geo_adapt::metric::{Background, Sym3};
use std::hint::black_box;

/// Inputs of a kernel; a power of two.
const INPUTS: usize = 1024;

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

    /// Sizes within a factor of `anisotropy`.
    fn metric(&mut self, anisotropy: f64) -> Sym3 {
        let a = unit(self.point());
        let b = unit(cross(a, self.point()));
        let sizes = self.point().map(|x| anisotropy.powf(-x));
        Sym3::from_sizes([a, b, cross(a, b)], sizes)
    }
}

/// Times `kernel` over the inputs in turn.
fn over<T, R>(c: &mut Criterion, name: &str, inputs: &[T], kernel: impl Fn(&T) -> R) {
    let mut i = 0;
    c.bench_function(name, |b| {
        b.iter(|| {
            i = (i + 1) % inputs.len();
            kernel(black_box(&inputs[i]))
        });
    });
}

/// Tensor maps.
fn tensors(c: &mut Criterion) {
    let mut numbers = Numbers(1);
    for anisotropy in [1.05, 100.0, 1e5] {
        let metrics: Vec<Sym3> = (0..INPUTS).map(|_| numbers.metric(anisotropy)).collect();
        let logs: Vec<Sym3> = metrics.iter().map(Sym3::ln).collect();
        over(c, &format!("exp, anisotropy {anisotropy}"), &logs, |m| m.exp());
        over(c, &format!("ln, anisotropy {anisotropy}"), &metrics, |m| m.ln());
    }
    let metrics: Vec<Sym3> = (0..INPUTS).map(|_| numbers.metric(100.0)).collect();
    over(c, "eigen", &metrics, |m| m.eigen());
    over(c, "eigen_jacobi", &metrics, |m| m.eigen_jacobi());
    let pairs: Vec<(Sym3, Sym3)> = metrics.iter().copied().zip(metrics.iter().rev().copied()).collect();
    over(c, "intersect", &pairs, |(a, b)| a.intersect(b));
}

fn quality(c: &mut Criterion) {
    let mut numbers = Numbers(2);
    let edges: Vec<(Vec3, Sym3, Sym3)> =
        (0..INPUTS).map(|_| (numbers.point(), numbers.metric(100.0), numbers.metric(100.0))).collect();
    over(c, "edge_length", &edges, |(v, a, b)| edge_length(*v, a, b));
    // Numbers of their own: the inputs below stay what they were.
    let mut others = Numbers(4);
    let incident: Vec<(IncidentEdges, Vec3, Sym3)> = edges
        .chunks_exact(LANES)
        .map(|some| {
            let mut incident = IncidentEdges::default();
            for (lane, (point, metric, _)) in some.iter().enumerate() {
                incident.set(lane, *point, metric);
            }
            (incident, others.point(), others.metric(100.0))
        })
        .collect();
    over(c, "edge_length, eight at once", &incident, |(incident, p, metric)| incident.lengths(*p, metric));
    // Corners near those of a right tetrahedron: positive. Metrics of neighbours differ little.
    let tets: Vec<([Vec3; 4], [Sym3; 4])> = (0..INPUTS)
        .map(|_| {
            let mut corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
            for x in corners.iter_mut().flatten() {
                *x += 0.2 * numbers.next();
            }
            let log = numbers.metric(100.0).ln();
            (corners, [0.0, 0.1, 0.2, 0.3].map(|x| log.times(1.0 + x)))
        })
        .collect();
    over(c, "mean_ratio", &tets, |(p, logs)| mean_ratio(*p, logs.each_ref()));
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
    over(c, "mean_ratio, eight at once", &batches, |(batch, p, log)| batch.shapes(*p, log).mean_ratios());
    over(c, "mean_ratio, eight at once, cubed", &batches, |(batch, p, log)| batch.shapes(*p, log));
    let with_metric: Vec<(Batch, Vec3, Sym3)> =
        batches.iter().map(|(batch, p, log)| (batch.clone(), *p, log.exp())).collect();
    over(c, "quadratic model, eight at once", &with_metric, |(batch, p, metric)| {
        let mut energy = Energy::at(*p, metric);
        energy.add_tets(batch, &everywhere_tensor(metric), &Lanes::all(1.0));
        energy.model()
    });
    over(c, "batch prepared", &batches, |(batch, ..)| {
        let mut batch = batch.clone();
        batch.prepare();
        batch
    });
    over(c, "mean_ratio_in", &tets, |(p, logs)| mean_ratio_in(*p, &logs[0], 1.0));
}

fn location(c: &mut Criterion) {
    let TetMesh { vertices, tets, .. } = cube(24);
    let mut numbers = Numbers(3);
    let logs = vertices.iter().map(|_| numbers.metric(100.0).ln()).collect();
    let background = Background::new(vertices, tets.nodes, logs);
    let mut p = [0.5; 3];
    let mut hint = 0;
    // A step of half a cell from the last point, as the kernel's hints are.
    c.bench_function("background, near hint (83k tets)", |b| {
        b.iter(|| {
            p = p.map(|x| (x + 0.04 * (numbers.next() - 0.5)).clamp(0.0, 1.0));
            background.log_at(p, &mut hint)
        });
    });
    c.bench_function("background, far hint", |b| b.iter(|| background.log_at(numbers.point(), &mut hint)));
    c.bench_function("background, no hint", |b| b.iter(|| background.log_at(numbers.point(), &mut u32::MAX.clone())));
    c.bench_function("background, outside", |b| {
        b.iter(|| {
            p = p.map(|x| (x + 0.04 * (numbers.next() - 0.5)).clamp(0.0, 1.0));
            background.log_at([p[0], p[1], 1.002], &mut hint)
        });
    });
}

#[allow(missing_docs, reason = "the macro writes a public function")]
mod group {
    use super::*;
    criterion_group!(benches, tensors, quality, location);
}

criterion_main!(group::benches);
