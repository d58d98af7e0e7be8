//! What the store holds of tetrahedra.
use super::super::ids::{TetId, VertexId};
use super::Store;
use std::sync::atomic::Ordering::Relaxed;

impl Store {
    /// The four vertices.
    #[inline(always)]
    pub fn vertices(&self, t: TetId) -> [VertexId; 4] {
        self.must_hold_one_of(t);
        self.unlocked_vertices(t)
    }

    /// Reads the vertices of a tetrahedron without holding one. It may be dead, or be half overwritten by another one.
    /// Only for a vertex that the reader holds the answer is certain: then the record has it exactly when the tetrahedron is alive and
    /// has it, since whoever writes or clears the record holds both its old and its new vertices.
    #[inline(always)]
    pub fn unlocked_vertices(&self, t: TetId) -> [VertexId; 4] {
        let record = &self.tets[t.index()].vertices;
        std::array::from_fn(|i| VertexId(record[i].load(Relaxed)))
    }

    /// The neighbour opposite each vertex.
    #[inline(always)]
    pub fn neighbours(&self, t: TetId) -> [TetId; 4] {
        self.must_hold_one_of(t);
        let record = &self.tets[t.index()].neighbours;
        std::array::from_fn(|i| TetId(record[i].load(Relaxed)))
    }

    /// The neighbour opposite local vertex i.
    #[inline(always)]
    pub fn neighbour(&self, t: TetId, i: usize) -> TetId {
        self.must_hold_one_of(t);
        TetId(self.tets[t.index()].neighbours[i].load(Relaxed))
    }

    /// Sets the neighbour opposite local vertex i.
    #[inline(always)]
    pub(in crate::adapt::core) fn set_neighbour(&self, t: TetId, i: usize, n: TetId) {
        self.must_own_face(t, i);
        self.tets[t.index()].neighbours[i].store(n.0, Relaxed);
    }

    /// The tag of each face: 0, or the model face counted from 1. A face with neither a tag nor a neighbour is one to another part of a
    /// larger mesh; as any change of the mesh keeps the faces of its cavity, it stays.
    #[inline(always)]
    pub fn tags(&self, t: TetId) -> [u32; 4] {
        self.must_hold_one_of(t);
        let record = &self.tets[t.index()].tags;
        std::array::from_fn(|i| record[i].load(Relaxed))
    }

    /// Whether the face opposite local vertex i is on the boundary, between regions, or a face to another part of a larger mesh.
    #[inline(always)]
    pub fn is_surface(&self, t: TetId, i: usize) -> bool {
        self.tags(t)[i] != 0 || !self.neighbour(t, i).is_some()
    }

    /// Sets the tag of the face opposite local vertex i.
    #[inline(always)]
    pub(in crate::adapt::core) fn set_tag(&self, t: TetId, i: usize, tag: u32) {
        self.must_own_face(t, i);
        self.tets[t.index()].tags[i].store(tag, Relaxed);
    }

    /// The region.
    #[inline(always)]
    pub fn region(&self, t: TetId) -> u32 {
        self.must_hold_one_of(t);
        self.tets[t.index()].region.load(Relaxed)
    }

    /// Whether a surface triangle between t and `behind` is listed from t. An interface is met from both sides: it is listed from its lesser
    /// region, so that the triangles about a vertex look to one side.
    #[inline(always)]
    pub fn lists_triangle(&self, t: TetId, behind: TetId) -> bool {
        !behind.is_some() || (self.region(t), t) < (self.region(behind), behind)
    }

    /// The mean ratio kept with the tetrahedron.
    #[inline(always)]
    pub fn quality(&self, t: TetId) -> f64 {
        self.must_hold_one_of(t);
        f64::from(f32::from_bits(self.tets[t.index()].quality.load(Relaxed)))
    }

    /// Sets the kept mean ratio.
    #[inline(always)]
    pub(in crate::adapt::core) fn set_quality(&self, t: TetId, quality: f64) {
        self.must_own_tet(t);
        self.tets[t.index()].quality.store((quality as f32).to_bits(), Relaxed);
    }

    /// When the tetrahedron, or one of its vertices, last changed.
    #[inline(always)]
    pub fn stamp(&self, t: TetId) -> u32 {
        self.must_hold_one_of(t);
        self.tets[t.index()].stamp.load(Relaxed)
    }

    /// When the tetrahedron last changed, or one of its vertices moved, even by a little.
    #[inline(always)]
    pub fn moved(&self, t: TetId) -> u32 {
        self.must_hold_one_of(t);
        self.tets[t.index()].moved.load(Relaxed)
    }

    /// Stamps the tetrahedron with the present time.
    #[inline(always)]
    pub(in crate::adapt::core) fn touch(&self, t: TetId) {
        self.touch_moved(t);
        self.tets[t.index()].stamp.store(self.clock.load(Relaxed), Relaxed);
    }

    /// Notes that a vertex of the tetrahedron moved a little.
    #[inline(always)]
    pub(in crate::adapt::core) fn touch_moved(&self, t: TetId) {
        self.must_own_tet(t);
        self.tets[t.index()].moved.store(self.clock.load(Relaxed), Relaxed);
    }

    /// Writes vertices, region and quality, without neighbours and tags.
    #[inline]
    pub(in crate::adapt::core) fn write_tet(&self, t: TetId, vertices: [VertexId; 4], region: u32, quality: f64) {
        self.must_own_tet(t);
        let record = &self.tets[t.index()];
        for i in 0..4 {
            record.vertices[i].store(vertices[i].0, Relaxed);
            record.neighbours[i].store(TetId::NONE.0, Relaxed);
            record.tags[i].store(0, Relaxed);
        }
        self.must_own_tet(t);
        record.region.store(region, Relaxed);
        self.set_quality(t, quality);
        self.touch(t);
    }

    /// Replaces local vertex i by another.
    #[inline]
    pub(in crate::adapt::core) fn set_vertex(&self, t: TetId, i: usize, v: VertexId) {
        self.must_own_tet(t);
        self.tets[t.index()].vertices[i].store(v.0, Relaxed);
        self.must_own_tet(t);
    }

    /// Marks a tetrahedron dead.
    #[inline]
    pub(in crate::adapt::core) fn kill_tet(&self, t: TetId) {
        self.must_own_tet(t);
        self.clear_tet(t);
    }

    /// Clears all four vertices, so that a thread that holds one of them and has an old id does not find it here.
    #[inline]
    pub(super) fn clear_tet(&self, t: TetId) {
        for slot in &self.tets[t.index()].vertices {
            slot.store(VertexId::NONE.0, Relaxed);
        }
    }

    /// Whether the tetrahedron is alive.
    #[inline(always)]
    pub fn is_tet(&self, t: TetId) -> bool {
        self.tets[t.index()].vertices[0].load(Relaxed) != VertexId::NONE.0
    }
}
