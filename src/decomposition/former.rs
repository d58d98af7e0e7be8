//! How good the mesh is where cuts were in the last round of growth and after, beside the rest.
use super::cuts::Tree;
use super::piece::{Piece, SHARED};
use super::rounds::Rounds;
use super::shelf::Key;
use super::split::split_tets;
use crate::mesh::Elements;
use crate::mesh::vector::Vec3;
use crate::metric::Sym3;
use crate::metric::statistics::{Figures, Part, Statistics};
use crate::tasks::Team;

/// Where some of the mesh lies. The greatest counts where pieces differ about an edge that they share.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Where {
    /// Finished in the last round of growth: four rings of tetrahedra and more from each cut.
    Untouched = 0,
    /// Adapted again after that round, for a cut was near.
    Around = 1,
    /// Of that, what lies within one unit length of a cut.
    AtCut = 2,
}

impl Where {
    /// Of this number.
    pub fn of_number(number: u64) -> Option<Self> {
        [Self::Untouched, Self::Around, Self::AtCut].into_iter().find(|place| *place as u64 == number)
    }
}

/// How good some of the mesh is, in its metric.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Quality {
    /// Tetrahedra.
    pub tets: usize,
    /// Their mean mean ratio.
    pub mean_ratio: f64,
    /// The least of their mean ratios.
    pub least_ratio: f64,
    /// Edges.
    pub edges: usize,
    /// Share of the edges with a length in [1/√2, √2].
    pub unit_edges: f64,
}

impl Quality {
    fn of(statistics: &Statistics) -> Self {
        Self {
            tets: statistics.tets,
            mean_ratio: statistics.mean_ratios.mean,
            least_ratio: statistics.mean_ratios.min,
            edges: statistics.edge_lengths.count,
            unit_edges: statistics.metric.as_ref().map_or(0.0, |metric| metric.unit_edges),
        }
    }
}

/// How good a mesh is near former cuts and far from them; none of what is not there.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct NearCuts {
    /// What was finished in the last round of growth.
    pub untouched: Option<Quality>,
    /// What was adapted again, around cuts.
    pub around: Option<Quality>,
    /// Of that, tetrahedra with their centroid within one unit length of a cut, and edges with their middle there.
    pub at_cuts: Option<Quality>,
}

impl NearCuts {
    /// From the figures of each, in the order of [`Where`].
    pub fn of(figures: [Option<Figures>; 3]) -> Self {
        let quality = |figures: Figures| Some(Quality::of(&figures.statistics())).filter(|quality| quality.tets > 0);
        let [untouched, around, at_cuts] = figures.map(|figures| figures.and_then(quality));
        Self { untouched, around, at_cuts }
    }
}

/// The cuts that a piece has felt.
#[derive(Clone, Copy, Default)]
pub struct Felt<'a>(&'a [(u32, Tree)]);

impl<'a> Felt<'a> {
    /// Of the cuts of some rounds.
    pub fn of(cuts: &'a [(u32, Tree)]) -> Self {
        Self(cuts)
    }

    /// Where the piece lies.
    pub fn place(&self) -> Where {
        if self.0.is_empty() { Where::Untouched } else { Where::Around }
    }

    /// Whether a point is no farther from a cut than this along each axis.
    fn is_near(&self, at: Vec3, reach: Vec3) -> bool {
        self.0.iter().any(|(_, tree)| tree.is_near(at, reach))
    }
}

impl Rounds<'_> {
    /// The cuts that the finished piece at this place has felt.
    pub fn felt(&self, at: usize) -> Felt<'_> {
        // What a round finishes is far from the cuts of that round.
        let end = match self.finished[at].0 {
            Key::Active { round, .. } => round + 1,
            Key::Finished { round, .. } => round,
            Key::Share { .. } | Key::Ground { .. } | Key::Around { .. } => 0,
        };
        Felt(&self.former[..self.former.partition_point(|(round, _)| *round < end)])
    }
}

/// Which points of a piece are at a cut.
pub struct AtCut<'a> {
    felt: Felt<'a>,
    vertices: &'a [Vec3],
    /// How far a unit length reaches along each axis, by the metric at each vertex; empty where no cut was felt.
    reach: Vec<Vec3>,
}

impl<'a> AtCut<'a> {
    /// Of vertices with M.
    pub fn of(felt: Felt<'a>, vertices: &'a [Vec3], metrics: &[Sym3]) -> Self {
        // The unit ball of M reaches as far as the root of the diagonal of its inverse.
        let reach = |metric: &Sym3| {
            let inverse = metric.inverse();
            [0, 1, 2].map(|k| inverse.at(k, k).sqrt())
        };
        let metrics = if felt.place() == Where::Untouched { &[] } else { metrics };
        Self { felt, vertices, reach: metrics.iter().map(reach).collect() }
    }

    /// Whether the middle of these vertices is.
    pub fn is_near<const N: usize>(&self, nodes: [u32; N]) -> bool {
        let mean = |of: &[Vec3]| [0, 1, 2].map(|k| nodes.iter().map(|&v| of[v as usize][k]).sum::<f64>() / N as f64);
        !self.reach.is_empty() && self.felt.is_near(mean(self.vertices), mean(&self.reach))
    }

    /// Where the middle of an edge lies.
    pub fn place(&self, nodes: [u32; 2]) -> Where {
        if self.is_near(nodes) { Where::AtCut } else { self.felt.place() }
    }
}

/// The figures of what is at a cut, of edges those that no other piece can have; none where nothing is.
pub fn figures_at_cuts(piece: &Piece, felt: Felt<'_>, metrics: &[Sym3]) -> Option<Figures> {
    let near = AtCut::of(felt, &piece.mesh.vertices, metrics);
    let tets = (0..).zip(&piece.mesh.tets.nodes).filter(|(_, nodes)| near.is_near(**nodes));
    let tets: Vec<u32> = tets.map(|(t, _)| t).collect();
    if tets.is_empty() {
        return None;
    }
    let Piece { mesh, marks, logs, .. } = split_tets(piece, &tets);
    let metrics: Vec<Sym3> = logs.iter().map(Sym3::exp).collect();
    let near = AtCut::of(felt, &mesh.vertices, &metrics);
    let is_shared = |v: u32| marks[v as usize] & SHARED != 0;
    let counts = |nodes: [u32; 2]| !nodes.into_iter().all(is_shared) && near.is_near(nodes);
    let (none, none_tagged) = (Elements::default(), Elements::default());
    let part =
        Part { vertices: &mesh.vertices, own_vertices: 0, tets: &mesh.tets, triangles: &none, edges: &none_tagged };
    Some(Figures::in_metric(Team::alone(), part, &metrics, counts))
}
