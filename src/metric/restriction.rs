//! A graded metric on a mesh that is much coarser than its sizes, for those who interpolate ln M.
//!
//! Where sizes of 1e-3 and of 1 meet along an edge, ln M linear makes a geometric series of them, and gradation lets them grow in proportion to
//! the distance: the complexity of the one is orders above that of the other ([`Interpolation`]). A file of metrics has no room for what lies
//! between the vertices, so the finest vertex of such a tetrahedron gets larger sizes, until the complexity is near that of sizes which grow
//! from there as fast as gradation lets them. A mesh that is adapted to them is finer there, and can be given more of them.
use super::field::mean_exponential;
use super::frame::{Both, Frame, intersect};
use super::interpolation::{self, ALIKE, Between, DEEPEST};
use super::{Eigen, Interpolation, Sym3};
use crate::mesh::TetMesh;
use crate::mesh::vector::{Vec3, lerp, sub, volume6};
use crate::tasks::{GRAIN, Team};
use std::collections::BTreeMap;

/// A tetrahedron may have so many times the complexity of sizes that grow as fast as they may.
const MORE: f64 = 1.5;

/// Most rounds. Each takes a vertex nearly to where it belongs, as long as its neighbours stay.
const ROUNDS: usize = 40;

/// A tetrahedron with too great a complexity between its corners.
#[derive(Clone, Copy)]
struct Steep {
    nodes: [u32; 4],
    volume: f64,
    /// The complexity that it ought to have.
    wanted: f64,
}

/// What the tetrahedra say of their finest vertex.
struct Said {
    wanted: f64,
    found: f64,
    /// Sum of ln M at the other corners, and their number.
    others: Sym3,
    count: f64,
}

/// Enlarges sizes of a metric that is graded on this mesh by `ratio`, until its complexity with ln M linear between the vertices is near that of
/// sizes which grow by this ratio, from the finest vertices to what the others allow; `logs` is ln M at the vertices, shape
/// (n,). Returns how many vertices were changed: none on a mesh that resolves the metric.
pub fn restrict(team: Team<'_>, mesh: &TetMesh, logs: &mut [Sym3], ratio: f64) -> usize {
    let steep = steep(team, mesh, logs, ratio.ln());
    enlarge(&steep, logs)
}

/// As [`restrict`], of a metric whose sizes are nearly linear between the vertices of any mesh already, as those of layers that grow with the distance
/// from a wall: then the complexity that a tetrahedron ought to have follows from its corners by a formula.
pub fn restrict_linear(team: Team<'_>, mesh: &TetMesh, logs: &mut [Sym3]) -> usize {
    let sizes = team.map(GRAIN, logs.len(), |v| -0.5 * logs[v].eigen().values[2]);
    let steep = team.collect(GRAIN, mesh.tets.len(), |range, steep| {
        for &nodes in &mesh.tets.nodes[range] {
            let densities = nodes.map(|v| density(&logs[v as usize]));
            let (least, most) = ends(densities);
            if most - least <= ALIKE.ln() {
                continue;
            }
            let (thin, thick) = ends(nodes.map(|v| sizes[v as usize]));
            let mean = most.exp() * mean_of_linear(densities.map(|x| most - x), power(most - least, thick - thin));
            let [a, b, c, d] = nodes.map(|v| mesh.vertices[v as usize]);
            let volume = volume6(a, b, c, d) / 6.0;
            if mean_exponential(densities) > MORE * mean {
                steep.push(Steep { nodes, volume, wanted: volume * mean });
            }
        }
    });
    enlarge(&steep, logs)
}

/// The least and the greatest.
fn ends(values: [f64; 4]) -> (f64, f64) {
    values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &x| (a.min(x), b.max(x)))
}

/// The power k by which √det M falls as the least size grows, from the differences of their logarithms: 1 where only the least size does, 3 where all
/// do. Where the least size does not change, another one does, by itself.
fn power(densities: f64, sizes: f64) -> f64 {
    let power = densities / sizes;
    if power < 3.5 { power.clamp(1.0, 3.0) } else { 1.0 }
}

/// The mean of q^(−k) over a tetrahedron in which q is linear, of q = e^(x/k) at the corners, x ≥ 0: f''' = q^(−k) has the mean 3! f[q_0, q_1, q_2, q_3]
/// (Hermite and Genocchi).
fn mean_of_linear(exponents: [f64; 4], power: f64) -> f64 {
    // The formula has no value at whole k.
    let power = if (power - power.round()).abs() < OFF_WHOLE { power.round() + OFF_WHOLE } else { power };
    let mut q = exponents.map(|x| (x / power).exp());
    q.sort_by(f64::total_cmp);
    for i in 1..4 {
        q[i] = q[i].max(q[i - 1] * (1.0 + APART));
    }
    let rising = (1.0 - power) * (2.0 - power) * (3.0 - power);
    let mut differences = q.map(|q| q.powf(3.0 - power) / rising);
    for order in 1..4 {
        for i in 0..4 - order {
            differences[i] = (differences[i + 1] - differences[i]) / (q[i + order] - q[i]);
        }
    }
    (6.0 * differences[0]).clamp(q[3].powf(-power), q[0].powf(-power))
}

/// How far k is from a whole number, and by what share two q differ at least.
const OFF_WHOLE: f64 = 1e-3;
const APART: f64 = 1e-2;

/// Enlarges sizes at the finest vertices of these tetrahedra. Returns at how many.
fn enlarge(steep: &[Steep], logs: &mut [Sym3]) -> usize {
    let mut changed = vec![false; if steep.is_empty() { 0 } else { logs.len() }];
    for _ in 0..ROUNDS {
        let mut said: BTreeMap<u32, Said> = BTreeMap::new();
        for tet in steep {
            let densities = tet.nodes.map(|v| density(&logs[v as usize]));
            let found = tet.volume * mean_exponential(densities);
            if found <= MORE * tet.wanted {
                continue;
            }
            let finest = (1..4).fold(0, |most, i| if densities[i] > densities[most] { i } else { most });
            let none = || Said { wanted: 0.0, found: 0.0, others: Sym3::ZERO, count: 0.0 };
            let said = said.entry(tet.nodes[finest]).or_insert_with(none);
            (said.wanted, said.found) = (said.wanted + tet.wanted, said.found + found);
            for (i, v) in tet.nodes.iter().enumerate().filter(|(i, _)| *i != finest) {
                said.others = said.others.plus(logs[*v as usize]);
                said.count += 1.0;
                debug_assert!(densities[i] <= densities[finest]);
            }
        }
        if said.is_empty() {
            break;
        }
        for (v, said) in said {
            let (log, mean) = (&mut logs[v as usize], said.others.times(1.0 / said.count));
            // Towards the others, as far as ln √det M has to fall.
            let share = (said.found / said.wanted).ln() / (density(log) - density(&mean));
            let share = if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 };
            *log = log.times(1.0 - share).plus(mean.times(share));
            changed[v as usize] = true;
        }
    }
    changed.into_iter().filter(|&changed| changed).count()
}

/// ln √det M.
fn density(log: &Sym3) -> f64 {
    0.5 * log.trace()
}

/// The tetrahedra that have too great a complexity.
fn steep(team: Team<'_>, mesh: &TetMesh, logs: &[Sym3], growth: f64) -> Vec<Steep> {
    team.collect(GRAIN, mesh.tets.len(), |range, steep| {
        for &nodes in &mesh.tets.nodes[range] {
            let densities = nodes.map(|v| density(&logs[v as usize]));
            let (least, most) = ends(densities);
            if most - least <= ALIKE.ln() {
                continue;
            }
            let corners = nodes.map(|v| Corner::of(mesh.vertices[v as usize], Frame::of_log(&logs[v as usize])));
            let [a, b, c, d] = corners.map(|corner| corner.at);
            let volume = volume6(a, b, c, d) / 6.0;
            let wanted = volume * mean_density(corners, growth, DEEPEST);
            if volume * mean_exponential(densities) > MORE * wanted {
                steep.push(Steep { nodes, volume, wanted });
            }
        }
    })
}

/// M at a point, M^(−1/2), and √det M.
#[derive(Clone, Copy)]
struct Corner {
    at: Vec3,
    frame: Frame,
    size: Sym3,
    density: f64,
}

impl interpolation::Corner for Corner {
    fn size(&self) -> Sym3 {
        self.size
    }

    fn density(&self) -> f64 {
        self.density
    }
}

impl Corner {
    fn of(at: Vec3, frame: Frame) -> Self {
        let size = Sym3::from_eigen(&Eigen { values: frame.roots.map(|root| 1.0 / root), vectors: frame.vectors });
        Self { at, frame, size, density: frame.roots.into_iter().product() }
    }

    /// Between two corners of a tetrahedron: sizes are linear, or as all four corners let them grow, if that is coarser; but no coarser than at
    /// the coarser end.
    fn middle(corners: &[Self; 4], [i, j]: [usize; 2], growth: f64) -> Self {
        let [p, q] = [corners[i], corners[j]];
        let at = lerp(p.at, q.at, 0.5);
        let linear = Self::of(at, Frame::of_log(&Interpolation::Sizes.log(&p.size.plus(q.size).times(0.5))));
        let coarse = if p.density < q.density { p.frame } else { q.frame };
        let grown = corners.iter().fold(coarse, |least, corner| {
            let grown = Frame { roots: corner.frame.grown(sub(at, corner.at), growth), ..corner.frame };
            match intersect(&least, &grown, 1e-3) {
                Both::First => least,
                Both::Second => grown,
                Both::New(both) => both,
            }
        });
        let grown = Self::of(at, grown);
        if grown.density < linear.density { grown } else { linear }
    }
}

/// The mean of √det M over a tetrahedron in which sizes grow so.
fn mean_density(corners: [Corner; 4], growth: f64, depth: u32) -> f64 {
    interpolation::mean_density(corners, &|all, ends| Between::Middle(Corner::middle(all, ends, growth)), depth)
}

#[cfg(test)]
mod tests {
    use super::super::field::complexity_between;
    use super::*;
    use crate::mesh::samples::cube;
    use crate::mesh::vector::norm;

    /// Against the sum over many layers of the tetrahedron.
    #[test]
    fn the_mean_of_a_power_of_what_is_linear() {
        for k in [1.0, 1.3, 1.5, 2.0, 2.7, 3.0] {
            for exponents in
                [[0.0, 0.0, 0.0, 9.0], [0.0, 9.0, 9.1, 9.2], [0.0, 2.0, 5.0, 14.0], [0.0, 0.0, 7.0, 7.0], [0.0; 4]]
            {
                let q = exponents.map(|x: f64| (x / k).exp());
                let parts = 48;
                let mut sum = 0.0;
                for (i, j, l) in
                    (0..parts).flat_map(|i| (0..parts).flat_map(move |j| (0..parts).map(move |l| (i, j, l))))
                {
                    // A cube's points to a tetrahedron's, finer about the first corner, the edge and the side to the next ones.
                    let at = |i: i32| (f64::from(i) + 0.5) / f64::from(parts);
                    let (a, b, c) = (at(i).powi(6), at(j).powi(6), at(l).powi(6));
                    let slope = (6.0 * at(i).powi(5)) * (6.0 * at(j).powi(5)) * (6.0 * at(l).powi(5));
                    let weights = [(1.0 - a), a * (1.0 - b), a * b * (1.0 - c), a * b * c];
                    let value: f64 = weights.iter().zip(q).map(|(w, q)| w * q).sum();
                    sum += 6.0 * a * a * b * slope * value.powf(-k) / f64::from(parts).powi(3);
                }
                let found = mean_of_linear(exponents, k);
                assert!((found / sum - 1.0).abs() < 0.05, "{k} {exponents:?}: {found} {sum}");
            }
        }
    }

    /// Layers of 1e-5 and cells of a third: as if sizes were linear between, and no change on a mesh that resolves them.
    #[test]
    fn layers_on_a_coarse_mesh_have_the_complexity_of_linear_sizes() {
        let log = |z: f64| Sym3::diagonal(2.0, 2.0, -2.0 * (1e-5 + 0.2 * z).ln());
        let mut mesh = cube(3);
        let mut logs: Vec<Sym3> = mesh.vertices.iter().map(|p| log(p[2])).collect();
        let asked = logs.clone();
        assert!(restrict_linear(Team::alone(), &mesh, &mut logs) > 8);
        let exact = std::f64::consts::E.powi(2) * (0.20001f64 / 1e-5).ln() / 0.2;
        assert!(complexity_between(Team::alone(), &mesh, &asked) > 20.0 * exact);
        let found = complexity_between(Team::alone(), &mesh, &logs);
        assert!(found > 0.5 * exact && found < 2.0 * exact, "{found} {exact}");
        mesh.vertices.iter_mut().for_each(|p| p[2] *= 3e-4);
        let mut logs: Vec<Sym3> = mesh.vertices.iter().map(|p| log(p[2])).collect();
        assert_eq!(restrict_linear(Team::alone(), &mesh, &mut logs), 0);
    }

    #[test]
    fn a_coarse_mesh_has_the_complexity_of_sizes_that_grow_in_proportion() {
        for n in [1, 3] {
            let mesh = cube(n);
            let log = |h: f64| Sym3::ZERO.plus_identity(-2.0 * h.ln());
            let mut logs: Vec<Sym3> = mesh
                .vertices
                .iter()
                .map(|p| log(1e-3 + 0.4 * (p[0] * p[0] + p[1] * p[1] + p[2] * p[2]).sqrt()))
                .collect();
            let wanted = Interpolation::Sizes.complexity(Team::alone(), &mesh, &logs);
            let before = complexity_between(Team::alone(), &mesh, &logs);
            assert!(before > 100.0 * wanted, "{before} {wanted}");
            let given = logs.clone();
            let changed = restrict(Team::alone(), &mesh, &mut logs, 0.4f64.exp());
            let found = complexity_between(Team::alone(), &mesh, &logs);
            assert!(found < 1.5 * wanted && found > 0.5 * wanted, "{found} {wanted}");
            // Sizes get larger alone, and not as large as the greatest.
            assert!(changed > 0 && changed < logs.len() / 2, "{changed} of {}", logs.len());
            let greatest = given.iter().map(Sym3::trace).fold(f64::INFINITY, f64::min);
            assert!(
                logs.iter()
                    .zip(&given)
                    .all(|(log, given)| log.trace() <= given.trace() && log.trace() >= greatest - 1e-9)
            );
        }
    }

    #[test]
    fn sizes_grow_as_fast_as_they_may() {
        // h = min(1e-3 + 0.4 r, 0.1) about a corner, in a cube of one to whose other corners they have long grown: the integral in spheres, an
        // eighth of them, and what is beyond.
        let mesh = cube(1);
        let growth = 0.4;
        let corner = |p: &Vec3| {
            let size: f64 = if norm(*p) == 0.0 { 1e-3 } else { 0.1 };
            Corner::of(*p, Frame::of_metric(&Sym3::IDENTITY.times(size.powi(-2))))
        };
        let found: f64 = mesh
            .tets
            .nodes
            .iter()
            .map(|nodes| {
                let corners = nodes.map(|v| corner(&mesh.vertices[v as usize]));
                let [a, b, c, d] = corners.map(|corner| corner.at);
                volume6(a, b, c, d) / 6.0 * mean_density(corners, growth, DEEPEST)
            })
            .sum();
        let (far, steps) = ((0.1 - 1e-3) / growth, 100_000);
        let within: f64 = (0..steps)
            .map(|i| {
                let r = far * (f64::from(i) + 0.5) / f64::from(steps);
                r * r / (1e-3 + growth * r).powi(3) * far / f64::from(steps)
            })
            .sum();
        let eighth = std::f64::consts::FRAC_PI_2;
        let exact = eighth * within + 1e3 * (1.0 - eighth * far.powi(3) / 3.0);
        assert!((found / exact - 1.0).abs() < 0.25, "{found} {exact}");
    }

    #[test]
    fn a_mesh_that_resolves_its_metric_keeps_it() {
        let mesh = cube(8);
        let logs: Vec<Sym3> = mesh
            .vertices
            .iter()
            .map(|p| {
                Sym3::from_sizes(
                    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
                    [0.1 + 0.2 * p[2], 0.3, 0.05 + 0.4 * p[0]],
                )
                .ln()
            })
            .collect();
        let mut same = logs.clone();
        assert_eq!(restrict(Team::alone(), &mesh, &mut same, 1.5), 0);
        assert_eq!(same, logs);
    }
}
