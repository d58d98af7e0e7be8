//! First meshes without a CAD model.
mod triangles;
