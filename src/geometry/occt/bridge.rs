//! The bridge to cpp/: every call returns a Result, because a C++ exception that leaves a call without one ends
//! the process.

#[cxx::bridge(namespace = "geo_adapt")]
pub mod ffi {
    /// A face as OCCT has it.
    struct FaceRecord {
        /// GeomAbs_SurfaceType.
        kind: u32,
        reversed: bool,
        /// u least, u greatest, v least, v greatest.
        range: [f64; 4],
        /// Whether the range is exact: it follows from lines, circles and ellipses in the plane of the parameters.
        exact_range: bool,
        /// Range of the untrimmed surface, in the same order.
        natural: [f64; 4],
        /// Zero where not periodic.
        period: [f64; 2],
        /// Smooth spans in u and v.
        spans: [u32; 2],
        tolerance: f64,
        bounds: [f64; 6],
        /// In the order of its wires; a seam is there twice.
        edges: Vec<u32>,
    }

    /// An edge as OCCT has it.
    struct EdgeRecord {
        /// GeomAbs_CurveType.
        kind: u32,
        /// First and last, −1 for none.
        vertices: [i32; 2],
        range: [f64; 2],
        /// Zero where not periodic.
        period: f64,
        /// Smooth spans.
        spans: u32,
        degenerate: bool,
        tolerance: f64,
    }

    /// A vertex as OCCT has it.
    struct VertexRecord {
        point: [f64; 3],
        tolerance: f64,
    }

    /// Frame and sizes of an analytic surface or curve.
    struct Form {
        origin: [f64; 3],
        x: [f64; 3],
        y: [f64; 3],
        z: [f64; 3],
        /// Radius; radius and half angle (cone); both radii (torus).
        sizes: [f64; 2],
    }

    /// A name and a colour (#RRGGBB); empty where there is none.
    struct LabelRecord {
        name: String,
        colour: String,
    }

    /// A label of an edge (dimension 1), face (2) or solid (3).
    struct NamedRecord {
        dimension: u32,
        index: u32,
        name: String,
        colour: String,
    }

    /// What is wrong with a face.
    struct FlawRecord {
        face: u32,
        what: String,
    }

    /// What healing has done.
    struct HealRecord {
        /// 0: an edge was collapsed, 1: a face, 2: an edge was sewn.
        what: u32,
        /// Its middle.
        at: [f64; 3],
        /// Its length or area.
        size: f64,
    }

    /// A solid that was divided, since faces of it lay on each other.
    struct DoubleWallRecord {
        /// A point of these.
        at: [f64; 3],
        /// So many solids were made of it.
        solids: u64,
    }

    /// An edge that was moved onto its faces.
    struct GapRecord {
        edge: u64,
        /// Its greatest distance from them, before and after.
        before: f64,
        after: f64,
    }

    /// An edge as a wire of a face has it.
    struct EdgeUse {
        edge: u32,
        /// Number of the wire.
        wire: u32,
        /// 0 forward, 1 reversed, 2 internal, 3 external (TopAbs_Orientation).
        orientation: u32,
    }

    /// A face of a solid.
    struct FaceSide {
        face: u32,
        /// 0: the solid is behind the surface's normal Su × Sv; 1: before it; 2: on both sides; 3: on none.
        orientation: u32,
    }

    /// The far field around a body: a box, or a sphere where the radius is positive; cut at a plane where the axis is not −1.
    struct DomainRecord {
        /// The box; with a sphere what is kept of it.
        low: [f64; 3],
        high: [f64; 3],
        centre: [f64; 3],
        radius: f64,
        /// Normal of the plane of symmetry, and its place on that axis.
        axis: i32,
        at: f64,
    }

    /// A copy of a spline or a conic, its location applied (cpp/splines.cpp).
    struct Spline {
        /// 0 none, 1 a spline; origin, x and y of: 2 O + tX, 3 O + cos t X + sin t Y, 4 O + cosh t X + sinh t Y,
        /// 5 O + t²X + tY; of a surface: 6 revolution about the axis O, X, 7 extrusion along X.
        kind: u32,
        /// Of u and v; the second is 0 on curves.
        degrees: [u32; 2],
        /// Zero where not periodic.
        periods: [f64; 2],
        rational: bool,
        /// Each as often as its multiplicity, a periodic spline's with those beyond its ends: those of u, then those of v.
        knots: Vec<f64>,
        /// How many of them are u's, on surfaces.
        first_knots: u32,
        /// wx, wy, wz, w of each pole, v fastest; a periodic spline's go round as its knots do.
        poles: Vec<f64>,
        origin: [f64; 3],
        x: [f64; 3],
        y: [f64; 3],
    }

    unsafe extern "C++" {
        include!("geo-adapt/cpp/occt.hpp");
        include!("geo-adapt/cpp/splines.hpp");

        type Model;
        fn load_model(path: &str, format: u32) -> Result<SharedPtr<Model>>;
        fn face_count(self: &Model) -> Result<u32>;
        fn edge_count(self: &Model) -> Result<u32>;
        fn vertex_count(self: &Model) -> Result<u32>;
        fn solid_count(self: &Model) -> Result<u32>;
        fn face_record(self: &Model, face: u32) -> Result<FaceRecord>;
        fn edge_record(self: &Model, edge: u32) -> Result<EdgeRecord>;
        fn vertex_record(self: &Model, vertex: u32) -> Result<VertexRecord>;
        fn bounds(self: &Model) -> Result<[f64; 6]>;
        fn face_area(self: &Model, face: u32) -> Result<f64>;
        fn face_centre(self: &Model, face: u32) -> Result<[f64; 3]>;
        fn edge_length(self: &Model, edge: u32) -> Result<f64>;
        fn relabelled(self: &Model, named: &[NamedRecord]) -> Result<SharedPtr<Model>>;
        fn write_brep(self: &Model, path: &str) -> Result<()>;
        /// What OpenCASCADE's own check finds.
        fn flaws(self: &Model) -> Result<Vec<FlawRecord>>;
        fn save(self: &Model, path: &str) -> Result<()>;
        fn load_saved(path: &str) -> Result<SharedPtr<Model>>;
        fn edge_uses(self: &Model, face: u32) -> Result<Vec<EdgeUse>>;
        fn loose_vertices(self: &Model, face: u32) -> Result<Vec<u32>>;
        fn edge_parameters(
            self: &Model,
            edge: u32,
            face: u32,
            reversed: bool,
            t: &[f64],
            uv: &mut [f64],
        ) -> Result<bool>;
        fn solid_sides(self: &Model, solid: u32) -> Result<Vec<FaceSide>>;
        fn solid_volume(self: &Model, solid: u32) -> Result<f64>;
        /// Of an edge (dimension 1), face (2) or solid (3).
        fn label(self: &Model, dimension: u32, index: u32) -> Result<LabelRecord>;
        fn domain(self: &Model, domain: &DomainRecord) -> Result<SharedPtr<Model>>;
        fn placed(self: &Model, factor: f64, by: &[f64; 3]) -> Result<SharedPtr<Model>>;
        fn double_walls(self: &Model) -> Result<Vec<DoubleWallRecord>>;
        fn gaps_closed(self: &Model) -> Result<Vec<GapRecord>>;
        fn healed(self: &Model, length: f64, done: &mut Vec<HealRecord>) -> Result<SharedPtr<Model>>;

        fn surface_spline(model: &Model, face: u32) -> Result<Spline>;
        fn surface_generatrix(model: &Model, face: u32) -> Result<Spline>;
        fn curve_spline(model: &Model, edge: u32) -> Result<Spline>;
        fn pcurve_spline(model: &Model, edge: u32, face: u32, reversed: bool) -> Result<Spline>;

        type Evaluator;
        fn new_evaluator(model: &SharedPtr<Model>) -> Result<UniquePtr<Evaluator>>;
        fn surface_form(self: Pin<&mut Evaluator>, face: u32) -> Result<Form>;
        fn curve_form(self: Pin<&mut Evaluator>, edge: u32) -> Result<Form>;
        fn surface_d0(self: Pin<&mut Evaluator>, face: u32, u: f64, v: f64, out: &mut [f64; 3]) -> Result<()>;
        /// Point, Su, Sv, Suu, Suv, Svv.
        fn surface_d2(self: Pin<&mut Evaluator>, face: u32, u: f64, v: f64, out: &mut [f64; 18]) -> Result<()>;
        /// Point, C′, C″.
        fn curve_d2(self: Pin<&mut Evaluator>, edge: u32, t: f64, out: &mut [f64; 9]) -> Result<()>;
        /// False when the edge has no curve on the face.
        fn pcurve_d0(self: Pin<&mut Evaluator>, edge: u32, face: u32, t: f64, out: &mut [f64; 2]) -> Result<bool>;
        /// Whether the parameters lie in the trimmed face or on its boundary.
        fn inside(self: Pin<&mut Evaluator>, face: u32, u: f64, v: f64) -> Result<bool>;
        /// OCCT's own distance to a face or an edge: slow, the oracle of the tests.
        fn reference_distance(self: &Evaluator, is_face: bool, index: u32, point: &[f64; 3]) -> Result<f64>;
    }
}

// SAFETY: a Model is never changed after load_model has returned it; its member functions are const and read shapes
// and maps only, whose reference counts are atomic. The boxes that it keeps are all found by entities::build, before the model is shared.
unsafe impl Send for ffi::Model {}
// SAFETY: as above.
unsafe impl Sync for ffi::Model {}
// SAFETY: an Evaluator owns its adaptors and classifiers, and shares with others only the Model and curves and surfaces
// that it reads, whose reference counts are atomic. It is not Sync: its calls fill caches.
unsafe impl Send for ffi::Evaluator {}
