//! The feet of all vertices of a mesh on a wall.
use super::foot::Foot;
use super::growth::{Growth, Outside};
use super::search::{Search, VERTICES};
use crate::geometry::classify::Classification;
use crate::geometry::{Geometry, Model};
use crate::mesh::TetMesh;
use crate::tasks::Team;

/// The feet of the vertices of a mesh on the faces of one wall.
pub struct Feet {
    /// Those of vertex v are `feet[starts[v]..starts[v + 1]]`; there is one at least, the nearest first.
    starts: Vec<usize>,
    feet: Vec<Foot>,
}

impl Feet {
    /// On these faces of a model. Beside the nearest those that a metric of layers needs in corners.
    pub fn of(
        team: Team<'_>,
        (mesh, place, model): (&TetMesh, &Classification, &Model),
        faces: &[u32],
        layers: Option<(&Growth, &Outside)>,
    ) -> Self {
        let search = Search::new(mesh, place, model, faces).with_corners();
        let reach = |feet: &[Foot]| {
            let Some((growth, outside)) = layers else { return 0.0 };
            // Farther away another face asks for no less than there is in any direction.
            let size = |foot: &Foot| {
                growth.log(foot, outside, 1.0).map_or(outside.greatest, |log| (-0.5 * log.eigen().values[0]).exp())
            };
            growth.reach(feet.iter().map(size).fold(outside.greatest, f64::min))
        };
        let parts = team.chunks(VERTICES, mesh.vertices.len(), |range| {
            let (mut evaluator, mut feet, mut ends, mut asked) =
                (model.evaluator(), Vec::new(), Vec::new(), Vec::new());
            for v in range {
                search.feet(&mut evaluator, v, reach, (&mut feet, &mut asked));
                ends.push(feet.len());
            }
            (feet, ends)
        });
        let (mut starts, mut feet) = (vec![0], Vec::new());
        for (found, ends) in parts {
            let before = feet.len();
            starts.extend(ends.into_iter().map(|end| before + end));
            feet.extend(found);
        }
        Self { starts, feet }
    }

    /// Those of a vertex, the nearest first.
    pub fn at(&self, vertex: usize) -> &[Foot] {
        &self.feet[self.starts[vertex]..self.starts[vertex + 1]]
    }

    /// How far the nearest is.
    pub fn distance(&self, vertex: usize) -> f64 {
        self.at(vertex).first().map_or(f64::INFINITY, |foot| foot.distance)
    }

    /// How many vertices there are.
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
