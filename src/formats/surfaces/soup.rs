//! Polygons with points of their own, or numbered ones, to triangles with common vertices.
use super::super::sets::{Kind, Meaning};
use super::super::{Dataset, error};
use crate::geometry::{Label, Names};
use crate::mesh::TetMesh;
use crate::mesh::io::{Error, Read};
use crate::mesh::vector::Vec3;
use std::collections::{BTreeSet, HashMap};
use std::path::Path;

/// Triangles that are being gathered.
#[derive(Default)]
pub struct Soup {
    mesh: TetMesh,
    /// The vertex at each point, by the bits of its coordinates.
    at: HashMap<[u64; 3], u32>,
    /// References of groups, by what the file calls them.
    groups: HashMap<String, i32>,
    names: Names,
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

    /// The reference of a group with this name: the number in a name that we give to what has none, else the next one from 1 on. `key` tells
    /// groups apart.
    pub fn group(&mut self, key: &str, name: &str) -> i32 {
        if let Some(&known) = self.groups.get(key) {
            return known;
        }
        let used: BTreeSet<i32> = self.groups.values().copied().collect();
        let number = name.strip_prefix(Kind::Triangles.unnamed()).and_then(|rest| rest.strip_prefix('_'));
        let number = number.and_then(|number| number.parse().ok()).filter(|number| !used.contains(number));
        let reference = number.or_else(|| (1..).find(|next| !used.contains(next))).unwrap_or(i32::MAX);
        self.groups.insert(key.to_owned(), reference);
        if number.is_none() && !name.is_empty() {
            self.call(reference, Some(name.to_owned()));
        }
        reference
    }

    /// The reference that a comment of ours tells, which is called as it says.
    pub fn noted(&mut self, key: &str, noted: Meaning) -> i32 {
        self.groups.insert(key.to_owned(), noted.reference);
        self.call(noted.reference, noted.name);
        noted.reference
    }

    /// Gives a reference its name.
    pub fn call(&mut self, reference: i32, name: Option<String>) {
        if name.is_some() {
            self.names.triangles.insert(reference, Label { name, colour: None });
        }
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

    /// What was gathered, with the names of what there is.
    pub fn finish(mut self, path: &Path) -> Read<Dataset> {
        let mut notices = Vec::new();
        if self.dropped > 0 {
            notices.push(format!("{}: {} facets without area were left out", path.display(), self.dropped));
        }
        let used: BTreeSet<i32> = self.mesh.triangles.refs.iter().copied().collect();
        self.names.triangles.retain(|reference, _| used.contains(reference));
        Read { content: Dataset { mesh: self.mesh, names: self.names, ..Dataset::default() }, notices }
    }
}
