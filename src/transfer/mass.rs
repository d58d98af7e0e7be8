//! Volumes and integrals, in sums that lose nothing to rounding.
use super::error::{Error, Which};
use crate::mesh::TetMesh;
use crate::mesh::predicate::is_positive;
use crate::mesh::vector::{Vec3, volume6};
use crate::tasks::{GRAIN, Team};
use std::ops::Range;

/// A compensated sum (Neumaier, *Rundungsfehleranalyse einiger Verfahren zur Summation endlicher Summen*, ZAMM 54, 1974).
#[derive(Clone, Copy, Debug, Default)]
pub struct Sum {
    sum: f64,
    lost: f64,
}

impl Sum {
    /// One term more.
    #[inline]
    pub fn add(&mut self, term: f64) {
        let sum = self.sum + term;
        self.lost += if self.sum.abs() >= term.abs() { (self.sum - sum) + term } else { (term - sum) + self.sum };
        self.sum = sum;
    }

    /// All terms of another one.
    pub fn join(&mut self, other: Self) {
        self.add(other.sum);
        self.lost += other.lost;
    }

    /// The sum.
    pub fn value(self) -> f64 {
        self.sum + self.lost
    }
}

/// Σ of each row of `width` terms that `terms(item, row)` writes.
pub fn sums(team: Team<'_>, items: usize, width: usize, terms: impl Fn(usize, &mut [f64]) + Sync) -> Vec<f64> {
    joined(width, team.chunks(GRAIN, items, |range| part_of_sums(range, width, &terms)))
}

/// The part of [`sums`] that is of these items: of GRAIN ones, in their order.
pub fn part_of_sums(items: Range<usize>, width: usize, terms: impl Fn(usize, &mut [f64])) -> Vec<Sum> {
    let (mut row, mut sums) = (vec![0.0; width], vec![Sum::default(); width]);
    for item in items {
        terms(item, &mut row);
        sums.iter_mut().zip(&row).for_each(|(sum, &term)| sum.add(term));
    }
    sums
}

/// The sums of these parts, in their order.
pub fn joined(width: usize, parts: impl IntoIterator<Item = Vec<Sum>>) -> Vec<f64> {
    let mut all = vec![Sum::default(); width];
    for part in parts {
        all.iter_mut().zip(part).for_each(|(all, part)| all.join(part));
    }
    all.into_iter().map(Sum::value).collect()
}

/// Volume of a tetrahedron of a mesh, 0 where it is flat.
#[inline]
pub fn volume(mesh: &TetMesh, tet: usize) -> f64 {
    volume_of(mesh.tets.nodes[tet].map(|v| mesh.vertices[v as usize]))
}

/// Volume of a tetrahedron with these corners, 0 where it is flat.
#[inline]
pub fn volume_of([a, b, c, d]: [Vec3; 4]) -> f64 {
    (volume6(a, b, c, d) / 6.0).max(0.0)
}

/// Refuses a mesh with an inverted tetrahedron, or with no volume.
///
/// # Errors
/// [`Error`] with the first one.
pub fn check(team: Team<'_>, mesh: &TetMesh, which: Which) -> Result<(), Error> {
    let is_inverted = |tet: &usize| is_inverted(mesh.tets.nodes[*tet].map(|v| mesh.vertices[v as usize]));
    let parts = team.chunks(GRAIN, mesh.tets.len(), |range| {
        let first = range.clone().find(is_inverted);
        (first, range.map(|tet| volume(mesh, tet)).fold(0.0, f64::max))
    });
    if let Some(tet) = parts.iter().find_map(|part| part.0) {
        return Err(Error::Inverted { mesh: which, tet });
    }
    if parts.iter().any(|part| part.1 > 0.0) { Ok(()) } else { Err(Error::NoVolume(which)) }
}

/// Whether a tetrahedron with these corners is inverted.
pub fn is_inverted(x: [Vec3; 4]) -> bool {
    // Rounding may make a sliver's volume negative: exact arithmetic decides.
    volume6(x[0], x[1], x[2], x[3]) <= 0.0 && is_positive([x[1], x[0], x[2], x[3]])
}

/// What a component of a field is on a mesh.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Component {
    /// Its integral over the mesh, linear in each tetrahedron.
    pub mass: f64,
    /// Least value at a vertex.
    pub least: f64,
    /// Greatest value at a vertex.
    pub greatest: f64,
}

/// The volume of a mesh, and each component of the rows of `width` values at its vertices. Inverted tetrahedra count for nothing.
///
/// # Panics
/// When the number of values is not `width` a vertex.
pub fn measure(team: Team<'_>, mesh: &TetMesh, width: usize, values: &[f64]) -> (f64, Vec<Component>) {
    assert_eq!(values.len(), width * mesh.vertices.len(), "{width} values a vertex");
    let masses = sums(team, mesh.tets.len(), width + 1, |tet, row| {
        masses_of(mesh.tets.nodes[tet], &mesh.vertices, values, row);
    });
    let rows = |range: Range<usize>| &values[range.start * width..range.end * width];
    let parts = team.chunks(GRAIN, mesh.vertices.len(), |range| bounds_of(width, rows(range)));
    components(masses, parts)
}

/// Writes the integral of each component over a tetrahedron, and its volume, into a row; `vertices` and `values` are of all nodes.
pub fn masses_of(nodes: [u32; 4], vertices: &[Vec3], values: &[f64], row: &mut [f64]) {
    let width = row.len() - 1;
    let volume = volume_of(nodes.map(|v| vertices[v as usize]));
    let nodes = nodes.map(|v| v as usize * width);
    for (c, term) in row[..width].iter_mut().enumerate() {
        let [a, b, c, d] = nodes.map(|node| values[node + c]);
        *term = 0.25 * volume * ((a + b) + (c + d));
    }
    row[width] = volume;
}

const NOTHING: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

/// Least and greatest value of each component of some rows.
pub fn bounds_of(width: usize, rows: &[f64]) -> Vec<[f64; 2]> {
    let mut bounds = vec![NOTHING; width];
    for row in rows.chunks_exact(width.max(1)) {
        bounds.iter_mut().zip(row).for_each(|(b, &x)| *b = [b[0].min(x), b[1].max(x)]);
    }
    bounds
}

/// The volume and the components, of the integrals with the volume behind them and the bounds of all parts.
pub fn components(mut masses: Vec<f64>, parts: Vec<Vec<[f64; 2]>>) -> (f64, Vec<Component>) {
    let volume = masses.pop().unwrap_or(0.0);
    let component = |(c, mass): (usize, f64)| {
        let [least, greatest] = parts.iter().fold(NOTHING, |b, part| [b[0].min(part[c][0]), b[1].max(part[c][1])]);
        Component { mass, least, greatest }
    };
    (volume, masses.into_iter().enumerate().map(component).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::samples::cube;

    #[test]
    fn nothing_is_lost_in_a_sum() {
        let mut sum = Sum::default();
        [1.0, 1e100, 1.0, -1e100].into_iter().for_each(|term| sum.add(term));
        assert_eq!(sum.value(), 2.0);
        let tenths = sums(Team::alone(), 1_000_000, 1, |_, row| row[0] = 0.1);
        assert!((tenths[0] - 100_000.0).abs() < 1e-10, "{tenths:?}");
    }

    #[test]
    fn integrals_and_bounds() {
        let mesh = cube(3);
        let values: Vec<f64> = mesh.vertices.iter().flat_map(|p| [p[0], 2.0 - 3.0 * p[1] + p[2]]).collect();
        let (volume, found) = measure(Team::alone(), &mesh, 2, &values);
        assert!((volume - 1.0).abs() < 1e-15);
        assert!((found[0].mass - 0.5).abs() < 1e-15 && (found[1].mass - 1.0).abs() < 1e-15, "{found:?}");
        assert_eq!([found[0].least, found[0].greatest, found[1].least, found[1].greatest], [0.0, 1.0, -1.0, 3.0]);
    }

    #[test]
    fn inverted_and_empty_meshes_are_refused() {
        let mut mesh = cube(2);
        assert_eq!(check(Team::alone(), &mesh, Which::Old), Ok(()));
        mesh.tets.nodes[7].swap(0, 1);
        let error = check(Team::alone(), &mesh, Which::New).unwrap_err();
        assert!(error.to_string().contains("tetrahedron 8 of the new mesh is inverted"), "{error}");
        mesh.tets.nodes = vec![[0, 1, 2, 0]];
        assert_eq!(check(Team::alone(), &mesh, Which::New), Err(Error::NoVolume(Which::New)));
    }
}
