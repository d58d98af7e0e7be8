//! Viscous flow by OpenFOAM, where it is installed: the friction on a flat plate is that of Blasius, and several processes find what one does.
use geo_adapt::cycle::launch::find_program;
use geo_adapt::cycle::solver::openfoam::drive::{drive, last_time};
use geo_adapt::cycle::solver::openfoam::{Cells, Config, Walls};
use geo_adapt::cycle::solver::{Job, Solver};
use geo_adapt::formats::Dataset;
use geo_adapt::formats::foam::read_cell_field;
use geo_adapt::mesh::TetMesh;
use geo_adapt::mesh::io::write_mesh;
use geo_adapt::mesh::samples::with_boundary;
use std::path::Path;
use std::sync::OnceLock;

/// Nobody ends these solves.
static NEVER: std::sync::atomic::AtomicBool = std::sync::atomic::AtomicBool::new(false);

/// Cells along the flow, across the slab, and away from the plate. The friction is 0.0 % from Blasius' with these, 1.9 % above with 30 along the
/// flow, 3.2 % with 30 and 20 away from the plate.
const CELLS: [u32; 3] = [15, 1, 28];
/// The slab: from half a length before the plate to its end, so wide and so high.
const WIDTH: f64 = 0.05;
const HEIGHT: f64 = 0.6;
/// The part of the plate, reference 8, whose friction is compared: behind the leading edge, where the theory of boundary layers does not hold,
/// and before the outflow.
const PART: [f64; 2] = [0.3, 0.9];
const REYNOLDS: f64 = 1000.0;

/// Mach 0.2 over a plate along z = 0. 1 to 6 are the sides of the slab, 7 to 9 the plate.
const CONFIG: &str = r#"
processes = 1
steps = 1200
still = 5e-4
[flow]
mach = 0.2
reynolds = 1000
area = 0.05
walls = ["7", "8", "9"]
symmetry = ["3", "4", "5"]
farfield = ["1", "2", "6"]
"#;

/// A slab of tetrahedra, thin at the plate.
fn slab() -> TetMesh {
    let [nx, ny, nz] = CELLS;
    let index = |at: [u32; 3]| (at[0] * (ny + 1) + at[1]) * (nz + 1) + at[2];
    let (mut vertices, mut tets) = (Vec::new(), Vec::new());
    for i in 0..=nx {
        for j in 0..=ny {
            vertices.extend((0..=nz).map(|k| [(i, nx), (j, ny), (k, nz)].map(|(at, n)| f64::from(at) / f64::from(n))));
        }
    }
    for cell in 0..nx * ny * nz {
        let corner = [cell / (ny * nz), cell / nz % ny, cell % nz];
        for (order, odd) in
            [([0, 1, 2], 0), ([1, 2, 0], 0), ([2, 0, 1], 0), ([1, 0, 2], 1), ([0, 2, 1], 1), ([2, 1, 0], 1)]
        {
            let mut at = corner;
            let mut nodes = [index(at); 4];
            for (node, axis) in nodes[1..].iter_mut().zip(order) {
                at[axis] += 1;
                *node = index(at);
            }
            nodes.swap(0, odd);
            tets.push(nodes);
        }
    }
    let mut mesh = with_boundary(vertices, tets);
    // Cells grow by e³ from the plate to the top.
    let away = |t: f64| HEIGHT * ((3.0 * t).exp() - 1.0) / (3f64.exp() - 1.0);
    mesh.vertices.iter_mut().for_each(|p| *p = [1.5 * p[0] - 0.5, WIDTH * p[1], away(p[2])]);
    for (nodes, reference) in mesh.triangles.nodes.iter().zip(&mut mesh.triangles.refs) {
        let x = nodes.iter().map(|&v| mesh.vertices[v as usize][0]).sum::<f64>() / 3.0;
        if *reference == 5 && x > 0.0 {
            *reference = if x < PART[0] { 7 } else { 8 + i32::from(x > PART[1]) };
        }
    }
    mesh
}

/// Whether the programs are there; says so where they are not, and fails where they were set up.
fn installed(programs: &[&str]) -> bool {
    let Some(missing) = programs.iter().find(|name| find_program(name, Path::new("/")).is_none()) else { return true };
    let set_up = std::env::var_os("GEO_ADAPT_OPENFOAM").is_some();
    assert!(!set_up, "OpenFOAM was set up, but {missing} is not on the PATH");
    eprintln!("skipped: {missing} is not there (Debian's package openfoam)");
    false
}

/// Drag of the part of the plate, C_D of the whole of it, pressures of the cells.
struct Found {
    part: f64,
    drag: f64,
    pressure: Vec<f64>,
}

fn solve(processes: u32) -> Found {
    let folder = tempfile::tempdir().unwrap();
    let config: Config = toml::from_str(&CONFIG.replace("processes = 1", &format!("processes = {processes}"))).unwrap();
    let (base, mesh, data) = (folder.path(), folder.path().join("mesh.meshb"), slab());
    config.check(base).unwrap();
    write_mesh(&mesh, &data).unwrap();
    let step = base.join("solve");
    std::fs::create_dir(&step).unwrap();
    let job = Job { folder: &step, base, cycle: 1, mesh: &mesh, before: None, threads: 1, thread_words: &[] };
    config.prepare(&job).unwrap();
    let (case, mut log) = (step.join("case"), Vec::new());
    let outcome = drive(&case, &NEVER, &mut |line| log.push(line.to_owned())).unwrap();
    assert!(outcome.still && outcome.repeated == 0, "{log:#?}");
    let solved = config.collect(&job).unwrap();
    let wall = data.triangles.iter().find(|(_, reference)| *reference == 8).unwrap().0[0] as usize;
    assert!(solved.fields[2].values[3 * wall..][..3].iter().all(|&u| u == 0.0), "nothing moves at the wall");
    let time = last_time(&case).unwrap();
    let read = |name: &str| read_cell_field(&time.join(name), data.tets.len()).unwrap().unwrap().values;
    let (pressure, velocity) = (read("p"), read("U"));
    let cells = Cells::of(Dataset { mesh: data, ..Dataset::default() });
    let part = Walls::of(&cells, &[8]).coefficients(&config.flow, &pressure, &velocity).drag;
    eprintln!("{processes} processes: {part} of the part, {}, {} steps", outcome.coefficients.drag, outcome.steps);
    Found { part, drag: solved.functionals["CD"], pressure }
}

/// What one process finds, solved once for both tests.
fn alone() -> &'static Found {
    static FOUND: OnceLock<Found> = OnceLock::new();
    FOUND.get_or_init(|| solve(1))
}

/// The friction coefficient at x is 0.664/√(Re x) (Blasius 1908; Schlichting, Boundary-Layer Theory, section 7e).
#[test]
fn friction_on_a_flat_plate_is_that_of_blasius() {
    if !installed(&["rhoSimpleFoam"]) {
        return;
    }
    let exact = 2.0 * 0.664 * (PART[1].sqrt() - PART[0].sqrt()) / REYNOLDS.sqrt();
    let found = alone().part;
    assert!((found / exact - 1.0).abs() < 0.03, "{found}, not {exact}");
}

#[test]
fn two_processes_find_what_one_does() {
    if !installed(&["rhoSimpleFoam", "decomposePar", "reconstructPar", "mpirun"]) {
        return;
    }
    let (one, two) = (alone(), solve(2));
    assert!((two.drag / one.drag - 1.0).abs() < 1e-4, "{} and {}", one.drag, two.drag);
    // In units of the pressure outside, 1; that of the flow is ½ γ M² = 0.028.
    let apart = one.pressure.iter().zip(&two.pressure).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(apart < 1e-5, "pressures {apart} apart");
}
