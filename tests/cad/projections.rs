//! Closest points on faces against CGAL's AABB trees over BRepMesh's triangles, on many random points. CGAL's trees are
//! GPL: they are in a program of their own (tests/oracle), built here with g++ where CGAL is installed, and asked
//! through pipes.
//!
//! `GEO_ADAPT_PROJECTIONS=1000000` asks for a million points instead of the usual number.

use crate::common::models::{Random, models};
use geo_adapt::geometry::{Evaluate, Geometry, OcctModel};
use geo_adapt::mesh::vector::{Vec3, distance};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Points over all models, unless the environment tells another number.
const POINTS: usize = 50_000;
/// What a triangle may be off its face, as a share of the face's size.
const CHORD: &str = "5e-4";
/// The errors of the triangles are measured at their middles and sides: between those a little more is allowed.
const BETWEEN: f64 = 2.0;

/// Builds the oracle, if there is CGAL to build it with.
fn oracle() -> Option<PathBuf> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/oracle/aabb.cpp");
    let include = |name: &str, inner: &str| {
        let named = std::env::var_os(name).map(PathBuf::from).into_iter();
        named.chain(["/usr/include".into(), "/usr/local/include".into()]).find(|folder| folder.join(inner).is_file())
    };
    let found =
        include("CGAL_INCLUDE", "CGAL/AABB_tree.h")
            .zip(include("OCCT_INCLUDE", "Standard_Version.hxx").or_else(|| {
                include("OCCT_INCLUDE", "opencascade/Standard_Version.hxx").map(|f| f.join("opencascade"))
            }));
    let Some((cgal, occt)) = found else {
        assert!(std::env::var_os("GEO_ADAPT_SET_UP").is_none(), "CGAL is missing: apt-get install libcgal-dev");
        eprintln!("skipped: CGAL is not there (Debian: libcgal-dev)");
        return None;
    };
    let program = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("aabb-{}", std::process::id()));
    let mut build = Command::new("g++");
    build.args(["-std=c++17", "-O2", "-w", "-isystem"]).arg(occt).arg("-I").arg(cgal).arg(source);
    if let Some(folder) = std::env::var_os("OCCT_LIB") {
        build.arg("-L").arg(folder);
    }
    let libraries = "TKMesh TKSTEP TKXSBase TKTopAlgo TKBRep TKGeomBase TKG3d TKG2d TKMath TKernel";
    build.arg("-o").arg(&program).args(libraries.split(' ').map(|library| format!("-l{library}")));
    assert!(build.status().expect("g++ runs").success(), "tests/oracle/aabb.cpp does not compile");
    Some(program)
}

/// The oracle's errors of its faces, and its distances.
fn ask(program: &Path, model: &Path, queries: &[(u32, Vec3)]) -> (Vec<f64>, Vec<f64>) {
    let mut child = Command::new(program)
        .arg(model)
        .arg(CHORD)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("the oracle starts");
    let bytes: Vec<u8> =
        queries.iter().flat_map(|(face, p)| [f64::from(*face), p[0], p[1], p[2]]).flat_map(f64::to_le_bytes).collect();
    let mut input = child.stdin.take().expect("its input is piped");
    let feed = std::thread::spawn(move || input.write_all(&bytes));
    let mut answer = Vec::new();
    child.stdout.take().expect("its output is piped").read_to_end(&mut answer).expect("an answer");
    feed.join().expect("no panic").expect("the oracle reads its input");
    assert!(child.wait().expect("it ends").success(), "the oracle failed on {}", model.display());
    let mut numbers = answer.chunks_exact(8).map(|bytes| f64::from_le_bytes(bytes.try_into().expect("eight bytes")));
    let faces = numbers.next().expect("the number of faces") as usize;
    let errors = numbers.by_ref().take(faces).collect();
    (errors, numbers.collect())
}

/// Points about the faces of a model, in turn: close by, about as far as the face is large, and farther.
fn queries(model: &OcctModel, count: usize, random: &mut Random) -> Vec<(u32, Vec3)> {
    let faces = &model.topology().faces;
    (0..count)
        .map(|k| (k % faces.len(), [0.02, 0.3, 1.0][k / faces.len() % 3]))
        .map(|(face, share)| (face as u32, random.within(faces[face].bounds, share)))
        .collect()
}

#[test]
fn closest_points_are_as_far_as_cgal_finds_the_triangles() {
    let Some(program) = oracle() else { return };
    let wanted = std::env::var("GEO_ADAPT_PROJECTIONS").ok().map(|n| n.parse().expect("a number of points"));
    // IGES knows no shells: OCCT's reader alone gives other faces than ours.
    let models: Vec<_> = models().into_iter().filter(|path| path.extension().is_some_and(|x| x != "igs")).collect();
    let share = wanted.unwrap_or(POINTS).div_ceil(models.len());
    let folder = tempfile::tempdir().unwrap();
    let (mut count, mut coarsest) = (0, 0.0f64);
    for path in &models {
        let model = OcctModel::read(path).unwrap();
        let mut random = Random(21);
        let queries = queries(&model, share, &mut random);
        // Solids that touch share faces when they are loaded: the oracle gets what we have.
        let fused = (model.topology().solids > 1).then(|| folder.path().join("fused.brep"));
        fused.iter().for_each(|fused| model.write_brep(fused).unwrap());
        let (errors, expected) = ask(&program, fused.as_ref().unwrap_or(path), &queries);
        assert_eq!(errors.len(), model.topology().faces.len(), "{}", path.display());
        assert_eq!(expected.len(), queries.len(), "{}", path.display());
        let mut on = model.evaluator();
        for (k, (&(face, point), expected)) in queries.iter().zip(expected).enumerate() {
            let entity = &model.topology().faces[face as usize];
            let what = || format!("{} face {} {:?} from {point:?}", path.display(), face + 1, entity.kind);
            let error = errors[face as usize];
            let size = distance(entity.bounds[0], entity.bounds[1]);
            assert!(error <= 0.01 * size, "{}: the triangles are off by {error:e}", what());
            // A third is asked without a guess, the rest from anywhere: it must not matter.
            let guess = (k % 3 > 0).then(|| entity.range.map(|range| random.between(range)));
            let found = on.closest_on_face(face, point, guess);
            let off = (found.distance - expected).abs();
            let allowed = BETWEEN * error + entity.tolerance + 1e-9 * model.topology().diagonal();
            assert!(off <= allowed, "{}, {guess:?}: {found:?}, CGAL has {expected} ± {allowed:e}", what());
            coarsest = coarsest.max(allowed / size);
            count += 1;
        }
    }
    let _ = std::fs::remove_file(program);
    eprintln!("{count} points on {} models, to {coarsest:.1e} of a face's size at worst", models.len());
    assert!(count >= wanted.unwrap_or(POINTS));
}
