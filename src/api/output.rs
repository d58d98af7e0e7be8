//! What comes out.
use super::MeshView;
use crate::adapt::{Adapted, Extracted, GrowthEnd};
use crate::geometry::Model;
use crate::geometry::classify::Classification;
#[cfg(feature = "occt")]
use crate::geometry::classify::associate;
use crate::mesh::TetMesh;
use crate::mesh::crossing::Crossings;
use crate::metric::Background;
use crate::sizing::chords::Limited;
use crate::tasks::Team;
use crate::transfer::Places;

/// An adapted mesh, with all that the next call and the caller's own fields need.
#[derive(Clone, Debug)]
pub struct AdaptedMesh {
    /// The mesh: vertices, tetrahedra, triangles and edges with their references, those of the input; on a CAD model with its association.
    pub mesh: TetMesh,
    /// The metric at its vertices, shape (n, 6): 11 12 22 13 23 33.
    pub metric: Vec<[f64; 6]>,
    /// Where each vertex was in the mesh that went in.
    pub parents: Parents,
    /// For each vertex its entity of the model with its parameters there, for each triangle its face; indices count from 0.
    pub place: Classification,
    /// Boundary vertices that found no room on the model.
    pub off_model: Vec<u32>,
    /// Boundary vertices that had to stay, being required or frozen: they are as far from the model as they were.
    pub held: Vec<u32>,
    /// Vertices of the mesh that went in, in which alone its parts hung together there: each part got one of its own. One that was
    /// shared by three parts is listed twice.
    pub doubled: Vec<u32>,
    /// Why the mesh stopped growing before its metric was met; none where it was met.
    pub growth_end: Option<GrowthEnd>,
    /// Surface triangles beyond the bounds of the surface that were set.
    pub deviating: usize,
    /// What was cut of sizes along curved walls that are longer than straight edges can have; none where all were left.
    pub chords: Option<Limited>,
    /// Where the boundary passes through itself: triangles of `mesh`, with the first few.
    pub crossings: Crossings,
}

/// For each new vertex a place in the old mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Parents {
    /// The old tetrahedron that holds it, or the nearest one, shape (n,).
    pub tets: Vec<u32>,
    /// Its barycentric coordinates there, shape (n, 4): ≥ 0, sum 1; of a vertex outside the old mesh (on a curved boundary) those of the
    /// nearest point of it.
    pub weights: Vec<[f64; 4]>,
    /// Vertices outside the old mesh.
    pub outside: usize,
    /// Greatest distance of one from it, length.
    pub farthest: f64,
}

impl Parents {
    /// Values at the new vertices, linear in the old tetrahedra `tets`, from those at the old vertices: rows of `width` a vertex.
    ///
    /// # Panics
    /// When these are not the tetrahedra and values of the mesh that went in.
    pub fn interpolate(&self, tets: &[[u32; 4]], width: usize, values: &[f64]) -> Vec<f64> {
        let mut all = Vec::with_capacity(width * self.tets.len());
        for (&tet, weights) in self.tets.iter().zip(&self.weights) {
            let nodes = tets[tet as usize].map(|v| v as usize * width);
            all.extend(
                (0..width).map(|c| nodes.iter().zip(weights).map(|(node, w)| w * values[node + c]).sum::<f64>()),
            );
        }
        all
    }
}

impl AdaptedMesh {
    /// The mesh with its place, to go in again.
    pub fn view(&self) -> MeshView<'_> {
        MeshView { place: Some(&self.place), ..MeshView::of(&self.mesh) }
    }

    /// Of what the kernel gives; `old` is the mesh that went in, taken apart at `doubled`.
    pub(super) fn of(
        team: Team<'_>,
        adapted: Adapted,
        model: &Model,
        (old, chords): (&Background, Option<Limited>),
        doubled: Vec<u32>,
    ) -> Self {
        let Extracted { mut mesh, classification, metrics, off_model, held, crossings, .. } = adapted.extracted;
        match model {
            Model::Discrete(surface) => surface.restore(&mut mesh, &classification),
            #[cfg(feature = "occt")]
            Model::Occt(_) => {
                associate(&mut mesh, &classification);
            }
        }
        let Places { tets, weights, outside, farthest } = Places::of(team, old.locator(), &mesh.vertices);
        Self {
            metric: metrics.iter().map(|metric| metric.0).collect(),
            parents: Parents { tets, weights, outside, farthest },
            place: classification,
            mesh,
            off_model,
            held,
            doubled,
            growth_end: adapted.growth_end,
            deviating: adapted.deviating,
            chords,
            crossings,
        }
    }
}
