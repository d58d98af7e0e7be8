//! Wavefront OBJ: points and polygons; groups are references.
use super::super::sets::{Kind, Meaning};
use super::super::{Dataset, error};
use super::soup::Soup;
use crate::mesh::io::{Error, Read};
use std::path::Path;

/// Reads `v` and `f`; what `g`, `o` and `usemtl` name gives references from 1 on, in their order, but for groups of our own files.
pub fn read(path: &Path, bytes: &[u8]) -> Result<Read<Dataset>, Error> {
    let text = String::from_utf8_lossy(bytes);
    let mut soup = Soup::default();
    let (mut points, mut polygon) = (Vec::new(), Vec::new());
    let (mut reference, mut noted) = (1, None);
    for (line, words) in text.lines().enumerate() {
        let place = || format!("line {}", line + 1);
        let wrong = |message: String| error::at(path, place(), message);
        let mut parts = words.split_ascii_whitespace();
        match parts.next() {
            Some("v") => {
                let mut point = [0.0; 3];
                for x in &mut point {
                    let word = parts.next().ok_or_else(|| wrong("a point has three coordinates".into()))?;
                    *x = word.parse().map_err(|_| wrong(format!("'{}' is no number", error::short(word))))?;
                }
                points.push(soup.vertex(path, place, point)?);
            }
            Some("f") => {
                polygon.clear();
                for word in parts {
                    let number = word.split('/').next().unwrap_or_default();
                    let vertex = number.parse::<i64>().ok().and_then(|number| {
                        // Negative ones count back from the last point.
                        let index = if number < 0 { points.len() as i64 + number } else { number - 1 };
                        usize::try_from(index).ok().and_then(|index| points.get(index))
                    });
                    polygon.push(*vertex.ok_or_else(|| wrong(format!("there is no point '{}'", error::short(word))))?);
                }
                soup.polygon(&polygon, reference);
            }
            Some(word @ ("g" | "o" | "usemtl")) => {
                let name = words.trim_start()[word.len()..].trim();
                reference = match noted.take() {
                    Some(noted) => soup.noted(words, noted),
                    None => soup.group(words, name),
                };
            }
            Some("#") => {
                let meaning = words.trim_start().strip_prefix('#').and_then(Meaning::noted);
                noted = meaning.filter(|meaning| meaning.kind == Kind::Triangles).or(noted);
            }
            _ => {}
        }
    }
    Ok(soup.finish(path))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polygons_are_fans_and_groups_references() {
        let text = "# a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 0\nusemtl a\nf 1/1/1 2 3 4\nusemtl b\nf -1 -2 -3//2\nf 1 1 2\n";
        let read = read(Path::new("a.obj"), text.as_bytes()).unwrap();
        assert_eq!(read.content.names.triangles[&2].name.as_deref(), Some("b"));
        let mesh = read.content.mesh;
        assert_eq!(mesh.vertices.len(), 4, "equal points are one vertex");
        assert_eq!(mesh.triangles.nodes, [[0, 1, 2], [0, 2, 3], [0, 3, 2]]);
        assert_eq!(mesh.triangles.refs, [1, 1, 2]);
        assert_eq!(read.notices.len(), 1, "the facet without area is told");
    }

    #[test]
    fn damaged_files_are_told_with_the_line() {
        for (text, word) in
            [("v 1 2\n", "line 1"), ("v 1 2 z\n", "'z'"), ("v 1 2 3\nf 1 2 3\n", "no point '2'"), ("f 0 0 0", "line 1")]
        {
            let error = read(Path::new("a.obj"), text.as_bytes()).unwrap_err().to_string();
            assert!(error.contains(word), "{error}");
        }
    }
}
