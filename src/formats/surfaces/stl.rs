//! STL, binary and text.
use super::super::{Dataset, error};
use super::soup::Soup;
use crate::mesh::io::{Error, Read};
use std::path::Path;

/// Bytes before the facets of a binary file, and of a facet.
const HEAD: usize = 84;
const FACET: usize = 50;

/// Reads facets; their own normals are not looked at. The solids of a text are references from 1 on, called as they are.
pub fn read(path: &Path, bytes: &[u8]) -> Result<Read<Dataset>, Error> {
    let count = bytes.get(80..HEAD).and_then(|bytes| bytes.try_into().ok()).map(u32::from_le_bytes);
    // Binary files may begin with the word of text files: their length tells.
    match count {
        Some(count) if bytes.len() as u64 == HEAD as u64 + FACET as u64 * u64::from(count) => binary(path, bytes),
        _ if bytes.trim_ascii_start().starts_with(b"solid") && !bytes.contains(&0) => text(path, bytes),
        Some(count) => Err(error::at(
            path,
            "bytes 80 to 83",
            format!("{count} facets are announced, but the file has {} bytes; is it cut off?", bytes.len()),
        )),
        None => Err(error::at(path, "the beginning", "no STL file: neither text that begins with solid nor binary")),
    }
}

fn binary(path: &Path, bytes: &[u8]) -> Result<Read<Dataset>, Error> {
    let mut soup = Soup::default();
    for (k, facet) in bytes[HEAD..].chunks_exact(FACET).enumerate() {
        let number = |i: usize| f64::from(f32::from_le_bytes(std::array::from_fn(|b| facet[4 * i + b])));
        let mut corners = [0; 3];
        for (i, corner) in corners.iter_mut().enumerate() {
            let point = [0, 1, 2].map(|axis| number(3 + 3 * i + axis));
            *corner = soup.vertex(path, || format!("facet {}", k + 1), point)?;
        }
        soup.polygon(&corners, 1);
    }
    Ok(soup.finish(path))
}

fn text(path: &Path, bytes: &[u8]) -> Result<Read<Dataset>, Error> {
    let text = String::from_utf8_lossy(bytes);
    let mut soup = Soup::default();
    let mut corners = Vec::new();
    let mut reference = 1;
    for (line, whole) in text.lines().enumerate() {
        let mut words = whole.split_ascii_whitespace();
        let wrong = |message: &str| error::at(path, format!("line {}", line + 1), message);
        match words.next().map(str::to_ascii_lowercase).as_deref() {
            Some("solid") => {
                let name = whole.trim_start()["solid".len()..].trim();
                reference = soup.group(name, name);
            }
            Some("vertex") => {
                let mut point = [0.0; 3];
                for x in &mut point {
                    let word = words.next().ok_or_else(|| wrong("a vertex has three coordinates"))?;
                    *x = word.parse().map_err(|_| wrong(&format!("'{}' is no number", error::short(word))))?;
                }
                corners.push(soup.vertex(path, || format!("line {}", line + 1), point)?);
            }
            Some("endloop") => {
                soup.polygon(&corners, reference);
                corners.clear();
            }
            _ => {}
        }
    }
    if !corners.is_empty() {
        return Err(error::at(path, "the end", "the last facet is not closed; is the file cut off?"));
    }
    Ok(soup.finish(path))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn facets() -> Vec<[[f32; 3]; 3]> {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]].map(|nodes: [usize; 3]| nodes.map(|v| corners[v])).to_vec()
    }

    #[test]
    fn text_and_binary_are_the_same_mesh() {
        let path = Path::new("a.stl");
        let mut bytes = b"solid but binary".to_vec();
        bytes.resize(80, 0);
        bytes.extend(4u32.to_le_bytes());
        let mut text = String::from("solid a\n");
        for facet in facets() {
            bytes.extend([0; 12]);
            text.push_str(" facet normal 0 0 0\n  outer loop\n");
            for p in facet {
                bytes.extend(p.iter().flat_map(|x| x.to_le_bytes()));
                text.push_str(&format!("   vertex {} {} {}\n", p[0], p[1], p[2]));
            }
            bytes.extend([0; 2]);
            text.push_str("  endloop\n endfacet\n");
        }
        text.push_str("endsolid a\n");
        let [a, b] = [read(path, &bytes), read(path, text.as_bytes())].map(|read| read.unwrap().content.mesh);
        assert_eq!(a, b);
        assert_eq!((a.vertices.len(), a.triangles.nodes), (4, vec![[0, 1, 2], [0, 2, 3], [2, 1, 3], [1, 0, 3]]));
        let named = text.replace("solid a", "solid wing tip ").replace(" facet normal 0 0 0\n", "facet normal 0 0 0\n");
        let found = read(path, (named + &text).as_bytes()).unwrap().content;
        assert_eq!(found.mesh.triangles.refs, [1, 1, 1, 1, 2, 2, 2, 2]);
        let name = |reference: i32| found.names.triangles[&reference].name.clone().unwrap();
        assert_eq!([name(1), name(2)], ["wing tip", "a"]);
        assert!(read(path, &bytes[..200]).unwrap_err().to_string().contains("cut off"));
        assert!(read(path, b"solid\nvertex 1 2 x").unwrap_err().to_string().contains("line 2"));
        assert!(read(path, b"solid\nvertex 1 2 nan").unwrap_err().to_string().contains("finite"));
        assert!(read(path, b"solid\nvertex 1 2 3").unwrap_err().to_string().contains("not closed"));
        assert!(read(path, b"").is_err() && read(path, &[0; 300]).is_err());
    }
}
