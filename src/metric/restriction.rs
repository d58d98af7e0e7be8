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
    let mut changed = vec![false; if steep.is_empty() { 0 } else { logs.len() }];
    for _ in 0..ROUNDS {
        let mut said: BTreeMap<u32, Said> = BTreeMap::new();
        for tet in &steep {
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
            let (least, most) =
                densities.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &x| (a.min(x), b.max(x)));
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
