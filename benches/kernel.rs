//! The kernel's operations on one thread, each on a mesh as the passes leave it to that operation.
//!
//!     cargo bench --bench kernel                              # minutes; compares with the last time
//!     cargo bench --bench kernel -- --quick                   # under two minutes, coarser
//!     cargo bench --bench kernel -- --quick smoothing         # those whose name holds the word
//!     cargo bench --no-default-features --bench kernel        # without OpenCASCADE: faster to build, the same figures
//!     cargo bench --bench kernel -- --save-baseline before    # then, after a change: -- --baseline before
//!
//! A throughput is items a second; its inverse is the time of an item that was tried, carried out or not. What the items were and what
//! became of them is printed before: when that line is another one, it is not the same work any more and times do not compare. Meshes
//! are generated; the metric is the UGAWG's polar-1 (a layer of strong anisotropy about a cylinder) in a cube without the cylinder,
//! scaled, and interpolated in a background mesh. benches/metric.rs has what is below: tensors, lengths, shapes, location.
use criterion::measurement::WallTime;
use criterion::{BatchSize, BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main};
use geo_adapt::adapt::bench_support::{Domain, Snapshot, Sweep, Workbench, domain};
use geo_adapt::adapt::{Adapted, Counts, Options, Refusal, Silent, adapt};
use geo_adapt::mesh::TetMesh;
use geo_adapt::mesh::samples::cube;
use geo_adapt::mesh::vector::{Vec3, norm};
use geo_adapt::metric::{Analytic, Background, Source};
use geo_adapt::tasks::Pool;
use std::hint::black_box;
use std::time::Duration;

/// As in the program.
#[global_allocator]
static MEMORY: geo_adapt::memory::HugePages = geo_adapt::memory::HugePages;

/// ln of the factor of the metric for some ten thousand vertices.
const LARGE: f64 = 0.0;
/// And for some two thousand.
const SMALL: f64 = -1.0;

/// Sweeps that bring the coarse cube near to its metric, with long and short edges left.
const ROUND: [Sweep; 5] = [Sweep::Split, Sweep::Reconnect, Sweep::Collapse, Sweep::Reconnect, Sweep::Smooth];
const ROUNDS: usize = 3;

/// The field, evaluated.
fn evaluated(log_scale: f64) -> Source {
    Source::Analytic { field: Analytic::Polar1, log_scale }
}

/// The field, interpolated in a mesh of 24³ cells under a map of the unit cube.
fn interpolated(log_scale: f64, map: fn(Vec3) -> Vec3) -> Source {
    let TetMesh { mut vertices, tets, .. } = cube(24);
    vertices.iter_mut().for_each(|p| *p = map(*p));
    let logs = vertices.iter().map(|&p| Analytic::Polar1.log_at(p).plus_identity(log_scale)).collect();
    Source::Background(Background::new(vertices, tets.nodes, logs))
}

/// Half way from the cube to the ball about its centre: curved faces.
fn rounded(p: Vec3) -> Vec3 {
    let off = p.map(|x| 2.0 * x - 1.0);
    let greatest = off.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let shrink = if greatest > 0.0 { 0.5 + 0.5 * greatest / norm(off) } else { 1.0 };
    off.map(|x| 0.5 + 0.5 * shrink * x)
}

fn made(mesh: TetMesh, source: Source) -> (Domain, Snapshot) {
    domain(mesh, source).expect("the surface of a cube is a model")
}

fn filled<'d>(domain: &'d Domain, from: &Snapshot) -> Workbench<'d> {
    Workbench::fill(domain, from).expect("the mesh is valid")
}

fn after(domain: &Domain, from: &Snapshot, sweeps: &[Sweep]) -> Snapshot {
    let mut bench = filled(domain, from);
    bench.sweep_all(sweeps);
    bench.extract(from)
}

fn run(domain: &Domain, from: &Snapshot) -> Adapted {
    let pool = Pool::new(1).expect("one thread is there already");
    let Domain { model, source } = domain;
    adapt(&from.mesh, &from.place, model, source, &Options::default(), &pool, &Silent).expect("the mesh is valid")
}

fn group<'c>(c: &'c mut Criterion, name: &str, items: usize) -> BenchmarkGroup<'c, WallTime> {
    let mut group = c.benchmark_group(name);
    group.sample_size(10).warm_up_time(Duration::from_millis(500)).measurement_time(Duration::from_secs(3));
    group.throughput(Throughput::Elements(items as u64));
    group
}

/// What became of the items, in a line.
fn tell(name: &str, mesh: [usize; 2], counts: &Counts) {
    let refused = Refusal::ALL.iter().zip(counts.refused).filter(|(_, count)| *count > 0);
    let refused: Vec<String> = refused.map(|(refusal, count)| format!("{count} {refusal:?}")).collect();
    let Counts { attempts, done, .. } = counts;
    let [vertices, tets] = mesh;
    println!(
        "\n{name}: {vertices} vertices, {tets} tetrahedra; of {attempts} items {done} done; refused: {}",
        refused.join(", ")
    );
}

/// Times a sweep over all of its items, each time on the same mesh.
fn sweep(c: &mut Criterion, name: &str, domain: &Domain, from: &Snapshot, sweep: Sweep) {
    let mut bench = filled(domain, from);
    // Filling is the same every time, so the ids are.
    let items = bench.items(sweep);
    let mesh = bench.counts();
    tell(name, mesh, &bench.sweep(sweep, &items));
    group(c, "kernel", items.count()).bench_function(name, |b| {
        b.iter_batched_ref(
            || filled(domain, from),
            |bench| bench.sweep(sweep, black_box(&items)),
            BatchSize::PerIteration,
        );
    });
}

/// Operations, each on what the one before it left.
fn operations(c: &mut Criterion) {
    let (domain, mut mesh) = made(cube(8), interpolated(LARGE, |p| p));
    for _ in 0..ROUNDS {
        mesh = after(&domain, &mesh, &ROUND);
    }
    for (name, what) in [
        ("insertion", Sweep::Split),
        ("collapse", Sweep::Collapse),
        ("edge removal", Sweep::RemoveEdges),
        ("face removal", Sweep::RemoveFaces),
        ("reconnection", Sweep::Reconnect),
        ("smoothing", Sweep::Smooth),
    ] {
        sweep(c, name, &domain, &mesh, what);
        // Removals of edges and faces alone are parts of reconnection, on the same mesh.
        if !matches!(what, Sweep::RemoveEdges | Sweep::RemoveFaces) {
            mesh = after(&domain, &mesh, &[what]);
        }
    }
}

/// Cavities that are prepared and not carried out, and the lists of edges, in an adapted mesh.
fn evaluation(c: &mut Criterion) {
    let (domain, mesh) = made(cube(8), interpolated(LARGE, |p| p));
    let extracted = run(&domain, &mesh).extracted;
    let mesh = Snapshot { mesh: extracted.mesh, place: extracted.classification };
    let mut bench = filled(&domain, &mesh);
    let [vertices, tets] = bench.counts();
    group(c, "kernel", vertices).bench_function("ball of a vertex", |b| b.iter(|| bench.balls()));
    let [taken, refused] = bench.removals();
    for (name, removals) in [("star over a ball", taken), ("star over a ball, refused", refused)] {
        let stars = removals.len();
        println!(
            "\n{name}: {vertices} vertices, {tets} tetrahedra; {stars} stars of {} new ones",
            bench.stars(&removals)
        );
        group(c, "kernel", stars).bench_function(name, |b| b.iter(|| bench.stars(black_box(&removals))));
    }
    println!("\nedges listed: {vertices} vertices, {tets} tetrahedra; {} are short", bench.short_edges().len());
    group(c, "kernel", tets).bench_function("edges listed", |b| b.iter(|| bench.short_edges()));
    group(c, "kernel", tets).bench_function("store filled", |b| b.iter_with_large_drop(|| filled(&domain, &mesh)));
    group(c, "kernel", tets).bench_function("mesh extracted", |b| b.iter_with_large_drop(|| bench.extract(&mesh)));
}

/// Renumbering of a store whose order is gone: half of its records came since.
fn order(c: &mut Criterion) {
    let (domain, coarse) = made(cube(8), interpolated(LARGE, |p| p));
    let coarse = after(&domain, &coarse, &ROUND);
    let worn = || {
        let mut bench = filled(&domain, &coarse);
        bench.sweep_all(&[Sweep::Split, Sweep::Collapse, Sweep::Reconnect]);
        bench
    };
    let [vertices, tets] = worn().counts();
    println!("\nstore reordered: {vertices} vertices, {tets} tetrahedra; {} before", coarse.mesh.tets.len());
    group(c, "kernel", tets).bench_function("store reordered", |b| {
        b.iter_batched_ref(worn, Workbench::reorder, BatchSize::PerIteration);
    });
}

/// From a coarse mesh to the metric; items are the vertices of the result.
fn whole_runs(c: &mut Criterion) {
    let round = |mut mesh: TetMesh| {
        mesh.vertices.iter_mut().for_each(|p| *p = rounded(*p));
        mesh
    };
    for (name, mesh, source) in [
        ("cube, evaluated metric", cube(8), evaluated(SMALL)),
        ("cube, background metric", cube(8), interpolated(SMALL, |p| p)),
        ("round, background metric", round(cube(8)), interpolated(SMALL, rounded)),
    ] {
        let (domain, mesh) = made(mesh, source);
        let adapted = run(&domain, &mesh);
        let result = &adapted.extracted.mesh;
        let mut counts = Counts::default();
        adapted.work.iter().for_each(|work| counts.add(&work.counts));
        tell(&format!("whole run, {name}"), [result.vertices.len(), result.tets.len()], &counts);
        group(c, "whole run", result.vertices.len())
            .bench_function(name, |b| b.iter_with_large_drop(|| run(&domain, &mesh)));
    }
}

#[allow(missing_docs, reason = "the macro writes a public function")]
mod group {
    use super::*;
    criterion_group!(benches, operations, evaluation, order, whole_runs);
}

criterion_main!(group::benches);
