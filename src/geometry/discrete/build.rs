//! Building a discrete geometry from a mesh.
use super::corners::find_corners;
use super::cubic::{CubicCurve, arc};
use super::foot::NONE;
use super::nets::Nets;
use super::patch::Patch;
use super::plane::Plane;
use super::polyline::{Polyline, is_straight};
use super::smooth::Smooth;
use super::tangents::tangents;
use super::tree::box_of;
use super::vertex_normals::Surface;
use super::{Chain, EdgeTable, Features, outward_triangles, trace_chains};
use crate::geometry::classify::{Classification, Error as Unfit};
use crate::geometry::{
    CurveKind, EdgeEntity, Entity, Error, Evaluate, FaceEntity, Geometry, SurfaceKind, Topology, VertexEntity,
};
use crate::mesh::TetMesh;
use crate::mesh::vector::{Vec3, distance};
use crate::tasks::{GRAIN, Team};

/// Dihedral angle in degrees beyond which an edge is a ridge by default.
pub const DEFAULT_RIDGE_ANGLE: f64 = 45.0;

/// A patch is plane if no vertex is farther from its mean plane than this part of the mesh's diagonal: the noise
/// of a file in single precision.
const FLAT: f64 = 1e-7;

/// A vertex is on the plane of its neighbours, or on a straight run of a ridge, within this share of the mesh's diagonal; where all
/// coordinates are numbers of single precision within this share of the greatest of them.
const ROUNDING: f64 = 1e-11;
const SINGLE: f64 = 1.2e-7;

/// How a mesh becomes a geometry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiscreteOptions {
    /// Dihedral angle in degrees beyond which an edge is a ridge; 180 for none but those that the mesh lists and those between references.
    pub ridge_angle_deg: f64,
    /// Whether faces and edges are smooth: cubic patches and curves; else the triangles and edges as they are.
    pub smooth: bool,
}

impl Default for DiscreteOptions {
    fn default() -> Self {
        Self { ridge_angle_deg: DEFAULT_RIDGE_ANGLE, smooth: true }
    }
}

/// A side of a triangle beside a segment of an edge.
pub(super) struct Beside {
    pub face: u32,
    /// 3·triangle + side within the face.
    pub side: u32,
    /// Whether the side runs as the edge does.
    pub along: bool,
}

/// The surface of a mesh as a geometry: patches of triangles are faces, chains of ridges edges.
pub struct Discrete {
    pub(super) topology: Topology,
    pub(super) curves: Vec<Polyline>,
    pub(super) patches: Vec<Patch>,
    /// Per edge and segment the sides of triangles there.
    pub(super) beside: Vec<Vec<Vec<Beside>>>,
    /// Reference of the triangles of each face.
    pub(super) face_refs: Vec<i32>,
    /// Reference of the listed edges of each edge.
    pub(super) edge_refs: Vec<Option<i32>>,
}

impl Discrete {
    /// The mesh's surface as its own geometry, smooth, and the mesh put on it: [`Discrete::new`] with the ridge angle (degrees).
    ///
    /// # Errors
    /// As there.
    pub fn from_mesh(team: Team<'_>, mesh: &TetMesh, ridge_angle_deg: f64) -> Result<(Self, Classification), Error> {
        Self::new(team, mesh, &DiscreteOptions { ridge_angle_deg, ..DiscreteOptions::default() })
    }

    /// The mesh's surface as its own geometry, and the mesh put on it.
    ///
    /// Ridges are the mesh's listed edges, edges between references, non-manifold edges, and edges with a dihedral angle
    /// beyond the ridge angle. Corners are listed ones, required vertices, ends and branches of ridges,
    /// and vertices at which a chain of ridges turns by more than the angle, or changes its reference or its faces.
    ///
    /// # Errors
    /// If the mesh has no triangles; see [`super::complete_boundary`].
    pub fn new(team: Team<'_>, mesh: &TetMesh, options: &DiscreteOptions) -> Result<(Self, Classification), Error> {
        if mesh.triangles.is_empty() {
            return Err(Unfit::NoTriangles.into());
        }
        let builder = Builder::new(team, mesh, options);
        let model = builder.model();
        let classification = builder.classification(&model);
        Ok((model, classification))
    }
}

/// Features of the mesh and their numbering.
struct Builder<'a> {
    team: Team<'a>,
    mesh: &'a TetMesh,
    smooth: bool,
    /// The triangles, outward.
    triangles: Vec<[u32; 3]>,
    features: Features,
    /// Ridges as indices into the features' edges.
    ridges: Vec<u32>,
    chains: Vec<Chain>,
    /// Model vertex of each mesh vertex that is a corner.
    corners: Vec<Option<u32>>,
}

impl<'a> Builder<'a> {
    fn new(team: Team<'a>, mesh: &'a TetMesh, options: &DiscreteOptions) -> Self {
        let DiscreteOptions { ridge_angle_deg, smooth } = *options;
        let triangles = outward_triangles(team, mesh);
        let mut features = Features::detect(team, mesh, ridge_angle_deg);
        if triangles != mesh.triangles.nodes {
            // The same edges, by the sides of the triangles as they are now.
            features.edges = EdgeTable::new(team, &triangles);
        }
        let ridges: Vec<u32> = (0..features.edges.len() as u32).filter(|&e| features.ridge[e as usize]).collect();
        let is_corner = find_corners(mesh, &features, &ridges, ridge_angle_deg);
        let nodes: Vec<[u32; 2]> = ridges.iter().map(|&e| features.edges.nodes[e as usize]).collect();
        let chains = trace_chains(&nodes, |v| is_corner[v as usize]);
        let mut count = 0;
        let mut number = |corner: bool| {
            corner.then(|| {
                count += 1;
                count - 1
            })
        };
        let corners = is_corner.into_iter().map(&mut number).collect();
        Self { team, mesh, smooth, triangles, features, ridges, chains, corners }
    }

    fn model(&self) -> Discrete {
        let members = self.features.members();
        let bounds = box_of(self.mesh.triangles.nodes.iter().flatten().map(|&v| self.mesh.vertices[v as usize]));
        let diagonal = distance(bounds[0], bounds[1]);
        let of_face =
            |members: &[u32]| -> Vec<[u32; 3]> { members.iter().map(|&t| self.triangles[t as usize]).collect() };
        let planes: Vec<Option<Plane>> = members
            .iter()
            .map(|members| {
                let corners = |nodes: [u32; 3]| nodes.map(|v| self.mesh.vertices[v as usize]);
                let triangles: Vec<[Vec3; 3]> = of_face(members).into_iter().map(corners).collect();
                Plane::fit(&triangles, FLAT * diagonal)
            })
            .collect();
        let within = self.within(&members);
        let (mut smooth, curves) = match self.smooth {
            true => self.smooth(&members, &within, &planes, diagonal),
            false => (members.iter().map(|_| None).collect(), self.chains.iter().map(|_| Vec::new()).collect()),
        };
        let patches: Vec<Patch> = members
            .iter()
            .zip(planes)
            .zip(smooth.drain(..))
            .map(|((members, plane), smooth)| Patch::new(&self.mesh.vertices, &of_face(members), plane, smooth))
            .collect();
        let beside = self.beside(&within);
        let curves: Vec<Polyline> = self
            .chains
            .iter()
            .zip(curves)
            .map(|(chain, curves)| Polyline::new(self.points(&chain.vertices), curves, self.is_ring(chain)))
            .collect();
        let mut topology = Topology { solids: 1, bounds, ..Topology::default() };
        self.list_vertices(&mut topology);
        self.list_edges(&mut topology, &curves, &beside);
        self.list_faces(&mut topology, &patches);
        let listed = |chain: &Chain| self.features.listed[self.ridges[chain.edges[0] as usize] as usize];
        Discrete {
            topology,
            curves,
            patches,
            beside,
            face_refs: members.iter().map(|members| self.mesh.triangles.refs[members[0] as usize]).collect(),
            edge_refs: self.chains.iter().map(listed).collect(),
        }
    }

    fn points(&self, vertices: &[u32]) -> Vec<Vec3> {
        vertices.iter().map(|&v| self.mesh.vertices[v as usize]).collect()
    }

    fn is_ring(&self, chain: &Chain) -> bool {
        chain.is_closed() && self.corners[chain.vertices[0] as usize].is_none()
    }

    /// The number of each triangle within its face.
    fn within(&self, members: &[Vec<u32>]) -> Vec<u32> {
        let mut within = vec![0u32; self.features.patch.len()];
        for members in members {
            members.iter().enumerate().for_each(|(k, &t)| within[t as usize] = k as u32);
        }
        within
    }

    /// Per chain and step the sides of triangles there.
    fn beside(&self, within: &[u32]) -> Vec<Vec<Vec<Beside>>> {
        let step = |(&ridge, &start): (&u32, &u32)| {
            let edge = self.ridges[ridge as usize] as usize;
            let sides = self.features.edges.sides(edge).iter().map(|&side| {
                let (t, k) = (side as usize / 3, side as usize % 3);
                let along = self.triangles[t][k] == start;
                Beside { face: self.features.patch[t], side: 3 * within[t] + k as u32, along }
            });
            sides.collect()
        };
        self.chains.iter().map(|chain| chain.edges.iter().zip(&chain.vertices).map(step).collect()).collect()
    }

    /// The cubic patches of the faces, and the curves of the chains; none where all are flat or straight.
    fn smooth(
        &self,
        members: &[Vec<u32>],
        within: &[u32],
        planes: &[Option<Plane>],
        diagonal: f64,
    ) -> (Vec<Option<Smooth>>, Vec<Vec<CubicCurve>>) {
        let edges = &self.features.edges;
        let mut is_flat: Vec<bool> = planes.iter().map(Option::is_some).collect();
        let rounding = self.rounding(diagonal);
        for edge in (0..edges.len()).filter(|&edge| !self.features.ridge[edge]) {
            if let &[first, second] = edges.sides(edge) {
                let start = |side: u32| self.triangles[side as usize / 3][side as usize % 3];
                is_flat[self.features.patch[first as usize / 3] as usize] |= start(first) == start(second);
            }
        }
        // The curve of each ridge, from its first node to its second.
        let (mut ridges, mut ridge_of) = (Vec::with_capacity(self.ridges.len()), vec![None; edges.len()]);
        for chain in &self.chains {
            let points = self.points(&chain.vertices);
            let tangents = tangents(&points, self.is_ring(chain), rounding);
            for (i, &ridge) in chain.edges.iter().enumerate() {
                let edge = self.ridges[ridge as usize] as usize;
                let mut curve = arc(points[i], points[i + 1], [tangents[i], tangents[i + 1]]);
                if edges.nodes[edge][0] != chain.vertices[i] {
                    curve.reverse();
                }
                ridge_of[edge] = Some(ridges.len() as u32);
                ridges.push(curve);
            }
        }
        let (points, triangles, features) = (&self.mesh.vertices, &self.triangles, &self.features);
        let surface = Surface { points, triangles, features, is_flat: &is_flat, rounding };
        let nets = Nets::new(self.team, &surface, ridges, &ridge_of);
        let mut rest = nets.ridges.into_iter();
        let mut curves_of = |chain: &Chain| {
            let mut curves: Vec<CubicCurve> = rest.by_ref().take(chain.edges.len()).collect();
            for (i, curve) in curves.iter_mut().enumerate() {
                if edges.nodes[self.ridges[chain.edges[i] as usize] as usize][0] != chain.vertices[i] {
                    curve.reverse();
                }
            }
            if curves.iter().all(is_straight) { Vec::new() } else { curves }
        };
        let curves = self.chains.iter().map(&mut curves_of).collect();
        let shapes = std::sync::Arc::new(nets.shapes);
        let beyond = |t: u32, k: usize| {
            let edge = edges.of_side[3 * t as usize + k] as usize;
            let own = 3 * t + k as u32;
            match edges.sides(edge) {
                &[first, second] if !features.ridge[edge] => {
                    let other = if first == own { second } else { first };
                    3 * within[other as usize / 3] + other % 3
                }
                _ => NONE,
            }
        };
        let smooth = members.iter().map(|members| {
            Smooth::new(
                members.iter().map(|&t| nets.of_triangle[t as usize]),
                members.iter().flat_map(|&t| [0, 1, 2].map(|k| beyond(t, k))).collect(),
                std::sync::Arc::clone(&shapes),
                members.iter().map(|&t| [0, 1, 2].map(|k| nets.sectors.of_corner[3 * t as usize + k])).collect(),
            )
        });
        (smooth.collect(), curves)
    }

    /// How far a point may be off by the rounding of the file, model units.
    fn rounding(&self, diagonal: f64) -> f64 {
        let used = || self.mesh.triangles.nodes.iter().flatten().flat_map(|&v| self.mesh.vertices[v as usize]);
        let is_single = used().all(|x| f64::from(x as f32) == x);
        if is_single { SINGLE * used().fold(0.0, |most, x| x.abs().max(most)) } else { ROUNDING * diagonal }
    }

    fn list_vertices(&self, topology: &mut Topology) {
        for (v, corner) in self.corners.iter().enumerate() {
            if corner.is_some() {
                let point = self.mesh.vertices[v];
                topology.vertices.push(VertexEntity { point, edges: Vec::new(), tolerance: 0.0 });
            }
        }
    }

    fn list_edges(&self, topology: &mut Topology, curves: &[Polyline], beside: &[Vec<Vec<Beside>>]) {
        for (e, chain) in self.chains.iter().enumerate() {
            let ends = [chain.vertices[0], chain.vertices[chain.vertices.len() - 1]];
            let vertices = ends.map(|v| self.corners[v as usize]);
            for (i, vertex) in vertices.iter().enumerate() {
                if let (Some(vertex), true) = (vertex, i == 0 || vertices[0] != vertices[1]) {
                    topology.vertices[*vertex as usize].edges.push(e as u32);
                }
            }
            let mut faces: Vec<u32> = beside[e].iter().flatten().map(|beside| beside.face).collect();
            faces.sort_unstable();
            faces.dedup();
            let length = curves[e].length();
            topology.edges.push(EdgeEntity {
                kind: CurveKind::Discrete,
                vertices,
                faces,
                range: [0.0, length],
                period: self.is_ring(chain).then_some(length),
                degenerate: false,
                seam: false,
                tolerance: 0.0,
            });
        }
    }

    fn list_faces(&self, topology: &mut Topology, patches: &[Patch]) {
        for patch in patches {
            topology.faces.push(FaceEntity {
                kind: SurfaceKind::Discrete,
                edges: Vec::new(),
                range: patch.range(),
                period: [None; 2],
                reversed: false,
                tolerance: 0.0,
                bounds: patch.bounds(),
            });
        }
        for e in 0..topology.edges.len() {
            for &face in &topology.edges[e].faces {
                topology.faces[face as usize].edges.push(e as u32);
            }
        }
    }

    fn classification(&self, model: &Discrete) -> Classification {
        let count = self.mesh.vertices.len();
        let mut result = Classification {
            entities: vec![Entity::Interior; count],
            parameters: vec![[0.0; 2]; count],
            projected: self.mesh.vertices.clone(),
            ridges: Vec::with_capacity(self.ridges.len()),
            faces: self.features.patch.clone(),
        };
        for (nodes, &face) in self.mesh.triangles.nodes.iter().zip(&self.features.patch) {
            nodes.iter().for_each(|&v| result.entities[v as usize] = Entity::Face(face));
        }
        for (e, chain) in self.chains.iter().enumerate() {
            result.ridges.extend(chain.vertices.windows(2).map(|ends| ([ends[0], ends[1]], e as u32)));
            chain.vertices.iter().for_each(|&v| result.entities[v as usize] = Entity::Edge(e as u32));
        }
        for (v, corner) in self.corners.iter().enumerate() {
            if let Some(corner) = *corner {
                result.entities[v] = Entity::Vertex(corner);
            }
        }
        let entities = &result.entities;
        let landed = self.team.collect(GRAIN, count, |range, landed| {
            let mut evaluator = model.evaluator();
            for v in range {
                let point = self.mesh.vertices[v];
                match entities[v] {
                    Entity::Edge(edge) => {
                        landed.push((v, [evaluator.closest_on_edge(edge, point, None).t, 0.0], point));
                    }
                    Entity::Face(face) => {
                        let on = evaluator.closest_on_face(face, point, None);
                        landed.push((v, on.uv, on.point));
                    }
                    Entity::Vertex(_) | Entity::Interior => {}
                }
            }
        });
        for (v, parameters, point) in landed {
            (result.parameters[v], result.projected[v]) = (parameters, point);
        }
        result
    }
}
