//! What the user bounds of the surface: triangles that stray too far from the model are split, and nothing makes new ones.
use super::access::Access;
use super::ids::{FACE, TetId, VertexId};
use super::insert::EdgeItem;
use super::outcome::Refusal;
use super::surface::Look;
use super::worker::Worker;
use crate::geometry::Entity;
use crate::mesh::vector::{distance, lerp};

/// Bounds of how far surface triangles may stray from the model. Without them only what is there is kept from becoming worse than the
/// defaults of the kernel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SurfaceBounds {
    /// Greatest angle in degrees between a triangle's normal and the model's at the point closest to its centroid, and half the greatest
    /// angle between the model's normals at its vertices.
    pub normal_deviation: Option<f64>,
    /// Greatest distance from the model of a triangle's centroid and of the middles of its edges: the chord error, in model units.
    pub hausdorff: Option<f64>,
}

impl SurfaceBounds {
    /// Whether there are any.
    pub fn is_some(&self) -> bool {
        self.normal_deviation.is_some() || self.hausdorff.is_some()
    }

    /// Least cosine of the angle, of those of the kernel and of the user.
    pub fn cosine(&self, default: f64) -> f64 {
        self.normal_deviation.map_or(default, |degrees| degrees.to_radians().cos().max(default))
    }

    /// Greatest chord error.
    pub fn chord(&self) -> f64 {
        self.hausdorff.unwrap_or(f64::INFINITY)
    }
}

impl<A: Access> Worker<'_, '_, A> {
    /// Whether a triangle strays farther from the model than it may.
    fn strays(&self, look: Look) -> bool {
        let limits = self.context.limits;
        look.tilt.abs() < limits.tilt || look.spread < limits.spread || look.chord > limits.chord
    }

    /// Distance from the model of the middle of an edge of a triangle on a face: of an edge on the model's edge from that one.
    pub fn chord_of(&mut self, [a, b]: [VertexId; 2], face: u32) -> f64 {
        let middle = lerp(self.store.position(a), self.store.position(b), 0.5);
        let entity = self.store.ridge_curve(a, b).map_or(Entity::Face(face), Entity::Edge);
        if entity == Entity::Face(face) && self.context.planes[face as usize].is_some() {
            return 0.0;
        }
        distance(middle, self.place(entity, middle, &[a, b]).point)
    }

    /// Splits the edge that is farthest from the model of a tetrahedron's surface triangle that strays, the worst of them.
    pub fn unbend(&mut self, t: TetId) -> Result<(), Refusal> {
        let vertices = self.claim_moving_tet(t)?;
        let tags = self.store.tags(t);
        let mut farthest: Option<(f64, [VertexId; 2])> = None;
        for i in (0..4).filter(|&i| tags[i] != 0) {
            let face = FACE[i].map(|k| vertices[k]);
            let look = self.look(face, tags[i] - 1);
            if !self.strays(look) {
                continue;
            }
            for edge in [[face[0], face[1]], [face[1], face[2]], [face[2], face[0]]] {
                let chord = self.chord_of(edge, tags[i] - 1);
                if chord > 0.0 && farthest.is_none_or(|(known, _)| chord > known) {
                    farthest = Some((chord, edge));
                }
            }
        }
        let (_, [a, b]) = farthest.ok_or(Refusal::Stale)?;
        self.split_edge(EdgeItem { a: a.min(b), b: a.max(b), tet: t })
    }

    /// Surface triangles of a tetrahedron that stray; those of an interface are counted on the side of the lesser tetrahedron.
    pub fn count_strays(&mut self, t: TetId) -> usize {
        let (vertices, tags) = (self.store.vertices(t), self.store.tags(t));
        let mut count = 0;
        for i in (0..4).filter(|&i| tags[i] != 0) {
            let behind = self.store.neighbour(t, i);
            if !behind.is_some() || t < behind {
                let look = self.look(FACE[i].map(|k| vertices[k]), tags[i] - 1);
                count += usize::from(self.strays(look));
            }
        }
        count
    }
}
