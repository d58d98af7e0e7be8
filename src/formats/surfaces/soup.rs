//! Polygons with points of their own, or numbered ones, to triangles with common vertices.
use super::super::error;
use crate::mesh::TetMesh;
use crate::mesh::io::{Error, Read};
use crate::mesh::vector::Vec3;
use std::collections::HashMap;
use std::path::Path;

/// Triangles that are being gathered.
#[derive(Default)]
pub struct Soup {
    mesh: TetMesh,
    /// The vertex at each point, by the bits of its coordinates.
    at: HashMap<[u64; 3], u32>,
    /// Polygons of less than three vertices.
    dropped: usize,
}

impl Soup {
    /// The vertex at a point; `place` is what an error says.
    pub fn vertex(&mut self, path: &Path, place: impl Fn() -> String, point: Vec3) -> Result<u32, Error> {
        if point.iter().any(|x| !x.is_finite()) {
            return Err(error::at(path, place(), "a coordinate is no finite number"));
        }
        // −0 is 0.
        let point = point.map(|x| x + 0.0);
        let next = self.mesh.vertices.len() as u32;
        let vertex = *self.at.entry(point.map(f64::to_bits)).or_insert(next);
        if vertex == next {
            self.mesh.vertices.push(point);
            self.mesh.vertex_refs.push(0);
        }
        Ok(vertex)
    }

    /// A polygon, as a fan of triangles; those that have a vertex twice go.
    pub fn polygon(&mut self, vertices: &[u32], reference: i32) {
        let before = self.mesh.triangles.len();
        for pair in vertices.get(1..).unwrap_or_default().windows(2) {
            let nodes = [vertices[0], pair[0], pair[1]];
            if nodes[0] != nodes[1] && nodes[1] != nodes[2] && nodes[2] != nodes[0] {
                self.mesh.triangles.push(nodes, reference);
            }
        }
        self.dropped += usize::from(self.mesh.triangles.len() == before);
    }

    /// What was gathered.
    pub fn finish(self, path: &Path) -> Read<TetMesh> {
        let mut notices = Vec::new();
        if self.dropped > 0 {
            notices.push(format!("{}: {} facets without area were left out", path.display(), self.dropped));
        }
        Read { content: self.mesh, notices }
    }
}
