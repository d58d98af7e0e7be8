//! What bounds the faces and the solids: the edges of the wires with their orientation, and on which side of a face a solid lies.
use super::OcctModel;
use super::evaluator::OcctEvaluator;
use super::surface::Jet;
use crate::mesh::vector::Vec3;

/// How a wire goes through an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Use {
    /// With its parameter; the face is on the left in the plane of the parameters.
    Forward,
    /// Against it.
    Reversed,
    /// The face is on both sides.
    Internal,
    /// The face is on neither.
    External,
}

/// An edge as a wire of a face has it.
#[derive(Clone, Copy, Debug)]
pub struct EdgeUse {
    /// The edge.
    pub edge: u32,
    /// Number of the wire.
    pub wire: u32,
    /// Its direction.
    pub way: Use,
}

/// Where a solid lies beside a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Behind the normal Su × Sv of the surface.
    Behind,
    /// Before it.
    Before,
    /// On both sides: the face is a sheet in the solid.
    Both,
}

fn way(orientation: u32) -> Use {
    match orientation {
        0 => Use::Forward,
        1 => Use::Reversed,
        2 => Use::Internal,
        _ => Use::External,
    }
}

impl OcctModel {
    /// The edges of a face, wire after wire; a seam is there twice. Nothing where OpenCASCADE fails.
    pub fn edge_uses(&self, face: u32) -> Vec<EdgeUse> {
        let uses = self.occt.edge_uses(face).unwrap_or_default();
        uses.iter().map(|at| EdgeUse { edge: at.edge, wire: at.wire, way: way(at.orientation) }).collect()
    }

    /// Vertices that lie in a face and on none of its edges.
    pub fn loose_vertices(&self, face: u32) -> Vec<u32> {
        self.occt.loose_vertices(face).unwrap_or_default()
    }

    /// Parameters on a face of the points of its edge at `t`, by the edge's curve in the plane of the parameters: of a seam by its second
    /// curve where it is `reversed`. None without such a curve.
    pub fn edge_parameters(&self, edge: u32, face: u32, reversed: bool, t: &[f64]) -> Option<Vec<[f64; 2]>> {
        let mut uv = vec![0.0; 2 * t.len()];
        let is_there = self.occt.edge_parameters(edge, face, reversed, t, &mut uv).unwrap_or(false);
        (is_there && uv.iter().all(|x| x.is_finite())).then(|| uv.chunks_exact(2).map(|p| [p[0], p[1]]).collect())
    }

    /// The faces of a solid with the side that it lies on.
    pub fn solid_sides(&self, solid: u32) -> Vec<(u32, Side)> {
        let sides = self.occt.solid_sides(solid).unwrap_or_default();
        sides
            .iter()
            .filter_map(|at| match way(at.orientation) {
                Use::Forward => Some((at.face, Side::Behind)),
                Use::Reversed => Some((at.face, Side::Before)),
                Use::Internal => Some((at.face, Side::Both)),
                Use::External => None,
            })
            .collect()
    }

    /// Volume of a solid, in the cube of the model's unit; none where OpenCASCADE finds none.
    pub fn solid_volume(&self, solid: u32) -> Option<f64> {
        self.occt.solid_volume(solid).ok()
    }
}

impl OcctEvaluator<'_> {
    /// S(u, v) and derivatives, at the very parameters, outside the face's range too. NaN where there is none.
    pub fn surface(&mut self, face: u32, uv: [f64; 2]) -> Jet {
        self.jet(face, uv)
    }

    /// S(u, v) alone.
    pub fn point_on_surface(&mut self, face: u32, uv: [f64; 2]) -> Vec3 {
        self.surface_point(face, uv)
    }
}
