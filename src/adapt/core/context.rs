//! What all threads share during a run: the mesh, the metric, the model, the limits.
use super::ids::VertexId;
use super::required::Required;
use super::store::{Store, Torn};
use super::voids::Voids;
use crate::geometry::{Evaluate, FaceEntity, Geometry, Model};
use crate::mesh::vector::Vec3;
use crate::metric::{Background, Source};
use crate::tasks::{GRAIN, Team};

/// √2 and 1/√2: an edge between them has unit length.
pub const LONG: f64 = std::f64::consts::SQRT_2;
/// See [`LONG`].
pub const SHORT: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Limits that the passes set for the operations.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Edges longer than this are split.
    pub long: f64,
    /// Edges shorter than this are collapsed.
    pub short: f64,
    /// No insertion makes an edge shorter than this, where the edge that is split is no longer than `long`.
    pub shortest_new: f64,
    /// Where that edge is longer by a factor x, `shortest_new` is divided by x to the power of this.
    pub short_for_long: f64,
    /// No collapse makes an edge longer than this.
    pub longest_new: f64,
    /// An insertion may lower the worst mean ratio of its cavity to this, but no further unless it was worse already.
    pub insert_floor: f64,
    /// Whether a much too long edge may be split at the price of a bad tetrahedron, which later operations repair.
    pub long_first: bool,
    /// Where the worst mean ratio is below the floor already, the share of it that must be left.
    pub insert_loss: f64,
    /// Whether an edge waits for the next sweep where a tetrahedron about it was made in this one, so that flips come between.
    pub waits: bool,
    /// As the floor of insertion, for a collapse. Where the worst mean ratio is below it already, nothing may be lost.
    pub collapse_floor: f64,
    /// Smoothing and repair look at tetrahedra below this mean ratio.
    pub improve_below: f64,
    /// Reconnection looks at tetrahedra below this mean ratio.
    pub flip_below: f64,
    /// Tetrahedra below this mean ratio try multi-face removal. With 0.82 a third more would try, and little is gained.
    pub several_below: f64,
    /// Reconnection looks at tetrahedra that changed at or after this time.
    pub since: u32,
    /// Least cosine between a surface triangle's normal and the model's, unless it is less already. It is low, since long thin triangles
    /// across a curved face always deviate.
    pub cos_deviation: f64,
    /// Whether the user bounds that angle: then it is that in space everywhere, not in unit space where the model crosses layers.
    pub bounds_angle: bool,
    /// As `cos_deviation`, for half the greatest angle between the model's normals at the triangle's vertices. With 0.94 a circle keeps nine edges.
    pub cos_variation: f64,
    /// Greatest distance of a surface triangle from the model, at its centroid and the middles of its edges.
    pub chord: f64,
    /// Greatest distance of a surface triangle's centroid from the model, in the metric, unless it is more already. Across a layer much thinner
    /// than this, vertices on the triangle would find no way to the model.
    pub rise: f64,
    /// Most tetrahedra in an enlarged cavity.
    pub cavity: usize,
    /// A vertex of more tetrahedra stays where it is: to try it on each of its neighbours would take the square of their number.
    pub ball: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            long: LONG,
            short: SHORT,
            shortest_new: 0.5,
            short_for_long: 0.0,
            longest_new: LONG,
            insert_floor: 0.1,
            long_first: false,
            insert_loss: 0.5,
            waits: false,
            collapse_floor: 0.2,
            improve_below: 1.0,
            flip_below: 1.0,
            several_below: 0.75,
            since: 0,
            cos_deviation: 0.5,
            bounds_angle: false,
            cos_variation: 0.94,
            chord: f64::INFINITY,
            rise: 1.0,
            cavity: 96,
            ball: usize::MAX,
        }
    }
}

/// Shared, read by all threads; written between sweeps.
pub struct Context<'m> {
    /// The mesh.
    pub store: Store,
    /// Where new vertices take their metric from.
    pub source: &'m Source,
    /// The metric on the way to that of the source, in a stage.
    pub stage: Option<Box<Background>>,
    /// The model the boundary lies on.
    pub model: &'m Model,
    /// Outward normals of the faces that are planes.
    pub planes: Vec<Option<Vec3>>,
    /// What must stay as it is.
    pub required: Required,
    /// For each vertex of the input its id. For vertices that are gone the value means nothing.
    pub ids: Vec<VertexId>,
    /// Where the boundary is near itself across a void.
    pub voids: Voids,
    /// Limits of the present pass.
    pub limits: Limits,
}

impl<'m> Context<'m> {
    /// A context on a filled store.
    pub fn new(store: Store, source: &'m Source, model: &'m Model) -> Self {
        let mut evaluator = model.evaluator();
        let faces = model.topology().faces.iter().zip(0..);
        let normal = |(face, i): (&FaceEntity, u32)| {
            let middle = face.range.map(|[low, high]| 0.5 * (low + high));
            model.is_plane(i).then(|| evaluator.face_normal(i, middle))
        };
        let planes = faces.map(normal).collect();
        let ids = (0..store.vertex_bound() as u32).map(VertexId).collect();
        Self {
            store,
            source,
            stage: None,
            model,
            planes,
            required: Required::default(),
            ids,
            voids: Voids::default(),
            limits: Limits::default(),
        }
    }

    /// Renumbers the mesh along a space-filling curve; returns the new id of each old one. Pools of free ids must be emptied.
    ///
    /// # Errors
    /// [`Torn`], and nothing is done, where a tetrahedron has a dead vertex.
    pub fn reorder(&mut self, team: Team<'_>) -> Result<Vec<VertexId>, Torn> {
        let number = self.store.reorder(team)?;
        self.required.renumber(&number);
        // Its triangles are known by the old ids.
        self.voids = Voids::default();
        team.fill(GRAIN, &mut self.ids, |_, ids| {
            for id in ids.iter_mut().filter(|id| id.is_some()) {
                *id = number[id.index()];
            }
        });
        Ok(number)
    }

    /// Whether the vertex must neither move nor go.
    #[inline(always)]
    pub fn is_frozen(&self, v: VertexId) -> bool {
        self.required.is_frozen(v)
    }
}
