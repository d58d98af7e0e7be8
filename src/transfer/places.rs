//! Where points lie in a mesh.
use crate::mesh::locate::{Location, Locator, Searcher, Size};
use crate::mesh::vector::Vec3;
use crate::tasks::{GRAIN, Team};

/// Nearer to the mesh than this share of its size is not outside.
const TOLERANCE: f64 = 1e-9;

/// The places of points in a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Places {
    /// For each point the tetrahedron that holds it, or the nearest one, shape (n,).
    pub tets: Vec<u32>,
    /// Its barycentric coordinates there, shape (n, 4): ≥ 0, sum 1; those of the nearest point of the mesh for one that is outside.
    pub weights: Vec<[f64; 4]>,
    /// Points outside the mesh: farther from it than 1e-9 of its size.
    pub outside: usize,
    /// Greatest distance of a point from the mesh, length.
    pub farthest: f64,
}

impl Places {
    /// Of points, those that follow one another best near each other. Each depends on the mesh and the point alone ([`Searcher`]).
    pub fn of(team: Team<'_>, locator: &Locator, points: &[Vec3]) -> Self {
        let size = Size::of_vertices(locator.vertices());
        let tolerance = tolerance(&size);
        let parts = team.chunks(GRAIN / 4, points.len(), |range| {
            let mut searcher = Searcher::new(locator, &size);
            points[range].iter().map(|&p| searcher.locate(p)).collect::<Vec<Location>>()
        });
        let all = || parts.iter().flatten();
        Self {
            outside: all().filter(|place| place.distance > tolerance).count(),
            farthest: all().map(|place| place.distance).fold(0.0, f64::max),
            tets: all().map(|place| place.tet).collect(),
            weights: all().map(|place| place.weights).collect(),
        }
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.tets.len()
    }

    /// Whether there is no point.
    pub fn is_empty(&self) -> bool {
        self.tets.is_empty()
    }
}

/// A point that is farther than this from a mesh is outside, length.
pub fn tolerance(size: &Size) -> f64 {
    TOLERANCE * size.diagonal
}
