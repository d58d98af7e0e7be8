//! A model of any backend. The kernel works on this type: backends are told apart by a match, not by a virtual call.
use super::classify::Classification;
use super::{
    ClosedGap, CurveFrame, Discrete, DoubleWall, Evaluate, FarField, Geometry, Healed, Names, OnCurve, OnSurface,
    SurfaceFrame, Topology,
};
use crate::mesh::TetMesh;
use crate::mesh::vector::Vec3;
use std::collections::BTreeMap;

/// A geometry of one of the backends.
pub enum Model {
    /// A B-rep read by OpenCASCADE.
    #[cfg(feature = "occt")]
    Occt(super::occt::OcctModel),
    /// The surface of a mesh itself.
    Discrete(Discrete),
}

/// The evaluator of a [`Model`], for one thread.
#[allow(missing_docs)]
pub enum Evaluator<'a> {
    #[cfg(feature = "occt")]
    Occt(<super::occt::OcctModel as Geometry>::Evaluator<'a>),
    Discrete(<Discrete as Geometry>::Evaluator<'a>),
}

impl Model {
    /// Prepares the trimming of all faces. OpenCASCADE crashes at that on some damaged models, so a child process does it first.
    pub fn try_trimming(&self) {
        match self {
            #[cfg(feature = "occt")]
            Model::Occt(model) => model.try_trimming(),
            Model::Discrete(_) => {}
        }
    }

    /// Reads a model file; the format follows from the extension (.step .stp .iges .igs .brep .egads).
    #[cfg(feature = "occt")]
    pub fn read(path: &std::path::Path) -> Result<Self, super::Error> {
        super::occt::OcctModel::read(path).map(Model::Occt)
    }

    /// Without OpenCASCADE no model file can be read.
    #[cfg(not(feature = "occt"))]
    pub fn read(path: &std::path::Path) -> Result<Self, super::Error> {
        let message = "this build has no CAD backend; build geo-adapt with its feature `occt`, or leave the model out";
        Err(super::Error::Model { path: path.into(), message: message.into() })
    }

    /// Reads what [`Self::save`] has written.
    ///
    /// # Errors
    /// [`super::Error::Model`] when the file cannot be read.
    pub fn read_saved(path: &std::path::Path) -> Result<Self, super::Error> {
        #[cfg(feature = "occt")]
        return super::occt::OcctModel::read_saved(path).map(Model::Occt);
        #[cfg(not(feature = "occt"))]
        Self::read(path)
    }

    /// Writes a CAD model in binary form, for another process of this program: reading that takes a tenth of the time.
    ///
    /// # Errors
    /// [`super::Error::Model`] when it is no CAD model or the file cannot be written.
    pub fn save(&self, path: &std::path::Path) -> Result<(), super::Error> {
        match self {
            #[cfg(feature = "occt")]
            Model::Occt(model) => model.save(path),
            Model::Discrete(_) => {
                Err(super::Error::Model { path: path.into(), message: "a mesh's own surface is no CAD model".into() })
            }
        }
    }

    /// The names and colours of its edges, faces and solids.
    pub fn names(&self) -> &Names {
        static NONE: Names = Names { triangles: BTreeMap::new(), edges: BTreeMap::new(), tetrahedra: BTreeMap::new() };
        match self {
            #[cfg(feature = "occt")]
            Model::Occt(model) => model.names(),
            Model::Discrete(_) => &NONE,
        }
    }

    /// Gives a CAD model other names.
    pub fn rename(&mut self, names: Names) {
        match self {
            #[cfg(feature = "occt")]
            Model::Occt(model) => model.rename(names),
            Model::Discrete(_) => drop(names),
        }
    }

    /// Takes over the references of a mesh that is put on a surface: see [`Discrete::adopt_references`]. A CAD model has none.
    pub fn adopt_references(&mut self, mesh: &TetMesh, place: &Classification) {
        match self {
            #[cfg(feature = "occt")]
            Model::Occt(_) => {
                let _ = (mesh, place);
            }
            Model::Discrete(model) => model.adopt_references(mesh, place),
        }
    }

    /// The far field without this body.
    ///
    /// # Errors
    /// [`super::Error::Model`] when it is no CAD model or OpenCASCADE cannot subtract it.
    pub fn domain(&self, far: &FarField) -> Result<Self, super::Error> {
        match self {
            #[cfg(feature = "occt")]
            Model::Occt(model) => model.domain(far).map(Model::Occt),
            Model::Discrete(_) => {
                let _ = far;
                let message = "a mesh's own surface is no CAD model";
                Err(super::Error::Model { path: "the far field".into(), message: message.into() })
            }
        }
    }

    /// The model without what is smaller than a length, model units; with what was done.
    ///
    /// # Errors
    /// [`super::Error::Model`] when it is no CAD model or OpenCASCADE makes no valid shape of it.
    pub fn healed(&self, length: f64) -> Result<(Self, Vec<Healed>), super::Error> {
        match self {
            #[cfg(feature = "occt")]
            Model::Occt(model) => model.healed(length).map(|(model, done)| (Model::Occt(model), done)),
            Model::Discrete(_) => {
                let _ = length;
                let message = "a mesh's own surface is no CAD model";
                Err(super::Error::Model { path: "the healed model".into(), message: message.into() })
            }
        }
    }

    /// The solids that were divided when the model's file was read.
    pub fn double_walls(&self) -> Vec<DoubleWall> {
        match self {
            #[cfg(feature = "occt")]
            Model::Occt(model) => model.double_walls(),
            Model::Discrete(_) => Vec::new(),
        }
    }

    /// The edges that were moved onto their faces when the model's file was read.
    pub fn closed_gaps(&self) -> Vec<ClosedGap> {
        match self {
            #[cfg(feature = "occt")]
            Model::Occt(model) => model.closed_gaps(),
            Model::Discrete(_) => Vec::new(),
        }
    }

    /// The model multiplied by a factor about the origin, then moved. Its entities keep their numbers and names.
    ///
    /// # Errors
    /// [`super::Error::Model`] when it is no CAD model or OpenCASCADE cannot transform it.
    pub fn placed(&self, factor: f64, by: Vec3) -> Result<Self, super::Error> {
        match self {
            #[cfg(feature = "occt")]
            Model::Occt(model) => model.placed(factor, by).map(Model::Occt),
            Model::Discrete(_) => {
                let _ = (factor, by);
                let message = "a mesh's own surface is no CAD model";
                Err(super::Error::Model { path: "the scaled model".into(), message: message.into() })
            }
        }
    }

    /// What OpenCASCADE's own check finds wrong with faces, in words. Slow on large models.
    pub fn flaws(&self) -> Vec<(u32, String)> {
        match self {
            #[cfg(feature = "occt")]
            Model::Occt(model) => model.flaws(),
            Model::Discrete(_) => Vec::new(),
        }
    }

    /// Writes the model as OpenCASCADE's BREP text, its entities in our order.
    ///
    /// # Errors
    /// [`super::Error::Model`] when it is no CAD model or the file cannot be written.
    pub fn write_brep(&self, path: &std::path::Path) -> Result<(), super::Error> {
        match self {
            #[cfg(feature = "occt")]
            Model::Occt(model) => model.write_brep(path),
            Model::Discrete(_) => {
                Err(super::Error::Model { path: path.into(), message: "a mesh's own surface is no CAD model".into() })
            }
        }
    }

    /// Area of a face, in the square of the model's unit; none where the backend does not tell.
    pub fn face_area(&self, face: u32) -> Option<f64> {
        match self {
            #[cfg(feature = "occt")]
            Model::Occt(model) => model.face_area(face),
            Model::Discrete(_) => {
                let _ = face;
                None
            }
        }
    }

    /// Centre of a face's area, which on a curved face lies beside it; none where the backend does not tell.
    pub fn face_centre(&self, face: u32) -> Option<Vec3> {
        match self {
            #[cfg(feature = "occt")]
            Model::Occt(model) => model.face_centre(face),
            Model::Discrete(_) => {
                let _ = face;
                None
            }
        }
    }

    /// Faces whose surface has no copy in Rust: OpenCASCADE evaluates them point by point, which is slower.
    pub fn faces_on_bridge(&self) -> Vec<u32> {
        match self {
            #[cfg(feature = "occt")]
            Model::Occt(model) => {
                (0..model.topology().faces.len() as u32).filter(|&face| model.is_on_bridge(face)).collect()
            }
            Model::Discrete(_) => Vec::new(),
        }
    }

    /// Length of an edge, in the model's unit; none where the backend does not tell.
    pub fn edge_length(&self, edge: u32) -> Option<f64> {
        match self {
            #[cfg(feature = "occt")]
            Model::Occt(model) => model.edge_length(edge),
            Model::Discrete(_) => {
                let _ = edge;
                None
            }
        }
    }
}

impl Geometry for Model {
    type Evaluator<'a> = Evaluator<'a>;

    fn topology(&self) -> &Topology {
        match self {
            #[cfg(feature = "occt")]
            Model::Occt(model) => model.topology(),
            Model::Discrete(model) => model.topology(),
        }
    }

    fn evaluator(&self) -> Evaluator<'_> {
        match self {
            #[cfg(feature = "occt")]
            Model::Occt(model) => Evaluator::Occt(model.evaluator()),
            Model::Discrete(model) => Evaluator::Discrete(model.evaluator()),
        }
    }

    fn is_plane(&self, face: u32) -> bool {
        match self {
            #[cfg(feature = "occt")]
            Model::Occt(model) => model.is_plane(face),
            Model::Discrete(model) => model.is_plane(face),
        }
    }
}

/// Sends a call to the backend at hand.
macro_rules! forward {
    ($self:ident, $call:ident($($argument:expr),*)) => {
        match $self {
            #[cfg(feature = "occt")]
            Evaluator::Occt(evaluator) => evaluator.$call($($argument),*),
            Evaluator::Discrete(evaluator) => evaluator.$call($($argument),*),
        }
    };
}

impl Evaluate for Evaluator<'_> {
    fn edge_frame(&mut self, edge: u32, t: f64) -> CurveFrame {
        forward!(self, edge_frame(edge, t))
    }

    fn face_frame(&mut self, face: u32, uv: [f64; 2]) -> SurfaceFrame {
        forward!(self, face_frame(face, uv))
    }

    fn face_normal(&mut self, face: u32, uv: [f64; 2]) -> Vec3 {
        forward!(self, face_normal(face, uv))
    }

    fn edge_on_face(&mut self, edge: u32, t: f64, face: u32) -> Option<[f64; 2]> {
        forward!(self, edge_on_face(edge, t, face))
    }

    fn closest_on_edge(&mut self, edge: u32, point: Vec3, guess: Option<f64>) -> OnCurve {
        forward!(self, closest_on_edge(edge, point, guess))
    }

    fn closest_on_face(&mut self, face: u32, point: Vec3, guess: Option<[f64; 2]>) -> OnSurface {
        forward!(self, closest_on_face(face, point, guess))
    }
    fn closest_on_face_within(&mut self, face: u32, point: Vec3, limit: f64) -> Option<OnSurface> {
        forward!(self, closest_on_face_within(face, point, limit))
    }
    fn closest_on_edge_within(&mut self, edge: u32, point: Vec3, limit: f64) -> Option<OnCurve> {
        forward!(self, closest_on_edge_within(edge, point, limit))
    }
    fn edge_box(&self, edge: u32) -> Option<[Vec3; 2]> {
        forward!(self, edge_box(edge))
    }

    fn closest_on_surface(&mut self, face: u32, point: Vec3, guess: [f64; 2]) -> OnSurface {
        forward!(self, closest_on_surface(face, point, guess))
    }

    fn foot_on_surface(&mut self, face: u32, point: Vec3, guess: [f64; 2]) -> OnSurface {
        forward!(self, foot_on_surface(face, point, guess))
    }
}
