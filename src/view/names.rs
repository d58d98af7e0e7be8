//! Names and colours of references, from a file beside the mesh.
use super::colour::{self, Rgb};
use crate::mesh::io::Error;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// What a reference is called, and its colour.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Named {
    /// Its name.
    pub name: Option<String>,
    /// Its colour.
    pub colour: Option<Rgb>,
}

/// Names of references: those of triangles, of tetrahedra, of edges.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Names {
    /// Of the surfaces.
    pub triangles: BTreeMap<i32, Named>,
    /// Of the regions.
    pub tetrahedra: BTreeMap<i32, Named>,
}

impl Names {
    /// Of MESH.names.json beside a mesh, or of its stem (wing.names.json beside wing.meshb); without a file no names:
    /// `{"triangles": {"3": {"name": "wing", "colour": "#aabbcc"}}, "tetrahedra": {…}}`, as `bootstrap` writes them; `color` will do.
    ///
    /// # Errors
    /// When such a file is there and is not of that form.
    pub fn beside(mesh: &Path) -> Result<Self, Error> {
        let mut long = mesh.as_os_str().to_owned();
        long.push(".names.json");
        for path in [PathBuf::from(long), mesh.with_extension("names.json")] {
            match std::fs::read(&path) {
                Ok(bytes) => {
                    return Self::from_json(&bytes).map_err(|(place, message)| Error::Content { path, place, message });
                }
                Err(error) if error.kind() == std::io::ErrorKind::NotFound => {}
                Err(source) => return Err(Error::System { path, source }),
            }
        }
        Ok(Self::default())
    }

    /// The names of a file's bytes; else the place and what is wrong there.
    fn from_json(bytes: &[u8]) -> Result<Self, (String, String)> {
        let remedy = r##"write {"triangles": {"3": {"name": "wing", "colour": "#aabbcc"}}, "tetrahedra": {}}"##;
        let value: serde_json::Value = serde_json::from_slice(bytes)
            .map_err(|error| (format!("line {}", error.line()), format!("is not JSON ({error}); {remedy}")))?;
        let of = |kind: &str| -> Result<BTreeMap<i32, Named>, (String, String)> {
            let wrong = |place: String| (place, format!("is not as expected; {remedy}"));
            let Some(entries) = value.get(kind) else { return Ok(BTreeMap::new()) };
            let entries = entries.as_object().ok_or_else(|| wrong(kind.into()))?;
            let mut found = BTreeMap::new();
            for (reference, entry) in entries {
                let place = || format!("{kind}, {reference}");
                let number = reference.parse().map_err(|_| wrong(place()))?;
                let text = |key: &str| match entry.get(key) {
                    None | Some(serde_json::Value::Null) => Ok(None),
                    Some(value) => value.as_str().map(Some).ok_or_else(|| wrong(place())),
                };
                let name = text("name")?.map(String::from);
                let colour = text("colour")?.or(text("color")?);
                let colour = colour.map(|text| colour::parse(text).ok_or_else(|| wrong(place()))).transpose()?;
                found.insert(number, Named { name, colour });
            }
            Ok(found)
        };
        if !value.is_object() {
            return Err(("line 1".into(), format!("is not as expected; {remedy}")));
        }
        Ok(Self { triangles: of("triangles")?, tetrahedra: of("tetrahedra")? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_colours() {
        let names =
            Names::from_json(br##"{"triangles": {"3": {"name": "wing", "color": "#ff0000"}, "-1": {}}, "more": 1}"##)
                .unwrap();
        assert_eq!(names.triangles[&3], Named { name: Some("wing".into()), colour: Some([1.0, 0.0, 0.0]) });
        assert_eq!(names.triangles[&-1], Named::default());
        assert!(names.tetrahedra.is_empty());
    }

    #[test]
    fn what_is_wrong_is_named() {
        for (text, place) in [
            ("[1]", "line 1"),
            ("{", "line 1"),
            (r#"{"triangles": 3}"#, "triangles"),
            (r#"{"tetrahedra": {"a": {}}}"#, "tetrahedra, a"),
            (r#"{"triangles": {"3": {"color": "red"}}}"#, "triangles, 3"),
        ] {
            assert_eq!(Names::from_json(text.as_bytes()).unwrap_err().0, place, "{text}");
        }
    }
}
