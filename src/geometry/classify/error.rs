//! Why a mesh does not fit a model.
use crate::geometry::Entity;
use crate::mesh::vector::Vec3;
use std::fmt;

/// Why a mesh does not fit a model: which, where, how far, and the remedy. Messages count from 1, as files do; fields
/// count from 0. Lengths are in model units.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// There is no surface to classify.
    #[error("the mesh has no boundary triangles; give it triangles on the boundary of its tetrahedra")]
    NoTriangles,
    /// The boxes of mesh and model differ by a factor.
    #[error(
        "the mesh is {factor} times as large as the model (diagonals {mesh:.6} and {model:.6}){units}; multiply the mesh's \
         coordinates by {}, or give the model in the mesh's units", 1.0 / factor
    )]
    Units {
        /// Size of the mesh over size of the model.
        factor: f64,
        /// Diagonal of the mesh's box.
        mesh: f64,
        /// Diagonal of the model's box.
        model: f64,
        /// What the factor means, if it is one of common units.
        units: &'static str,
    },
    /// A vertex is not where its entity is.
    #[error(
        "vertex {} at {} is {distance:.6e} away from {} of the model (tolerance {tolerance:.3e}){}; move it onto the model, \
         or raise the tolerance if the mesh was made on a coarser model", vertex + 1, Place(*point), entity, Others(*others)
    )]
    VertexOff {
        /// The mesh vertex.
        vertex: u32,
        /// Where it is.
        point: Vec3,
        /// The nearest entity, or that of its neighbours.
        entity: Entity,
        /// How far that is.
        distance: f64,
        /// What was allowed.
        tolerance: f64,
        /// How many more vertices are off.
        others: usize,
    },
    /// No face of the model is where a patch is.
    #[error(
        "the patch of {triangles} triangles with reference {reference} around {} lies on no face of the model: the nearest, \
         face {}, is up to {distance:.6e} away (tolerance {tolerance:.3e}); is it another model, or a moved one?",
        Place(*place), face + 1
    )]
    PatchWithoutFace {
        /// Reference of its triangles.
        reference: i32,
        /// Number of its triangles.
        triangles: usize,
        /// Its farthest vertex.
        place: Vec3,
        /// The nearest face.
        face: u32,
        /// How far that vertex is from it.
        distance: f64,
        /// What was allowed.
        tolerance: f64,
    },
    /// A triangle's vertices are on the model, but not on one face.
    #[error(
        "triangle {} (vertices {}, {}, {}) at {} lies on no single face: its vertices are on faces {faces}; \
         the mesh must have edges along the model's edges", triangle + 1, nodes[0] + 1, nodes[1] + 1, nodes[2] + 1, Place(*place)
    )]
    Straddles {
        /// The triangle.
        triangle: usize,
        /// Its vertices.
        nodes: [u32; 3],
        /// Its centroid.
        place: Vec3,
        /// Faces at each vertex, as text, from 1.
        faces: String,
    },
    /// Two faces meet along a mesh edge, but not in the model.
    #[error(
        "the mesh edge between vertices {} and {} at {} lies between triangles of {faces}, but the model has no such edge",
        nodes[0] + 1, nodes[1] + 1, Place(*place)
    )]
    NoEdge {
        /// Its ends.
        nodes: [u32; 2],
        /// Its midpoint.
        place: Vec3,
        /// The faces beside it, as text, from 1.
        faces: String,
    },
    /// No mesh vertex is on a vertex of the model.
    #[error(
        "vertex {} of the model at {} has no mesh vertex: the nearest one{} is {distance:.6e} away (tolerance {tolerance:.3e})",
        vertex + 1, Place(*point), Numbered(*nearest)
    )]
    NoMeshVertex {
        /// The model's vertex.
        vertex: u32,
        /// Where it is.
        point: Vec3,
        /// The nearest mesh vertex that could be it.
        nearest: Option<u32>,
        /// How far that is.
        distance: f64,
        /// What was allowed.
        tolerance: f64,
    },
    /// One mesh vertex for two vertices of the model.
    #[error("vertices {} and {} of the model have the same nearest mesh vertex, {}; refine the mesh there", models[0] + 1, models[1] + 1, vertex + 1)]
    SharedVertex {
        /// The model's vertices.
        models: [u32; 2],
        /// The mesh vertex.
        vertex: u32,
    },
    /// Ridges end or meet off the model's vertices.
    #[error(
        "the ridges along {edges} of the model end or meet at mesh vertex {} at {}, which is on no vertex of the model", vertex + 1, Place(*point)
    )]
    LooseEnd {
        /// The mesh vertex.
        vertex: u32,
        /// Where it is.
        point: Vec3,
        /// The model edges, as text, from 1.
        edges: String,
    },
    /// Faces touch at a vertex which is on no edge and no vertex of the model.
    #[error("the triangles at mesh vertex {} at {} lie on several faces, but no edge or vertex of the model is there", vertex + 1, Place(*point))]
    Pinched {
        /// The mesh vertex.
        vertex: u32,
        /// Where it is.
        point: Vec3,
    },
    /// A model edge is not covered by one chain of mesh edges.
    #[error("edge {} of the model, around {}, is covered by {chains} chains of mesh edges where one should run from its first vertex to its last", edge + 1, Place(*place))]
    EdgeNotCovered {
        /// The model edge.
        edge: u32,
        /// A point of it.
        place: Vec3,
        /// Chains that were found on it.
        chains: usize,
    },
    /// No triangle lies on a face.
    #[error("face {} of the model, between {} and {}, has no triangle of the mesh", face + 1, Place(bounds[0]), Place(bounds[1]))]
    FaceNotCovered {
        /// The face.
        face: u32,
        /// Its box.
        bounds: [Vec3; 2],
    },
}

/// Prints a point.
struct Place(Vec3);

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "({:.6}, {:.6}, {:.6})", self.0[0], self.0[1], self.0[2])
    }
}

/// Prints how many more there are.
struct Others(usize);

impl fmt::Display for Others {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self.0 {
            0 => Ok(()),
            1 => write!(f, ", and one more vertex is off"),
            n => write!(f, ", and {n} more vertices are off"),
        }
    }
}

/// Prints a number from 1, if there is one.
struct Numbered(Option<u32>);

impl fmt::Display for Numbered {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        self.0.map_or(Ok(()), |i| write!(f, ", {},", i + 1))
    }
}

/// Numbers from 0 as a text from 1: "1, 2 and 3".
pub(super) fn numbers(of: &[u32]) -> String {
    let texts: Vec<String> = of.iter().map(|i| (i + 1).to_string()).collect();
    match texts.split_last() {
        None => "none".into(),
        Some((only, [])) => only.clone(),
        Some((last, rest)) => format!("{} and {last}", rest.join(", ")),
    }
}
