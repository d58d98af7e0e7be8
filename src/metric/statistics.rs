//! The figures of a mesh in a metric: edge lengths, mean ratios, complexity.
use super::quality::edge_length;
use super::{Sym3, field, mean_ratios};
use crate::mesh::adjacency::Edges;
use crate::mesh::vector::{Vec3, distance, sub, volume6};
use crate::mesh::{Elements, TetMesh};
use crate::tasks::{GRAIN, Team};
use serde::Serialize;
use std::collections::BTreeMap;
use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};
use std::ops::Range;

mod words;

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
#[derive(Clone, Debug)]
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
#[derive(Default, Clone, Debug, PartialEq, Serialize)]
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
        Figures::in_metric(team, Part::whole(mesh), metrics, |_| true).statistics()
    }

    /// Of a mesh alone: lengths and mean ratios in space.
    pub fn in_space(team: Team<'_>, mesh: &TetMesh) -> Self {
        Figures::in_space(team, Part::whole(mesh), |_| true).statistics()
    }
}

/// A part of a mesh: what is counted with it. Nodes are indices into its own vertices.
#[derive(Clone, Copy, Debug)]
pub struct Part<'m> {
    /// Coordinates of all vertices of its elements, shape (n, 3), model units.
    pub vertices: &'m [Vec3],
    /// How many of them are counted here, and in no other part.
    pub own_vertices: usize,
    /// Its tetrahedra, in no other part.
    pub tets: &'m Elements<4>,
    /// Its triangles, in no other part.
    pub triangles: &'m Elements<3>,
    /// Its tagged edges, in no other part.
    pub edges: &'m Elements<2>,
}

impl<'m> Part<'m> {
    /// All of a mesh.
    pub fn whole(mesh: &'m TetMesh) -> Self {
        Self {
            vertices: &mesh.vertices,
            own_vertices: mesh.vertices.len(),
            tets: &mesh.tets,
            triangles: &mesh.triangles,
            edges: &mesh.edges,
        }
    }
}

/// The lengths of edges that come one by one.
#[derive(Clone, Debug)]
pub struct Lengths(Accumulator<'static>);

impl Lengths {
    /// Of no edge yet; to be measured in the metric ([`edge_length`]).
    pub fn in_metric() -> Self {
        Self(Accumulator::new(&LENGTH_CLASSES, false))
    }

    /// Of no edge yet; to be measured in space.
    pub fn in_space() -> Self {
        Self(Accumulator::new(&[], false))
    }

    /// Takes in an edge of this length.
    pub fn add(&mut self, length: f64) {
        self.0.add(length);
    }

    /// These and then others, measured in the same way.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self(self.0.and(other.0))
    }
}

/// The figures of some parts of a mesh, from which [`Statistics`] follow when all are there.
///
/// Sums are rounded in the order in which the parts are joined, so join them in an order of their own, not in that in which they are
/// done: `all.into_iter().reduce(Figures::and)` of a list of them.
#[derive(Clone, Debug)]
pub struct Figures {
    /// Those that only add up; the others are empty.
    sums: Statistics,
    lengths: Lengths,
    ratios: Accumulator<'static>,
    complexity: Option<f64>,
}

impl Figures {
    /// Of a part with a metric at every vertex, shape (n,). Of its tetrahedra's edges, pairs of nodes in ascending order, it has those that it
    /// `counts`: for an edge that several parts have, that must be true in one of them.
    pub fn in_metric(
        team: Team<'_>,
        part: Part<'_>,
        metrics: &[Sym3],
        counts: impl Fn([u32; 2]) -> bool + Sync,
    ) -> Self {
        let length = |[a, b]: [u32; 2]| {
            let v = sub(part.vertices[b as usize], part.vertices[a as usize]);
            edge_length(v, &metrics[a as usize], &metrics[b as usize])
        };
        let lengths = lengths(team, &part.tets.nodes, counts, length, Lengths::in_metric());
        Self::without_edges_in_metric(team, part, metrics).with(lengths)
    }

    /// Of a part alone: lengths and mean ratios in space. Edges as in [`Figures::in_metric`].
    pub fn in_space(team: Team<'_>, part: Part<'_>, counts: impl Fn([u32; 2]) -> bool + Sync) -> Self {
        let length = |[a, b]: [u32; 2]| distance(part.vertices[a as usize], part.vertices[b as usize]);
        let lengths = lengths(team, &part.tets.nodes, counts, length, Lengths::in_space());
        Self::without_edges_in_space(team, part).with(lengths)
    }

    /// As [`Figures::in_metric`], without the edges of the tetrahedra: their lengths come otherwise ([`Figures::with`]).
    pub fn without_edges_in_metric(team: Team<'_>, part: Part<'_>, metrics: &[Sym3]) -> Self {
        let logs = team.map(GRAIN, metrics.len(), |v| metrics[v].ln());
        let mut figures = Self::of(team, part, Lengths::in_metric(), |v| logs[v as usize]);
        figures.complexity = Some(field::complexity_of_tets(team, part.vertices, &part.tets.nodes, &logs));
        figures
    }

    /// As [`Figures::in_space`], without the edges.
    pub fn without_edges_in_space(team: Team<'_>, part: Part<'_>) -> Self {
        Self::of(team, part, Lengths::in_space(), |_| Sym3::ZERO)
    }

    /// With the lengths of further edges, measured in the same way.
    #[must_use]
    pub fn with(mut self, lengths: Lengths) -> Self {
        self.lengths = self.lengths.and(lengths);
        self
    }

    fn of(team: Team<'_>, part: Part<'_>, lengths: Lengths, log: impl Fn(u32) -> Sym3 + Sync) -> Self {
        let points = |tet: &[u32; 4]| tet.map(|v| part.vertices[v as usize]);
        let tets = &part.tets.nodes;
        let ratios = gathered(team, tets.len(), Accumulator::new(&RATIO_CLASSES, true), |range, ratios| {
            mean_ratios(tets[range].iter(), |tet| (points(tet), tet.map(&log)), |_, ratio| ratios.add(ratio));
        });
        let volume = |tet: &[u32; 4]| {
            let [a, b, c, d] = points(tet);
            volume6(a, b, c, d) / 6.0
        };
        let sums = Statistics {
            vertices: part.own_vertices,
            tets: tets.len(),
            triangles: part.triangles.len(),
            tagged_edges: part.edges.len(),
            volume: team.sum(GRAIN, tets.len(), |range| tets[range].iter().map(volume).sum()),
            regions: by_reference(team, part.tets),
            patches: by_reference(team, part.triangles),
            curves: by_reference(team, part.edges),
            edge_lengths: Distribution::default(),
            mean_ratios: Distribution::default(),
            metric: None,
        };
        Self { sums, lengths, ratios, complexity: None }
    }

    /// Joins the figures of other parts to these. Either all are in the metric or none is.
    #[must_use]
    pub fn and(mut self, other: Self) -> Self {
        let (sums, others) = (&mut self.sums, other.sums);
        sums.vertices += others.vertices;
        sums.tets += others.tets;
        sums.triangles += others.triangles;
        sums.tagged_edges += others.tagged_edges;
        sums.volume += others.volume;
        add_counts(&mut sums.regions, others.regions);
        add_counts(&mut sums.patches, others.patches);
        add_counts(&mut sums.curves, others.curves);
        self.lengths = self.lengths.and(other.lengths);
        self.ratios = self.ratios.and(other.ratios);
        self.complexity = self.complexity.zip(other.complexity).map(|(a, b)| a + b);
        self
    }

    /// Adds edges of these lengths, say of those that several parts have.
    #[must_use]
    pub fn with_lengths(mut self, lengths: impl IntoIterator<Item = f64>) -> Self {
        lengths.into_iter().for_each(|length| self.lengths.add(length));
        self
    }

    /// The statistics of what has been joined. Places of least values ([`Distribution::argmin`]) count through the parts, one after the other.
    pub fn statistics(self) -> Statistics {
        let Self { sums, lengths, ratios, complexity } = self;
        let (edge_lengths, mean_ratios) = (lengths.0.distribution(), ratios.distribution());
        let is_unit = |class: &&Class| class.low == Some(FRAC_1_SQRT_2) || class.high == Some(SQRT_2);
        let unit: usize = edge_lengths.classes.iter().filter(is_unit).map(|class| class.count).sum();
        let metric = complexity.map(|complexity| MetricFigures {
            complexity,
            vertices_per_complexity: sums.vertices as f64 / complexity,
            unit_edges: unit as f64 / edge_lengths.count.max(1) as f64,
        });
        Statistics { edge_lengths, mean_ratios, metric, ..sums }
    }
}

/// The lengths of the edges of tetrahedra that are counted, each once; `none` are those of no edge.
fn lengths(
    team: Team<'_>,
    tets: &[[u32; 4]],
    counts: impl Fn([u32; 2]) -> bool + Sync,
    length: impl Fn([u32; 2]) -> f64 + Sync,
    Lengths(none): Lengths,
) -> Lengths {
    let edges = Edges::of(team, tets);
    Lengths(gathered(team, edges.nodes(), none, |range, lengths| {
        edges.for_each(range, |edge| {
            if counts(edge) {
                lengths.add(length(edge));
            }
        });
    }))
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
    parts.into_iter().for_each(|part| add_counts(&mut counts, part));
    counts
}

/// Adds the counts of other elements.
fn add_counts(counts: &mut BTreeMap<i32, usize>, others: BTreeMap<i32, usize>) {
    others.into_iter().for_each(|(reference, count)| *counts.entry(reference).or_insert(0) += count);
}

#[cfg(test)]
mod tests;
