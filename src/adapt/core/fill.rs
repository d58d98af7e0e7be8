//! From the plain mesh to the store.
use super::ids::{TetId, VertexId};
use super::numbering::Numbering;
use super::store::Store;
use crate::geometry::Entity;
use crate::geometry::classify::Classification;
use crate::mesh::TetMesh;
use crate::mesh::adjacency::{FACES, MatchedFaces, NONE, Side, TriangleIndex, sorted3};
use crate::mesh::crossing::crossings_of;
use crate::mesh::predicate::is_positive;
use crate::mesh::split_nonmanifold::Touching;
use crate::mesh::triangle_pair::{DRAWN_BACK, crossing};
use crate::mesh::vector::{Vec3, distance};
use crate::metric::{Source, Sym3, mean_ratios};
use crate::tasks::{GRAIN, Team};

/// A mesh that cannot be adapted.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// No tetrahedra.
    #[error("the mesh has no tetrahedra; a surface mesh needs a volume mesh first (gmsh, netgen or TetGen make one)")]
    Empty,
    /// A tetrahedron is inverted or flat.
    #[error(
        "tetrahedron {tet} is inverted or flat (nodes {} {} {} {}) and {others} more; `geo-adapt inspect` lists what is \
         wrong with a mesh",
        nodes[0], nodes[1], nodes[2], nodes[3]
    )]
    Inverted {
        /// Number, from 1.
        tet: usize,
        /// Nodes, from 1.
        nodes: [u32; 4],
        /// How many more.
        others: usize,
    },
    /// A metric beyond what can be computed with.
    #[error(transparent)]
    Metric(#[from] crate::metric::Error),
    /// A face of more than two tetrahedra.
    #[error("{tets} tetrahedra share the face of nodes {} {} {}; `geo-adapt inspect` lists what is wrong with a mesh", nodes[0], nodes[1], nodes[2])]
    Shared {
        /// Nodes, from 1.
        nodes: [u32; 3],
        /// How many share it.
        tets: usize,
    },
    /// The boundary touches itself in an edge.
    #[error(transparent)]
    Touching(#[from] Touching),
    /// The mesh came apart while it was adapted.
    #[error(
        "the mesh hangs together at a vertex otherwise than by the faces of its tetrahedra: do parts of it overlap? `geo-adapt inspect` lists \
         what is wrong with a mesh"
    )]
    Torn,
    /// A boundary face without a triangle.
    #[error("the boundary face of nodes {} {} {} has no triangle", nodes[0], nodes[1], nodes[2])]
    Open {
        /// Nodes, from 1.
        nodes: [u32; 3],
    },
}

/// A mesh in a store.
pub struct Filled {
    /// The store, numbered along the Hilbert curve.
    pub store: Store,
    /// Vertices that are not at their projected points: a tetrahedron would be inverted.
    pub unprojected: Vec<VertexId>,
    /// The id of each vertex of the mesh.
    pub ids: Vec<VertexId>,
}

/// Fills a store: every vertex gets its place on the model and its metric, every face its neighbour or tag.
///
/// Vertices start at their projected points, save those where a tetrahedron would be inverted there.
///
/// # Errors
/// When a tetrahedron is inverted, a face has more than two, or the triangles do not close the boundary.
#[cfg(any(test, feature = "internals"))]
pub fn fill(team: Team<'_>, mesh: &TetMesh, place: &Classification, source: &Source) -> Result<Filled, Error> {
    fill_known(team, mesh, place, source, Known { logs: source.logs_on(mesh), ..Known::default() })
}

/// What is known of a mesh before it is filled in.
#[derive(Clone, Copy, Default)]
pub struct Known<'a> {
    /// ln M at its vertices.
    pub logs: Option<&'a [Sym3]>,
    /// For each vertex the tetrahedron of the background in which the search for its metric begins.
    pub hints: Option<&'a [u32]>,
    /// Whether it is a part of a larger mesh: then faces on its boundary may have no triangle, as they are faces inside the larger mesh.
    pub is_part: bool,
}

/// As [`fill`], for a mesh of which something is known.
///
/// # Errors
/// As [`fill`].
pub fn fill_known(
    team: Team<'_>,
    mesh: &TetMesh,
    place: &Classification,
    source: &Source,
    known: Known<'_>,
) -> Result<Filled, Error> {
    if mesh.tets.is_empty() {
        return Err(Error::Empty);
    }
    let own;
    let faces = match source.faces_of(mesh) {
        Some(faces) => faces,
        None => {
            own = MatchedFaces::of(team, &mesh.tets.nodes);
            &own
        }
    };
    if let Some(crowd) = faces.crowded {
        return Err(Error::Shared { nodes: crowd.nodes.map(|v| v + 1), tets: crowd.tets });
    }
    let order = Numbering::along_curve(team, &place.projected, &mesh.tets.nodes);
    let (nv, nt) = (mesh.vertices.len(), mesh.tets.len());
    let store = Store::with_room(nv, nt);
    let mut filling = Filling { team, mesh, place, order, store };
    filling.write_vertices();
    filling.write_tets(faces);
    filling.tag_faces(faces, known.is_part)?;
    filling.join_ridges();
    let mut unprojected = filling.leave_inverting();
    while filling.leave_crossing(faces, &mut unprojected) {
        unprojected.append(&mut filling.leave_inverting());
    }
    filling.set_metrics(source, known.logs, known.hints);
    let Filling { mut store, order, .. } = filling;
    store.note_order();
    if measure(team, &store) {
        // A mean ratio of 0 may also be one that is too small for a number: the exact test decides.
        check_positive(mesh)?;
    }
    Ok(Filled { store, unprojected, ids: order.vertex_ids })
}

fn check_positive(mesh: &TetMesh) -> Result<(), Error> {
    let inverted = |nodes: &[u32; 4]| !is_positive(nodes.map(|v| mesh.vertices[v as usize]));
    let mut bad = mesh.tets.nodes.iter().enumerate().filter(|(_, nodes)| inverted(nodes));
    match bad.next() {
        Some((tet, nodes)) => Err(Error::Inverted { tet: tet + 1, nodes: nodes.map(|v| v + 1), others: bad.count() }),
        None => Ok(()),
    }
}

/// A store that is being filled.
struct Filling<'a> {
    team: Team<'a>,
    mesh: &'a TetMesh,
    place: &'a Classification,
    order: Numbering,
    store: Store,
}

impl Filling<'_> {
    fn id(&self, v: u32) -> VertexId {
        self.order.vertex_ids[v as usize]
    }

    /// Calls f with each vertex by its id and by its number in the mesh.
    fn each_vertex(&self, f: impl Fn(VertexId, usize) + Sync) {
        self.team.for_each(GRAIN, self.order.vertices.len(), |range| {
            range.for_each(|id| f(VertexId(id as u32), self.order.vertices[id] as usize));
        });
    }

    /// Sets position and place.
    fn write_vertices(&self) {
        self.store.take_vertices(self.order.vertices.len()).expect("room was made");
        self.each_vertex(|id, v| {
            self.store.set_position(id, self.place.projected[v]);
            self.store.set_place(id, self.place.entities[v], self.place.parameters[v]);
        });
    }

    /// Sets vertices and neighbours, and the first of each vertex's tetrahedra.
    fn write_tets(&self, faces: &MatchedFaces) {
        self.store.take_tets(self.order.tets.len()).expect("room was made");
        self.team.for_each(GRAIN, self.order.tets.len(), |range| {
            for id in range {
                let (t, id) = (self.order.tets[id] as usize, TetId(id as u32));
                let vertices = self.mesh.tets.nodes[t].map(|v| self.id(v));
                self.store.write_tet(id, vertices, self.mesh.tets.refs[t] as u32, 1.0);
                for (i, &n) in faces.neighbours[t].iter().enumerate().filter(|(_, n)| **n != NONE) {
                    self.store.set_neighbour(id, i, self.order.tet_ids[n as usize]);
                }
                vertices.iter().for_each(|&v| self.store.offer_tet(v, id));
            }
        });
    }

    /// Sets the tags of faces with a triangle.
    ///
    /// # Errors
    /// When a face on the boundary has none, unless the mesh is a part of a larger one.
    fn tag_faces(&self, faces: &MatchedFaces, is_part: bool) -> Result<(), Error> {
        let triangles = TriangleIndex::new(self.team, &self.mesh.triangles.nodes, self.mesh.vertices.len());
        for Side { triangle, tet, face } in triangles.sides(self.team, &self.mesh.tets.nodes) {
            let (id, tag) = (self.order.tet_ids[tet as usize], self.place.faces[triangle as usize] + 1);
            let before = self.store.tags(id)[face as usize];
            self.store.set_tag(id, face as usize, if before == 0 { tag } else { tag.min(before) });
        }
        if is_part {
            return Ok(());
        }
        let nodes = &self.mesh.tets.nodes;
        let open = self.team.collect(GRAIN, nodes.len(), |range, found| {
            for t in range.filter(|&t| faces.neighbours[t].contains(&NONE)) {
                let tags = self.store.tags(self.order.tet_ids[t]);
                let open = (0..4).find(|&i| faces.neighbours[t][i] == NONE && tags[i] == 0);
                found.extend(open.map(|open| sorted3(FACES[open].map(|k| nodes[t][k]))));
            }
        });
        match open.first() {
            Some(nodes) => Err(Error::Open { nodes: nodes.map(|v| v + 1) }),
            None => Ok(()),
        }
    }

    /// Sets the ridge neighbours of vertices on model edges and of corners.
    fn join_ridges(&mut self) {
        let mut ends: Vec<(VertexId, VertexId, u32)> = Vec::with_capacity(2 * self.place.ridges.len());
        for &([a, b], curve) in &self.place.ridges {
            let (a, b) = (self.id(a), self.id(b));
            ends.extend([(a, b, curve), (b, a, curve)]);
        }
        ends.sort_unstable();
        for at_vertex in ends.chunk_by(|x, y| x.0 == y.0) {
            let v = at_vertex[0].0;
            match self.store.entity(v) {
                Entity::Edge(_) => {
                    let other = |k: usize| at_vertex.get(k).map_or(VertexId::NONE, |&(_, b, _)| b);
                    self.store.set_ridge(v, [other(0), other(1)]);
                }
                _ => self.store.set_corner(v, at_vertex.iter().map(|&(_, b, curve)| (b, curve)).collect()),
            }
        }
        // A corner without a ridge (a required vertex on a face) still needs its empty list. A part of a larger mesh may have a vertex on a
        // model edge and none of the ridges at it.
        for (entity, &v) in self.place.entities.iter().zip(&self.order.vertex_ids) {
            let is_alone = || ends.binary_search_by_key(&v, |end| end.0).is_err();
            match entity {
                Entity::Vertex(_) if is_alone() => self.store.set_corner(v, Vec::new()),
                Entity::Edge(_) if is_alone() => self.store.set_ridge(v, [VertexId::NONE; 2]),
                _ => {}
            }
        }
    }

    /// Where projected points invert a tetrahedron, its vertices go back to where they were. Returns these vertices.
    fn leave_inverting(&self) -> Vec<VertexId> {
        let before = |v: VertexId| -> Vec3 { self.mesh.vertices[self.order.vertices[v.index()] as usize] };
        let is_moved = |v: VertexId| self.store.position(v) != before(v);
        let moved = self.team.map(GRAIN, self.order.vertices.len(), |v| is_moved(VertexId(v as u32)));
        let mut unprojected = Vec::new();
        if !moved.contains(&true) {
            return unprojected;
        }
        let is_bad = |vertices: [VertexId; 4]| !is_positive(vertices.map(|v| self.store.position(v)));
        loop {
            let bad = self.team.collect(GRAIN, self.store.tet_bound(), |range, bad| {
                let vertices = self.store.live_tets_in(range).map(|t| self.store.vertices(t));
                bad.extend(vertices.filter(|of| of.iter().any(|v| moved[v.index()]) && is_bad(*of)));
            });
            let many = unprojected.len();
            // Vertices that went back for another tetrahedron may have set this one right.
            for vertices in bad.into_iter().filter(|&of| is_bad(of)) {
                for v in vertices.into_iter().filter(|&v| is_moved(v)) {
                    self.store.set_position(v, before(v));
                    unprojected.push(v);
                }
            }
            if unprojected.len() == many {
                return unprojected;
            }
        }
    }

    /// Where the boundary would pass through itself because of projected points, these go back to where they were; whether there were such.
    fn leave_crossing(&self, faces: &MatchedFaces, unprojected: &mut Vec<VertexId>) -> bool {
        let before = |v: VertexId| -> Vec3 { self.mesh.vertices[self.order.vertices[v.index()] as usize] };
        let is_moved = |v: VertexId| self.store.position(v) != before(v);
        let walls = self.team.collect(GRAIN, self.mesh.tets.len(), |range, walls| {
            for t in range {
                let open = (0..4).filter(|&i| faces.neighbours[t][i] == NONE);
                walls.extend(open.map(|i| FACES[i].map(|k| self.id(self.mesh.tets.nodes[t][k]).0)));
            }
        });
        let at = |v| self.store.position(VertexId(v));
        // What moves by less than a triangle draws back cannot bring it through another: most meshes are on their model to rounding.
        let is_asked = |i: usize| {
            let [a, b, c] = walls[i].map(at);
            let size = distance(a, b).max(distance(a, c));
            walls[i].into_iter().any(|v| distance(at(v), before(VertexId(v))) > DRAWN_BACK * size)
        };
        let crossings = crossings_of(self.team, &walls, at, is_asked, crossing, usize::MAX);
        let many = unprojected.len();
        for v in crossings.first.iter().flat_map(|crossing| crossing.triangles).flat_map(|i| walls[i].map(VertexId)) {
            if is_moved(v) {
                self.store.set_position(v, before(v));
                unprojected.push(v);
            }
        }
        unprojected.len() > many
    }

    /// Gives every vertex its metric: the known one where the vertex is at its place in the mesh, else the source's.
    fn set_metrics(&self, source: &Source, logs: Option<&[Sym3]>, hints: Option<&[u32]>) {
        self.each_vertex(|v, old| {
            // A vertex of no tetrahedron.
            if !self.store.is_vertex(v) {
                return;
            }
            let p = self.store.position(v);
            let mut hint = match hints {
                Some(hints) => hints[old],
                None => self.order.tets[self.store.tet_of(v).index()],
            };
            let log = match logs {
                Some(logs) if p == self.mesh.vertices[old] => logs[old],
                _ => source.log_at(p, &mut hint),
            };
            self.store.set_metric(v, &log, &log.exp());
            self.store.set_hint(v, hint);
        });
    }
}

/// Gives every tetrahedron its mean ratio. Returns whether one of them is 0, as for an inverted or flat tetrahedron.
pub fn measure(team: Team<'_>, store: &Store) -> bool {
    let corners = |t: TetId| {
        let vertices = store.vertices(t);
        (vertices.map(|v| store.position(v)), vertices.map(|v| store.log(v)))
    };
    let zeros = team.chunks(GRAIN, store.tet_bound(), |range| {
        let mut zero = false;
        mean_ratios(store.live_tets_in(range), corners, |t, ratio| {
            zero |= ratio == 0.0;
            store.set_quality(t, ratio);
        });
        zero
    });
    zeros.contains(&true)
}
