//! What tasks cost: an empty loop by back-end, strategy and grain; a loop bound by memory and one bound by arithmetic, against the
//! same on one thread; scopes and nested loops.
//!
//!     cargo bench --no-default-features --features tbb,openmp --bench tasks -- --quick
//!
//! GEO_ADAPT_BENCH_THREADS says how many threads; else as many as there are cores, at least two.
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use geo_adapt::tasks::{Backend, Plan, Pool, Strategy};
use std::hint::black_box;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// Items of the empty loop.
const ITEMS: usize = 1 << 14;

/// Keeps the compiler from leaving the call out.
fn seen<T>(value: T) {
    black_box(value);
}

fn threads() -> usize {
    let told = std::env::var("GEO_ADAPT_BENCH_THREADS").ok().and_then(|text| text.parse().ok());
    told.unwrap_or_else(|| std::thread::available_parallelism().map_or(2, usize::from).max(2))
}

fn plans(grain: usize) -> Vec<Plan> {
    let built = Backend::ALL.into_iter().filter(|backend| backend.is_built());
    built.flat_map(|backend| Strategy::ALL.map(|strategy| Plan { backend, strategy, grain })).collect()
}

fn name(plan: Plan) -> String {
    format!("{}-{:?}", plan.backend.name(), plan.strategy).to_lowercase()
}

fn empty(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("empty");
    let (pool, alone) = (Pool::new(threads()).expect("threads"), Pool::new(1).expect("one thread"));
    for grain in [1, 16, 256] {
        group.throughput(Throughput::Elements((ITEMS / grain) as u64));
        let one = Plan::of_grain(grain);
        group.bench_function(BenchmarkId::new("one-thread", grain), |bencher| {
            bencher.iter(|| alone.task_for(one, ITEMS, |thread, range| seen((thread, range))));
        });
        for plan in plans(grain) {
            group.bench_function(BenchmarkId::new(name(plan), grain), |bencher| {
                bencher.iter(|| pool.task_for(plan, ITEMS, |thread, range| seen((thread, range))));
            });
        }
    }
    group.finish();
}

/// What it takes to call all threads and see them done.
fn latency(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("latency");
    let pool = Pool::new(threads()).expect("threads");
    for backend in Backend::ALL.into_iter().filter(|backend| backend.is_built()) {
        let plan = Plan { backend, ..Plan::default() };
        group.bench_function(BenchmarkId::new("task_for", backend.name()), |bencher| {
            bencher.iter(|| pool.task_for(plan, pool.threads(), |thread, range| seen((thread, range))));
        });
        group.bench_function(BenchmarkId::new("nested", backend.name()), |bencher| {
            bencher.iter(|| {
                pool.task_for(plan, pool.threads(), |_, _| {
                    pool.task_for(plan, 16, |thread, range| seen((thread, range)));
                });
            });
        });
        group.bench_function(BenchmarkId::new("spawn 1000", backend.name()), |bencher| {
            bencher.iter(|| {
                pool.scope(backend, |scope| (0..1000).for_each(|_| scope.spawn(|task| seen(task.thread()))));
            });
        });
    }
    group.bench_function("on_each_thread", |bencher| bencher.iter(|| pool.on_each_thread(&|thread| seen(thread))));
    group.finish();
}

/// Reads and writes 64 MB: as fast as memory lets it.
fn memory(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("memory");
    let mut numbers = vec![1.0f64; 1 << 23];
    group.throughput(Throughput::Bytes(8 << 23));
    let (pool, alone) = (Pool::new(threads()).expect("threads"), Pool::new(1).expect("one thread"));
    let scale = |chunk: &mut [f64]| chunk.iter_mut().for_each(|number| *number *= 1.000_000_1);
    group.bench_function("one-thread", |bencher| {
        bencher.iter(|| alone.for_each_chunk_mut(Plan::of_grain(1 << 14), &mut numbers, |_, _, chunk| scale(chunk)));
    });
    for plan in plans(1 << 14) {
        group.bench_function(name(plan), |bencher| {
            bencher.iter(|| pool.for_each_chunk_mut(plan, &mut numbers, |_, _, chunk| scale(chunk)));
        });
    }
    group.finish();
}

/// Sums of series whose length varies a hundredfold from item to item: the load must be balanced.
fn compute(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("compute");
    let (pool, alone) = (Pool::new(threads()).expect("threads"), Pool::new(1).expect("one thread"));
    let work = |pool: &Pool, plan| {
        let sum = AtomicU64::new(0);
        pool.task_for(plan, 4096, |_, range| {
            let series = |item: usize| (1..20 + item % 64 * 32).fold(0.0, |sum, k| sum + 1.0 / (k * (k + item)) as f64);
            sum.fetch_add(range.map(series).sum::<f64>().to_bits() >> 40, Relaxed);
        });
        sum.into_inner()
    };
    for grain in [1, 64] {
        let one = Plan::of_grain(grain);
        group.bench_function(BenchmarkId::new("one-thread", grain), |bencher| bencher.iter(|| work(&alone, one)));
        for plan in plans(grain) {
            group.bench_function(BenchmarkId::new(name(plan), grain), |bencher| bencher.iter(|| work(&pool, plan)));
        }
    }
    group.finish();
}

#[allow(missing_docs, reason = "the macro writes a public function")]
mod group {
    use super::*;
    criterion_group!(benches, empty, latency, memory, compute);
}
criterion_main!(group::benches);
