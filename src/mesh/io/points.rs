//! Points from a text file, or from the vertices of a mesh.
use super::{Error, Read, read_file, read_mesh};
use crate::mesh::vector::Vec3;
use std::path::Path;

/// Reads points: of .mesh and .meshb the vertices; of any other file the first three numbers of each line, between white space, commas
/// or semicolons. Empty lines and what follows a # are passed over, and so is a first line of names.
///
/// # Errors
/// [`Error::System`] when the file cannot be read, [`Error::Content`] for a line that is no point, and when there is none.
pub fn read_points(path: &Path) -> Result<Read<Vec<Vec3>>, Error> {
    if path.extension().is_some_and(|ending| ending == "mesh" || ending == "meshb") {
        let Read { content, notices } = read_mesh(path)?;
        return Ok(Read { content: content.vertices, notices });
    }
    let bytes = read_file(path)?;
    let text = std::str::from_utf8(&bytes).map_err(|_| {
        Error::content(path, "the file", "is no text; give x y z in each line, or a .mesh or .meshb file")
    })?;
    let (mut points, mut notices, mut is_first) = (Vec::new(), Vec::new(), true);
    for (number, line) in (1..).zip(text.lines()) {
        let line = line.split('#').next().unwrap_or_default();
        let mut words =
            line.split(|c: char| c.is_whitespace() || ",;".contains(c)).filter(|word| !word.is_empty()).peekable();
        if words.peek().is_none() {
            continue;
        }
        let values =
            [words.next(), words.next(), words.next()].map(|word| word.and_then(|word| word.parse::<f64>().ok()));
        match values {
            [Some(x), Some(y), Some(z)] if [x, y, z].iter().all(|x| x.is_finite()) => points.push([x, y, z]),
            [None, None, None] if is_first => {
                notices.push(format!("{}: line {number} was taken for names", path.display()))
            }
            _ => {
                let message = format!("'{}' is no point; give three finite numbers x y z", line.trim());
                return Err(Error::content(path, format!("line {number}"), message));
            }
        }
        is_first = false;
    }
    if points.is_empty() {
        return Err(Error::content(path, "the file", "has no point; give x y z in each line"));
    }
    Ok(Read { content: points, notices })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Vec<Vec3>, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("cloud.csv");
        std::fs::write(&path, text).unwrap();
        read_points(&path).map(|read| read.content).map_err(|error| error.to_string())
    }

    #[test]
    fn lines_of_numbers_are_points() {
        let expected = vec![[1.0, 2.5, -3e-3], [4.0, 5.0, 6.0]];
        assert_eq!(read("x,y,z\n1,2.5,-3e-3\n\n# none\n4;5 ; 6,7 # more\n").unwrap(), expected);
        assert!(read("1 2 3\n1 2\n").unwrap_err().contains("cloud.csv: line 2: '1 2' is no point"));
        assert!(read("1 2 3\nx y z\n").unwrap_err().contains("line 2"));
        assert!(read("1 nan 3\n").unwrap_err().contains("line 1"));
        assert!(read("# nothing\n").unwrap_err().contains("has no point"));
    }
}
