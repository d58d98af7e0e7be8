//! Building a discrete geometry from a mesh.
use super::patch::Patch;
use super::polyline::Polyline;
use super::tree::box_of;
use super::{Chain, Features, outward_triangles, trace_chains};
use crate::geometry::classify::{Classification, Error as Unfit};
use crate::geometry::{
    CurveKind, EdgeEntity, Entity, Error, Evaluate, FaceEntity, Geometry, SurfaceKind, Topology, VertexEntity,
};
use crate::mesh::TetMesh;
use crate::mesh::vector::{Vec3, distance, dot, sub, unit};
use crate::tasks::{GRAIN, Team};

/// Dihedral angle in degrees beyond which an edge is a ridge by default.
pub const DEFAULT_RIDGE_ANGLE: f64 = 45.0;

/// A patch is plane if no vertex is farther from its mean plane than this part of the mesh's diagonal: the noise
/// of a file in single precision.
const FLAT: f64 = 1e-7;

/// The surface of a mesh as a geometry: patches of triangles are faces, chains of ridges edges.
pub struct Discrete {
    pub(super) topology: Topology,
    pub(super) curves: Vec<Polyline>,
    pub(super) patches: Vec<Patch>,
    /// Per edge and segment the faces beside it, each with the triangle of that face.
    pub(super) beside: Vec<Vec<Vec<(u32, u32)>>>,
    /// Reference of the triangles of each face.
    pub(super) face_refs: Vec<i32>,
    /// Reference of the listed edges of each edge.
    pub(super) edge_refs: Vec<Option<i32>>,
}

impl Discrete {
    /// The mesh's surface as its own geometry, and the mesh put on it.
    ///
    /// Ridges are the mesh's listed edges, edges between references, non-manifold edges, and edges with a dihedral angle
    /// beyond `ridge_angle_deg` (degrees). Corners are listed ones, required vertices, ends and branches of ridges,
    /// and vertices at which a chain of ridges turns by more than the angle, or changes its reference or its faces.
    ///
    /// # Errors
    /// If the mesh has no triangles; see [`super::complete_boundary`].
    pub fn from_mesh(team: Team<'_>, mesh: &TetMesh, ridge_angle_deg: f64) -> Result<(Self, Classification), Error> {
        if mesh.triangles.is_empty() {
            return Err(Unfit::NoTriangles.into());
        }
        let builder = Builder::new(team, mesh, ridge_angle_deg);
        let model = builder.model();
        let classification = builder.classification(&model);
        Ok((model, classification))
    }
}

/// Features of the mesh and their numbering.
struct Builder<'a> {
    team: Team<'a>,
    mesh: &'a TetMesh,
    features: Features,
    /// Ridges as indices into the features' edges.
    ridges: Vec<u32>,
    chains: Vec<Chain>,
    /// Model vertex of each mesh vertex that is a corner.
    corners: Vec<Option<u32>>,
}

impl<'a> Builder<'a> {
    fn new(team: Team<'a>, mesh: &'a TetMesh, ridge_angle_deg: f64) -> Self {
        let features = Features::detect(team, mesh, ridge_angle_deg);
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
        Self { team, mesh, features, ridges, chains, corners }
    }

    fn model(&self) -> Discrete {
        let triangles = outward_triangles(self.team, self.mesh);
        let members = self.features.members();
        let bounds = box_of(self.mesh.triangles.nodes.iter().flatten().map(|&v| self.mesh.vertices[v as usize]));
        let flat = FLAT * distance(bounds[0], bounds[1]);
        let patches: Vec<Patch> = members
            .iter()
            .map(|members| {
                let nodes: Vec<[u32; 3]> = members.iter().map(|&t| triangles[t as usize]).collect();
                Patch::new(&self.mesh.vertices, &nodes, flat)
            })
            .collect();
        let beside = self.beside(&members);
        let curves: Vec<Polyline> =
            self.chains.iter().map(|chain| Polyline::new(self.points(&chain.vertices), self.is_ring(chain))).collect();
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

    /// Per chain and step the faces beside, with the triangle's number within its patch.
    fn beside(&self, members: &[Vec<u32>]) -> Vec<Vec<Vec<(u32, u32)>>> {
        let mut within = vec![0u32; self.features.patch.len()];
        for members in members {
            members.iter().enumerate().for_each(|(k, &t)| within[t as usize] = k as u32);
        }
        let step = |&ridge: &u32| {
            let edge = self.ridges[ridge as usize] as usize;
            self.features.edges.triangles(edge).map(|t| (self.features.patch[t], within[t])).collect()
        };
        self.chains.iter().map(|chain| chain.edges.iter().map(step).collect()).collect()
    }

    fn list_vertices(&self, topology: &mut Topology) {
        for (v, corner) in self.corners.iter().enumerate() {
            if corner.is_some() {
                let point = self.mesh.vertices[v];
                topology.vertices.push(VertexEntity { point, edges: Vec::new(), tolerance: 0.0 });
            }
        }
    }

    fn list_edges(&self, topology: &mut Topology, curves: &[Polyline], beside: &[Vec<Vec<(u32, u32)>>]) {
        for (e, chain) in self.chains.iter().enumerate() {
            let ends = [chain.vertices[0], chain.vertices[chain.vertices.len() - 1]];
            let vertices = ends.map(|v| self.corners[v as usize]);
            for (i, vertex) in vertices.iter().enumerate() {
                if let (Some(vertex), true) = (vertex, i == 0 || vertices[0] != vertices[1]) {
                    topology.vertices[*vertex as usize].edges.push(e as u32);
                }
            }
            let mut faces: Vec<u32> = beside[e].iter().flatten().map(|(face, _)| *face).collect();
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

/// Which mesh vertices are corners of the surface.
fn find_corners(mesh: &TetMesh, features: &Features, ridges: &[u32], angle_deg: f64) -> Vec<bool> {
    let count = mesh.vertices.len();
    let mut on_surface = vec![false; count];
    mesh.triangles.nodes.iter().flatten().for_each(|&v| on_surface[v as usize] = true);
    let mut corner = vec![false; count];
    for &v in mesh.corners.iter().chain(&mesh.required_vertices) {
        corner[v as usize] = on_surface[v as usize];
    }
    // Ridges at each vertex: how many, and the first two.
    let mut at = vec![(0u32, [0u32; 2]); count];
    for &edge in ridges {
        for v in features.edges.nodes[edge as usize] {
            let (n, first) = &mut at[v as usize];
            if *n < 2 {
                first[*n as usize] = edge;
            }
            *n += 1;
        }
    }
    let least_cosine = angle_deg.to_radians().cos();
    for v in 0..count {
        corner[v] |= match at[v] {
            (0, _) => false,
            (2, pair) => splits(mesh, features, v as u32, pair, least_cosine),
            _ => true,
        };
    }
    for v in touching_patches(mesh, features, &at) {
        corner[v] = true;
    }
    corner
}

/// Whether two ridges that meet at a vertex belong to different edges of the geometry.
fn splits(mesh: &TetMesh, features: &Features, v: u32, [e, f]: [u32; 2], least_cosine: f64) -> bool {
    let other = |edge: u32| {
        let [a, b] = features.edges.nodes[edge as usize];
        mesh.vertices[(a ^ b ^ v) as usize]
    };
    let here = mesh.vertices[v as usize];
    let turn = dot(unit(sub(here, other(e))), unit(sub(other(f), here)));
    turn < least_cosine
        || features.listed[e as usize] != features.listed[f as usize]
        || patches_beside(features, e) != patches_beside(features, f)
}

fn patches_beside(features: &Features, edge: u32) -> Vec<u32> {
    let mut patches: Vec<u32> = features.edges.triangles(edge as usize).map(|t| features.patch[t]).collect();
    patches.sort_unstable();
    patches.dedup();
    patches
}

/// Vertices at which a patch touches others without a ridge between them.
fn touching_patches(mesh: &TetMesh, features: &Features, at: &[(u32, [u32; 2])]) -> Vec<usize> {
    let mut found = Vec::new();
    let mut only = vec![u32::MAX; mesh.vertices.len()];
    for (nodes, &patch) in mesh.triangles.nodes.iter().zip(&features.patch) {
        for v in nodes.map(|v| v as usize) {
            let foreign = match at[v] {
                (0, _) => only[v] != u32::MAX && only[v] != patch,
                (2, [edge, _]) => !patches_beside(features, edge).contains(&patch),
                _ => false,
            };
            only[v] = patch;
            if foreign {
                found.push(v);
            }
        }
    }
    found
}
