//! Evaluation and closest points of the CAD faces that have no closed form: from the copies, and over the bridge to
//! OpenCASCADE, in one run. Times are the thread's own CPU time, so that other programs disturb them little.
//!
//!     cargo bench --bench geometry -- --quick
#[cfg(not(feature = "occt"))]
fn main() {
    eprintln!("nothing to measure without the feature occt");
}

#[cfg(feature = "occt")]
criterion::criterion_main!(faces::group::benches);

#[cfg(feature = "occt")]
mod faces {
    use criterion::{Criterion, Throughput, criterion_group};
    use geo_adapt::geometry::{Evaluate, Geometry, OcctEvaluator, OcctModel, SurfaceKind};
    use geo_adapt::mesh::vector::{Vec3, add, norm, scale};
    use std::hint::black_box;
    use std::path::{Path, PathBuf};
    use std::time::Duration;

    /// Points of a kind of face.
    const POINTS: usize = 512;

    /// Numbers in [0, 1), the same every time (Knuth's linear congruence).
    struct Numbers(u64);

    impl Numbers {
        fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1u64 << 53) as f64
        }

        fn sign(&mut self) -> f64 {
            2.0 * self.next() - 1.0
        }
    }

    /// A point near a face, the parameters of its foot, and a guess one per cent of the range off.
    struct Case {
        face: u32,
        point: Vec3,
        uv: [f64; 2],
        guess: [f64; 2],
    }

    /// Nanoseconds that this thread has run.
    fn ran() -> u64 {
        let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
        text.split(' ').next().and_then(|word| word.parse().ok()).unwrap_or(0)
    }

    fn models() -> Vec<PathBuf> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let names = [
            "geometry/wing.step",
            "geometry/spheroid.step",
            "tests/data/duct.brep",
            "tests/data/blade.brep",
            "tests/data/nurbs-torus.brep",
            "../shared/cases/onera-m6/onera-m6-sharp-te.stp",
        ];
        names.map(|name| root.join(name)).into_iter().filter(|path| path.is_file()).collect()
    }

    /// Points off the faces of a kind, within the reach of the curvature, some by the faces in turn.
    fn cases(on: &mut OcctEvaluator, model: &OcctModel, kind: SurfaceKind) -> Vec<Case> {
        let mut numbers = Numbers(7);
        let faces = (0..).zip(&model.topology().faces).filter(|(_, face)| face.kind == kind);
        let faces: Vec<u32> = faces.map(|(i, _)| i).collect();
        (0..POINTS)
            .map(|k| {
                let face = faces[k % faces.len()];
                let range = model.topology().faces[face as usize].range;
                let uv = range.map(|[low, high]| low + (high - low) * (0.02 + 0.96 * numbers.next()));
                let frame = on.face_frame(face, uv);
                let reach = 0.3 / frame.curvatures[0].abs().max(1e-3);
                let size = norm(frame.du) * (range[0][1] - range[0][0]);
                let point = add(frame.point, scale(frame.normal, numbers.sign() * reach.min(0.02 * size)));
                let guess = [0, 1].map(|k: usize| uv[k] + 0.01 * (range[k][1] - range[k][0]) * numbers.sign());
                Case { face, point, uv, guess }
            })
            .collect()
    }

    /// Times a look at all cases.
    fn time<R>(c: &mut Criterion, name: &str, cases: &[Case], mut look: impl FnMut(&Case) -> R) {
        let mut group = c.benchmark_group("faces");
        group.throughput(Throughput::Elements(cases.len() as u64));
        group.bench_function(name, |b| {
            b.iter_custom(|times| {
                let from = ran();
                for _ in 0..times {
                    cases.iter().for_each(|case| {
                        black_box(look(black_box(case)));
                    });
                }
                // The clock is kept at the scheduler's ticks: nothing would look like no time at all.
                Duration::from_nanos((ran() - from).max(1))
            });
        });
        group.finish();
    }

    fn all(c: &mut Criterion) {
        for path in models() {
            let copied = OcctModel::read(&path).expect("a model of the repository");
            let bridged = OcctModel::read(&path).expect("a model of the repository").without_copies();
            let name = path.file_stem().and_then(|name| name.to_str()).unwrap_or_default().to_string();
            use SurfaceKind::{BSpline, Extrusion, Revolution};
            for kind in [BSpline, Revolution, Extrusion] {
                if !copied.topology().faces.iter().any(|face| face.kind == kind) {
                    continue;
                }
                let cases = cases(&mut copied.evaluator(), &copied, kind);
                for (model, way) in [(&bridged, "bridge"), (&copied, "copy")] {
                    let mut on = model.evaluator();
                    let on = std::cell::RefCell::new(&mut on);
                    let name = |what: &str| format!("{name} {kind:?}, {what}, {way}");
                    time(c, &name("D2"), &cases, |case| on.borrow_mut().surface_derivatives(case.face, case.uv));
                    time(c, &name("closest_on_surface"), &cases, |case| {
                        on.borrow_mut().closest_on_surface(case.face, case.point, case.guess)
                    });
                    time(c, &name("closest_on_face, guess"), &cases, |case| {
                        on.borrow_mut().closest_on_face(case.face, case.point, Some(case.guess))
                    });
                    time(c, &name("closest_on_face"), &cases, |case| {
                        on.borrow_mut().closest_on_face(case.face, case.point, None)
                    });
                }
            }
        }
    }

    #[allow(missing_docs, reason = "the macro writes a public function")]
    pub mod group {
        use super::*;
        criterion_group!(benches, all);
    }
}
