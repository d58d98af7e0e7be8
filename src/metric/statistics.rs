//! The figures of a mesh in a metric: edge lengths, mean ratios, complexity.
use super::quality::edge_length;
use super::{Sym3, field, mean_ratios};
use crate::mesh::adjacency::Edges;
use crate::mesh::vector::{distance, sub, volume6};
use crate::mesh::{Elements, TetMesh};
use crate::tasks::{GRAIN, Team};
use serde::Serialize;
use std::collections::BTreeMap;
use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};
use std::ops::Range;

/// Bounds of the classes of edge lengths in the metric; the last class is open.
pub const LENGTH_CLASSES: [f64; 11] = [0.0, 0.1, 0.25, 0.5, FRAC_1_SQRT_2, 1.0, SQRT_2, 2.0, 4.0, 10.0, f64::INFINITY];

/// Bounds of the classes of mean ratios; the first class is for inverted and flat tetrahedra.
pub const RATIO_CLASSES: [f64; 13] =
    [f64::NEG_INFINITY, 0.0, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, f64::INFINITY];

/// A class of a histogram: values in (low, high], of lengths in [low, high).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Class {
    /// Lower bound; none when open.
    pub low: Option<f64>,
    /// Upper bound; none when open.
    pub high: Option<f64>,
    /// Values in it.
    pub count: usize,
}

/// Least, greatest, mean and histogram of values.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Distribution {
    /// Number of values.
    pub count: usize,
    /// Least value; 0 without values.
    pub min: f64,
    /// Arithmetic mean; 0 without values.
    pub mean: f64,
    /// Greatest value; 0 without values.
    pub max: f64,
    /// Index of the least value (a tetrahedron, from 0; for edges an index into the sorted unique edges).
    #[serde(skip)]
    pub argmin: usize,
    /// The histogram; empty when no classes make sense (lengths without a metric).
    pub classes: Vec<Class>,
}

impl Distribution {
    /// Of values, with the bounds of the classes (ascending). A value equal to a bound belongs to the class above, but
    /// with `closed_above` to the class below.
    pub fn of(values: &[f64], bounds: &[f64], closed_above: bool) -> Self {
        let mut gathering = Accumulator::new(bounds, closed_above);
        values.iter().for_each(|&value| gathering.add(value));
        gathering.distribution()
    }
}

/// A [`Distribution`] of values that come one by one.
#[derive(Clone)]
struct Accumulator<'b> {
    bounds: &'b [f64],
    closed_above: bool,
    sum: f64,
    found: Distribution,
}

impl<'b> Accumulator<'b> {
    /// Of no value yet.
    fn new(bounds: &'b [f64], closed_above: bool) -> Self {
        let finite = |x: f64| x.is_finite().then_some(x);
        let classes = bounds.windows(2).map(|b| Class { low: finite(b[0]), high: finite(b[1]), count: 0 }).collect();
        let found = Distribution { min: f64::INFINITY, max: f64::NEG_INFINITY, classes, ..Distribution::default() };
        Self { bounds, closed_above, sum: 0.0, found }
    }

    fn add(&mut self, value: f64) {
        let found = &mut self.found;
        if value < found.min {
            (found.min, found.argmin) = (value, found.count);
        }
        found.max = found.max.max(value);
        found.count += 1;
        self.sum += value;
        // All bounds are compared: there is no branch to foresee.
        let is_below = |&b: &f64| (b < value) | (!self.closed_above & (b == value));
        let above = self.bounds.iter().map(|b| usize::from(is_below(b))).sum::<usize>();
        if !found.classes.is_empty() {
            let class = above.clamp(1, found.classes.len()) - 1;
            found.classes[class].count += 1;
        }
    }

    /// Joins what this one and then the other have gathered.
    fn and(mut self, other: Self) -> Self {
        if other.found.min < self.found.min {
            (self.found.min, self.found.argmin) = (other.found.min, self.found.count + other.found.argmin);
        }
        self.found.max = self.found.max.max(other.found.max);
        self.found.count += other.found.count;
        self.sum += other.sum;
        self.found.classes.iter_mut().zip(&other.found.classes).for_each(|(all, class)| all.count += class.count);
        self
    }

    fn distribution(mut self) -> Distribution {
        if self.found.count == 0 {
            return Distribution { classes: self.found.classes, ..Distribution::default() };
        }
        self.found.mean = self.sum / self.found.count as f64;
        self.found
    }
}

/// What is measured in a metric only.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MetricFigures {
    /// Complexity C; a unit mesh has about 2C vertices and 12C tetrahedra.
    pub complexity: f64,
    /// Vertices over the complexity.
    pub vertices_per_complexity: f64,
    /// Share of the edges with a length in [1/√2, √2].
    pub unit_edges: f64,
}

/// The figures of a mesh.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Statistics {
    /// Number of vertices.
    pub vertices: usize,
    /// Number of tetrahedra.
    pub tets: usize,
    /// Number of triangles.
    pub triangles: usize,
    /// Number of tagged edges.
    pub tagged_edges: usize,
    /// Volume, model units³.
    pub volume: f64,
    /// Tetrahedra of each region.
    pub regions: BTreeMap<i32, usize>,
    /// Triangles of each reference.
    pub patches: BTreeMap<i32, usize>,
    /// Tagged edges of each reference.
    pub curves: BTreeMap<i32, usize>,
    /// Lengths of all edges (each once), in the metric, else in model units.
    pub edge_lengths: Distribution,
    /// Mean ratios of the tetrahedra, in the metric, else in space. Inverted and flat ones count as 0.
    pub mean_ratios: Distribution,
    /// Complexity and unit edges, when there is a metric.
    pub metric: Option<MetricFigures>,
}

impl Statistics {
    /// Of a mesh with a metric at every vertex.
    pub fn in_metric(team: Team<'_>, mesh: &TetMesh, metrics: &[Sym3]) -> Self {
        let logs = team.map(GRAIN, metrics.len(), |v| metrics[v].ln());
        let length = |[a, b]: [u32; 2]| {
            let v = sub(mesh.vertices[b as usize], mesh.vertices[a as usize]);
            edge_length(v, &metrics[a as usize], &metrics[b as usize])
        };
        let mut statistics = Self::of(team, mesh, length, &LENGTH_CLASSES, |v| logs[v as usize]);
        let classes = &statistics.edge_lengths.classes;
        let unit: usize = classes
            .iter()
            .filter(|class| class.low == Some(FRAC_1_SQRT_2) || class.high == Some(SQRT_2))
            .map(|class| class.count)
            .sum();
        let complexity = field::complexity_of_logs(team, mesh, &logs);
        statistics.metric = Some(MetricFigures {
            complexity,
            vertices_per_complexity: mesh.vertices.len() as f64 / complexity,
            unit_edges: unit as f64 / statistics.edge_lengths.count.max(1) as f64,
        });
        statistics
    }

    /// Of a mesh alone: lengths and mean ratios in space.
    pub fn in_space(team: Team<'_>, mesh: &TetMesh) -> Self {
        let length = |[a, b]: [u32; 2]| distance(mesh.vertices[a as usize], mesh.vertices[b as usize]);
        Self::of(team, mesh, length, &[], |_| Sym3::ZERO)
    }

    fn of(
        team: Team<'_>,
        mesh: &TetMesh,
        length: impl Fn([u32; 2]) -> f64 + Sync,
        length_classes: &[f64],
        log: impl Fn(u32) -> Sym3 + Sync,
    ) -> Self {
        let edges = Edges::of(team, &mesh.tets.nodes);
        let lengths = gathered(team, edges.nodes(), Accumulator::new(length_classes, false), |range, lengths| {
            edges.for_each(range, |edge| lengths.add(length(edge)));
        });
        drop(edges);
        let points = |tet: &[u32; 4]| tet.map(|v| mesh.vertices[v as usize]);
        let tets = &mesh.tets.nodes;
        let ratios = gathered(team, tets.len(), Accumulator::new(&RATIO_CLASSES, true), |range, ratios| {
            mean_ratios(tets[range].iter(), |tet| (points(tet), tet.map(&log)), |_, ratio| ratios.add(ratio));
        });
        let volume = |tet: &[u32; 4]| {
            let [a, b, c, d] = points(tet);
            volume6(a, b, c, d) / 6.0
        };
        Self {
            vertices: mesh.vertices.len(),
            tets: mesh.tets.len(),
            triangles: mesh.triangles.len(),
            tagged_edges: mesh.edges.len(),
            volume: team.sum(GRAIN, tets.len(), |range| tets[range].iter().map(volume).sum()),
            regions: by_reference(team, &mesh.tets),
            patches: by_reference(team, &mesh.triangles),
            curves: by_reference(team, &mesh.edges),
            edge_lengths: lengths.distribution(),
            mean_ratios: ratios.distribution(),
            metric: None,
        }
    }
}

/// What `add` sees of chunks of so many items, one after the other.
fn gathered<'b>(
    team: Team<'_>,
    items: usize,
    nothing: Accumulator<'b>,
    add: impl Fn(Range<usize>, &mut Accumulator<'b>) + Sync,
) -> Accumulator<'b> {
    let parts = team.chunks(GRAIN, items, |range| {
        let mut part = nothing.clone();
        add(range, &mut part);
        part
    });
    parts.into_iter().fold(nothing, Accumulator::and)
}

/// How many elements have each reference.
pub fn by_reference<const N: usize>(team: Team<'_>, elements: &Elements<N>) -> BTreeMap<i32, usize> {
    let parts = team.chunks(GRAIN, elements.len(), |range| {
        let mut counts = BTreeMap::new();
        // Most have that of the one before.
        for same in elements.refs[range].chunk_by(|a, b| a == b) {
            *counts.entry(same[0]).or_insert(0) += same.len();
        }
        counts
    });
    let mut counts = BTreeMap::new();
    parts.into_iter().flatten().for_each(|(reference, count)| *counts.entry(reference).or_insert(0) += count);
    counts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::samples::cube;

    #[test]
    fn classes_and_bounds() {
        let d = Distribution::of(&[0.5, 1.0, 1.5, -2.0, 9.0], &[0.0, 1.0, 2.0, f64::INFINITY], false);
        // −2 counts in the first class.
        assert_eq!(d.classes.iter().map(|class| class.count).collect::<Vec<_>>(), [2, 2, 1]);
        assert_eq!((d.count, d.min, d.max, d.mean, d.argmin), (5, -2.0, 9.0, 2.0, 3));
        assert_eq!((d.classes[2].low, d.classes[2].high), (Some(2.0), None));
        let d = Distribution::of(&[0.5, 1.0, 1.5], &[0.0, 1.0, 2.0], true);
        assert_eq!(d.classes.iter().map(|class| class.count).collect::<Vec<_>>(), [2, 1]);
        assert_eq!(Distribution::of(&[], &[0.0, 1.0], true).count, 0);
    }

    #[test]
    fn figures_of_a_cube() {
        let n = 4;
        let mesh = cube(n);
        // Sizes 1/n: edges of length 1, √2 (face diagonals; in the class above by rounding or not) and √3.
        let metrics = vec![Sym3::IDENTITY.times(f64::from(n * n) * 0.99); mesh.vertices.len()];
        let statistics = Statistics::in_metric(Team::alone(), &mesh, &metrics);
        let figures = statistics.metric.clone().unwrap();
        assert!((figures.complexity - (f64::from(n) * 0.99f64.sqrt()).powi(3)).abs() < 1e-9);
        assert!((figures.vertices_per_complexity * figures.complexity - 125.0).abs() < 1e-9);
        let (axis, face, body) = (3 * 4 * 25, 3 * 16 * 5, 64);
        let share = f64::from(axis + face) / f64::from(axis + face + body);
        assert!((figures.unit_edges - share).abs() < 1e-12, "{figures:?}");
        assert!((statistics.volume - 1.0).abs() < 1e-12);
        assert_eq!(statistics.patches, (1..=6).map(|side| (side, 32)).collect());
        assert_eq!((statistics.regions[&1], statistics.tets), (384, 384));
        // All tetrahedra are alike.
        let ratios = &statistics.mean_ratios;
        assert!((ratios.min - ratios.max).abs() < 1e-12 && (ratios.min - ratios.mean).abs() < 1e-12);
        let alone = Statistics::in_space(Team::alone(), &mesh);
        assert!((alone.mean_ratios.mean - ratios.mean).abs() < 1e-12 && alone.metric.is_none());
        assert!((alone.edge_lengths.min - 0.25).abs() < 1e-15 && alone.edge_lengths.classes.is_empty());
    }
}
