//! The meshes of meshers: gmsh's MSH 4.1 as text, of points, lines, triangles and tetrahedra of the first order.
//! Source: gmsh's reference manual, "MSH file format".
use super::Error;
use crate::mesh::vector::volume6;
use crate::mesh::{OnEdge, OnFace, OnVertex, TetMesh};
use std::collections::HashMap;
use std::path::Path;
use std::str::{FromStr, SplitAsciiWhitespace};

/// Reads a mesh. References are the numbers (tags) of the model's edges, faces and solids; the association is that of the nodes that
/// were written on entities, with their parameters where there are any. Nodes that no tetrahedron has are left out, and where most
/// tetrahedra are negative all are turned.
///
/// # Errors
/// [`Error::System`] when the file cannot be read, [`Error::Content`] when it is no such file.
pub fn read_msh(path: &Path) -> Result<TetMesh, Error> {
    let text = std::fs::read_to_string(path).map_err(|e| Error::system(path, e))?;
    let mut reader = Reader { path, lines: text.lines(), line: 0, mesh: TetMesh::default(), of_tag: HashMap::new() };
    reader.read()?;
    let mut mesh = compact(reader.mesh);
    turn(&mut mesh);
    Ok(mesh)
}

struct Reader<'a> {
    path: &'a Path,
    lines: std::str::Lines<'a>,
    /// Number of the last line that was taken.
    line: usize,
    mesh: TetMesh,
    of_tag: HashMap<u64, u32>,
}

/// The words of a line.
type Words<'a> = SplitAsciiWhitespace<'a>;

impl<'a> Reader<'a> {
    fn fail(&self, message: impl Into<String>) -> Error {
        Error::content(self.path, format!("line {}", self.line), message)
    }

    /// The next line; an error at the end of the file.
    fn next(&mut self) -> Result<&'a str, Error> {
        self.line += 1;
        self.lines.next().ok_or_else(|| self.fail("the file is cut off"))
    }

    fn word<T: FromStr>(&self, words: &mut Words) -> Result<T, Error> {
        let word = words.next().ok_or_else(|| self.fail("a value is missing"))?;
        word.parse().map_err(|_| self.fail(format!("`{word}` is no value that can stand here")))
    }

    /// The values of the next line.
    fn row<T: FromStr + Copy + Default, const N: usize>(&mut self) -> Result<[T; N], Error> {
        let mut words = self.next()?.split_ascii_whitespace();
        let mut row = [T::default(); N];
        for value in &mut row {
            *value = self.word(&mut words)?;
        }
        Ok(row)
    }

    fn read(&mut self) -> Result<(), Error> {
        let mut version = false;
        while let Some(line) = self.lines.next() {
            self.line += 1;
            match line.trim() {
                "$MeshFormat" => {
                    let words: Vec<_> = self.next()?.split_ascii_whitespace().collect();
                    if words.first() != Some(&"4.1") || words.get(1) != Some(&"0") {
                        return Err(self.fail("a mesh of MSH version 4.1, as text, is expected"));
                    }
                    version = true;
                }
                "$Nodes" if version => self.nodes()?,
                "$Elements" if version => self.elements()?,
                _ => {}
            }
        }
        if self.mesh.tets.is_empty() { Err(self.fail("no tetrahedra in it")) } else { Ok(()) }
    }

    fn nodes(&mut self) -> Result<(), Error> {
        let [blocks, ..] = self.row::<u64, 4>()?;
        let mut tags = Vec::new();
        for _ in 0..blocks {
            let [dimension, entity, parametric, count] = self.row::<i64, 4>()?;
            tags.clear();
            for _ in 0..count {
                let [tag] = self.row::<u64, 1>()?;
                tags.push(tag);
            }
            for &tag in &tags {
                self.node(tag, dimension, entity as i32, parametric != 0)?;
            }
        }
        Ok(())
    }

    fn node(&mut self, tag: u64, dimension: i64, id: i32, parametric: bool) -> Result<(), Error> {
        let mut words = self.next()?.split_ascii_whitespace();
        let mut point = [0.0_f64; 3];
        for x in &mut point {
            *x = self.word(&mut words)?;
        }
        if !point.iter().all(|x| x.is_finite()) {
            return Err(self.fail("a coordinate is not finite"));
        }
        let vertex = self.mesh.vertices.len() as u32;
        self.mesh.vertices.push(point);
        self.mesh.vertex_refs.push(0);
        if self.of_tag.insert(tag, vertex).is_some() {
            return Err(self.fail(format!("node {tag} is there twice")));
        }
        let to = &mut self.mesh.association;
        let mut parameter = || words.next().filter(|_| parametric).and_then(|word| word.parse().ok());
        match dimension {
            0 => to.vertices.push(OnVertex { vertex, id }),
            1 => to.edges.extend(parameter().map(|t| OnEdge { vertex, id, t, r: 0.0 })),
            2 => {
                let uv = parameter().zip(parameter());
                to.faces.extend(uv.map(|(u, v)| OnFace { vertex, id, uv: [u, v], r: 0.0 }));
            }
            _ => {}
        }
        Ok(())
    }

    fn elements(&mut self) -> Result<(), Error> {
        let [blocks, ..] = self.row::<u64, 4>()?;
        for _ in 0..blocks {
            let [_, entity, kind, count] = self.row::<i64, 4>()?;
            let entity = entity as i32;
            for _ in 0..count {
                match kind {
                    1 => {
                        let nodes = self.element()?;
                        self.mesh.edges.push(nodes, entity);
                    }
                    2 => {
                        let nodes = self.element()?;
                        self.mesh.triangles.push(nodes, entity);
                    }
                    4 => {
                        let nodes = self.element()?;
                        self.mesh.tets.push(nodes, entity);
                    }
                    15 => drop(self.next()?),
                    _ => {
                        return Err(
                            self.fail(format!("elements of type {kind}: only simplices of the first order are read"))
                        );
                    }
                }
            }
        }
        Ok(())
    }

    fn element<const N: usize>(&mut self) -> Result<[u32; N], Error> {
        let mut words = self.next()?.split_ascii_whitespace();
        let _: u64 = self.word(&mut words)?;
        let mut nodes = [0; N];
        for node in &mut nodes {
            let tag: u64 = self.word(&mut words)?;
            *node = *self.of_tag.get(&tag).ok_or_else(|| self.fail(format!("there is no node {tag}")))?;
        }
        Ok(nodes)
    }
}

/// The mesh without the nodes that no tetrahedron has, and without what is on these.
fn compact(mut mesh: TetMesh) -> TetMesh {
    let mut number = vec![u32::MAX; mesh.vertices.len()];
    mesh.tets.nodes.iter().flatten().for_each(|&v| number[v as usize] = 0);
    let mut count = 0;
    for number in number.iter_mut().filter(|number| **number == 0) {
        *number = count;
        count += 1;
    }
    let mut kept = number.iter().map(|&number| number != u32::MAX);
    mesh.vertices.retain(|_| kept.next() == Some(true));
    mesh.vertex_refs.truncate(count as usize);
    let is_kept = |v: u32| number[v as usize] != u32::MAX;
    let renumber = |v: &mut u32| *v = number[*v as usize];
    mesh.tets.nodes.iter_mut().flatten().for_each(renumber);
    keep(&mut mesh.triangles, &number);
    keep(&mut mesh.edges, &number);
    let association = &mut mesh.association;
    association.vertices.retain(|on| is_kept(on.vertex));
    association.edges.retain(|on| is_kept(on.vertex));
    association.faces.retain(|on| is_kept(on.vertex));
    let vertices = association.vertices.iter_mut().map(|on| &mut on.vertex);
    let edges = association.edges.iter_mut().map(|on| &mut on.vertex);
    vertices.chain(edges).chain(association.faces.iter_mut().map(|on| &mut on.vertex)).for_each(renumber);
    mesh
}

/// The elements whose nodes are all kept, with their new numbers.
fn keep<const N: usize>(elements: &mut crate::mesh::Elements<N>, number: &[u32]) {
    let mut kept = crate::mesh::Elements::default();
    for (nodes, reference) in elements.iter() {
        let nodes = nodes.map(|v| number[v as usize]);
        if !nodes.contains(&u32::MAX) {
            kept.push(nodes, reference);
        }
    }
    *elements = kept;
}

/// Turns all tetrahedra where most are negative: programs number them either way.
fn turn(mesh: &mut TetMesh) {
    let points = &mesh.vertices;
    let is_negative = |nodes: &&[u32; 4]| {
        let [a, b, c, d] = nodes.map(|v| points[v as usize]);
        volume6(a, b, c, d) < 0.0
    };
    if 2 * mesh.tets.nodes.iter().filter(is_negative).count() > mesh.tets.len() {
        mesh.tets.nodes.iter_mut().for_each(|nodes| nodes.swap(0, 1));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n5 6 1 9\n0 2 0 1\n9\n0 0 0\n1 4 1 1\n1\n1 0 0 0.25\n\
        2 3 1 1\n2\n0 1 0 0.5 0.75\n3 1 0 2\n3\n4\n0 0 1\n1 1 1\n2 7 0 1\n6\n7 7 7\n$EndNodes\n$Elements\n4 4 1 5\n0 2 15 1\n1 9\n\
        1 4 1 1\n2 9 1\n2 3 2 1\n3 9 1 2\n3 1 4 2\n4 1 9 2 3\n5 1 2 3 4\n$EndElements\n";

    fn read(text: &str) -> Result<TetMesh, Error> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.msh");
        std::fs::write(&path, text).unwrap();
        read_msh(&path)
    }

    #[test]
    fn nodes_come_with_their_entities_and_loose_ones_go() {
        let mesh = read(FILE).unwrap();
        assert_eq!(mesh.vertices, [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0; 3]]);
        assert_eq!(mesh.association.vertices, [OnVertex { vertex: 0, id: 2 }]);
        assert_eq!(mesh.association.edges, [OnEdge { vertex: 1, id: 4, t: 0.25, r: 0.0 }]);
        assert_eq!(mesh.association.faces, [OnFace { vertex: 2, id: 3, uv: [0.5, 0.75], r: 0.0 }]);
        assert_eq!((mesh.edges.nodes[0], mesh.edges.refs[0]), ([0, 1], 4));
        assert_eq!((mesh.triangles.nodes[0], mesh.triangles.refs[0]), ([0, 1, 2], 3));
        // One is negative and one positive: neither is turned.
        assert_eq!(mesh.tets.nodes, [[1, 0, 2, 3], [1, 2, 3, 4]]);
    }

    #[test]
    fn a_mesh_of_negative_tetrahedra_is_turned() {
        let mesh = read(&FILE.replace("3 1 4 2\n4 1 9 2 3\n5 1 2 3 4", "3 1 4 1\n4 1 9 2 3")).unwrap();
        assert_eq!(mesh.tets.nodes, [[0, 1, 2, 3]]);
    }

    #[test]
    fn what_is_wrong_is_named_by_its_line() {
        let message = |from: &str, to: &str| read(&FILE.replacen(from, to, 1)).unwrap_err().to_string();
        assert!(message("4.1 0 8", "2.2 0 8").contains("line 2: a mesh of MSH version 4.1"));
        assert!(message("4 1 9 2 3", "4 1 9 2 77").contains("there is no node 77"));
        assert!(message("4 1 9 2 3", "4 1 9 2").contains("a value is missing"));
        assert!(message("4 1 9 2 3", "4 1 9 2 x").contains("`x` is no value"));
        assert!(message("3 1 4 2\n", "3 1 5 2\n").contains("elements of type 5"));
        assert!(message("5 1 2 3 4\n$EndElements\n", "").contains("cut off"));
        assert!(message("3\n4\n0 0 1", "3\n3\n0 0 1").contains("node 3 is there twice"));
    }
}
