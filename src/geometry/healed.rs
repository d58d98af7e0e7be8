//! What was done to a model: by healing, or when it was read.
use crate::mesh::vector::Vec3;

/// What was done at one place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Remedy {
    /// An edge shorter than the length is a vertex now.
    CollapsedEdge,
    /// A face narrower than the length is an edge or a vertex now.
    CollapsedFace,
    /// An edge that had a face on one side alone lies on another one within the length.
    SewnEdge,
}

/// Something that was healed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Healed {
    /// What was done.
    pub remedy: Remedy,
    /// The middle of the edge or face, model units.
    pub at: Vec3,
    /// Its length, or its area; model units or their square.
    pub size: f64,
}

/// A solid that was divided when its file was read, since faces of it lay on each other: both walls between parts of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DoubleWall {
    /// A point of these faces, model units.
    pub at: Vec3,
    /// So many solids were made of it.
    pub solids: u64,
}

/// An edge that was off its faces, and was moved onto them when the model's file was read (METHOD.md §3).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosedGap {
    /// The edge, from 0.
    pub edge: u32,
    /// Its greatest distance from its faces in the file, model units.
    pub before: f64,
    /// The same now: where the faces do not meet half of the distance between them is left.
    pub after: f64,
}
