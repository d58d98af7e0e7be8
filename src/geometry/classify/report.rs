//! What a classification found.
use super::Classification;
use crate::geometry::Entity;
use crate::mesh::numbers::from_one;
use crate::mesh::vector::Vec3;
use serde::Serialize;

/// How many of the farthest vertices a report names.
const WORST: usize = 5;

/// Vertices of one dimension.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Dimension {
    /// Number of mesh vertices classified on entities of this dimension.
    pub count: usize,
    /// How many of them the file's own association or references put there, too; the rest is from geometry alone.
    pub from_file: usize,
    /// Greatest distance from the entity, model units.
    pub greatest: f64,
    /// Mean distance.
    pub mean: f64,
}

/// A vertex and its distance from its entity.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Offset {
    /// Mesh vertex, from 0; in JSON from 1.
    #[serde(serialize_with = "from_one")]
    pub vertex: u32,
    /// Its entity.
    pub entity: Entity,
    /// Where it is.
    pub point: Vec3,
    /// Its distance from the entity, model units.
    pub distance: f64,
}

/// What a classification found.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Report {
    /// Vertices on vertices, edges and faces of the model.
    pub dimensions: [Dimension; 3],
    /// Number of mesh edges on model edges.
    pub ridges: usize,
    /// Number of triangles.
    pub triangles: usize,
    /// Triangles whose reference is the number of their face.
    pub faces_from_file: usize,
    /// The farthest vertices, farthest first.
    pub worst: Vec<Offset>,
    /// The default tolerance that was used, model units; entities of a greater tolerance have twice their own.
    pub tolerance: f64,
    /// What the user should know: one line each.
    pub notices: Vec<String>,
}

impl Report {
    /// Collects the figures; `distances` are those of the vertices from their entities.
    pub(super) fn new(
        result: &Classification,
        points: &[Vec3],
        distances: &[f64],
        from_file: impl Fn(usize) -> bool,
    ) -> Self {
        let mut report = Self { ridges: result.ridges.len(), triangles: result.faces.len(), ..Self::default() };
        let mut worst = Vec::new();
        for (v, &entity) in result.entities.iter().enumerate() {
            if entity == Entity::Interior {
                continue;
            }
            let dimension = &mut report.dimensions[entity.dimension() as usize];
            dimension.count += 1;
            dimension.from_file += usize::from(from_file(v));
            dimension.greatest = dimension.greatest.max(distances[v]);
            dimension.mean += distances[v];
            worst.push(Offset { vertex: v as u32, entity, point: points[v], distance: distances[v] });
        }
        for dimension in &mut report.dimensions {
            dimension.mean /= dimension.count.max(1) as f64;
        }
        let farther = |a: &Offset, b: &Offset| b.distance.total_cmp(&a.distance).then(a.vertex.cmp(&b.vertex));
        if worst.len() > WORST {
            worst.select_nth_unstable_by(WORST, farther);
            worst.truncate(WORST);
        }
        worst.sort_by(farther);
        report.worst = worst;
        report
    }
}
