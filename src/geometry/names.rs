//! Names and colours of the parts of a model, and of a mesh of it; and the names file beside a mesh or a BREP model.
//!
//! MESH.names.json (or MESH.meshb.names.json, which is looked for first) says for triangles, edges and tetrahedra what each reference is
//! called, and its colour; part.step.names.json says it for the faces, edges and solids of a model; `fields` are the names of the fields of the solution file beside:
//! `{"triangles": {"3": {"name": "inlet", "colour": "#FF0000"}}, "tetrahedra": {"1": {"name": "fluid"}}, "fields": ["Mach"]}`.
use crate::mesh::io::{self, Batch, Error};
use serde::{Deserialize, Deserializer, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The name and the colour of a part in a CAD program.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Label {
    /// The name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// The colour as #RRGGBB (sRGB).
    #[serde(default, alias = "color", skip_serializing_if = "Option::is_none", deserialize_with = "colour")]
    pub colour: Option<String>,
}

/// Labels by reference: of a model the numbers of its entities from 1, of a mesh the references of its elements.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Names {
    /// Faces.
    pub triangles: BTreeMap<i32, Label>,
    /// Edges.
    pub edges: BTreeMap<i32, Label>,
    /// Solids.
    pub tetrahedra: BTreeMap<i32, Label>,
}

impl Names {
    /// Takes over the labels of others: their names and colours come before its own.
    pub fn update(&mut self, others: Names) {
        let update = |own: &mut BTreeMap<i32, Label>, others: BTreeMap<i32, Label>| {
            for (number, Label { name, colour }) in others {
                let label = own.entry(number).or_default();
                label.name = name.or(label.name.take());
                label.colour = colour.or(label.colour.take());
            }
        };
        update(&mut self.triangles, others.triangles);
        update(&mut self.edges, others.edges);
        update(&mut self.tetrahedra, others.tetrahedra);
    }

    /// Whether nothing has a label.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty() && self.edges.is_empty() && self.tetrahedra.is_empty()
    }
}

/// The references that have a name.
pub fn called(labels: &BTreeMap<i32, Label>, name: &str) -> Vec<i32> {
    let same = |label: &Label| label.name.as_deref() == Some(name);
    labels.iter().filter(|(_, label)| same(label)).map(|(&reference, _)| reference).collect()
}

/// A colour as a file says it.
fn colour<'de, D: Deserializer<'de>>(from: D) -> Result<Option<String>, D::Error> {
    let is_one = |text: &str| {
        text.strip_prefix('#').is_some_and(|rest| rest.len() == 6 && rest.bytes().all(|b| b.is_ascii_hexdigit()))
    };
    match Option::<String>::deserialize(from)? {
        Some(text) if !is_one(&text) => {
            Err(serde::de::Error::custom(format!("the colour '{text}' is not of the form #aabbcc")))
        }
        text => Ok(text),
    }
}

/// The path of the names file of a mesh or solution, whether it exists or not. It is the one that is read, and so the one that is written.
pub fn beside(of: &Path) -> PathBuf {
    let long = of_model(of);
    if long.exists() { long } else { of.with_extension("names.json") }
}

/// The path of the names file of a CAD model that is written: part.step.names.json, since part.names.json is that of a mesh beside it.
pub fn of_model(model: &Path) -> PathBuf {
    let mut long = model.as_os_str().to_owned();
    long.push(".names.json");
    long.into()
}

/// The path of the names file of a CAD model that is read. A BREP file is written with its mesh, and shares the names of that.
pub fn beside_model(model: &Path) -> PathBuf {
    let is_brep = model.extension().is_some_and(|kind| kind.eq_ignore_ascii_case("brep"));
    if is_brep { beside(model) } else { of_model(model) }
}

/// Reads the names file of a CAD model; none where there is none.
///
/// # Errors
/// As [`read`].
pub fn read_of_model(model: &Path) -> Result<Names, Error> {
    let path = beside_model(model);
    if matches!(path.try_exists(), Ok(false)) { Ok(Names::default()) } else { read_file(&path) }
}

/// The names of the fields in a names file.
#[derive(Default, Deserialize)]
#[serde(default)]
struct Fields {
    fields: Vec<String>,
}

/// What is written.
#[derive(Serialize)]
struct File<'a> {
    #[serde(flatten)]
    names: &'a Names,
    #[serde(skip_serializing_if = "<[String]>::is_empty")]
    fields: &'a [String],
}

/// Reads the names of a mesh or model; none where there is no names file beside it.
///
/// # Errors
/// [`Error::System`] when the file cannot be read, [`Error::Content`] when it holds something else.
pub fn read(of: &Path) -> Result<Names, Error> {
    let Some((path, bytes)) = bytes_beside(of)? else { return Ok(Names::default()) };
    parse(&path, &bytes)
}

/// Reads a names file itself.
///
/// # Errors
/// [`Error::System`] when the file cannot be read, [`Error::Content`] when it holds something else.
pub fn read_file(path: &Path) -> Result<Names, Error> {
    parse(path, &io::read_file(path)?)
}

/// Reads the names of the fields of a solution, from the names file beside it; none where there is no such file.
///
/// # Errors
/// As [`read`].
pub fn read_fields(of: &Path) -> Result<Vec<String>, Error> {
    let Some((path, bytes)) = bytes_beside(of)? else { return Ok(Vec::new()) };
    parse::<Fields>(&path, &bytes).map(|found| found.fields)
}

/// Writes the names of a mesh, and of its fields, beside it. Where there are none nothing is written, and the file of an older mesh is
/// made empty.
///
/// # Errors
/// When the file cannot be written.
pub fn write(of: &Path, names: &Names, fields: &[String]) -> Result<(), Error> {
    let mut batch = Batch::new();
    add(&mut batch, of, names, fields)?;
    batch.commit()
}

/// Adds the names file, as [`write`] writes it, to files that belong together.
///
/// # Errors
/// As there.
pub fn add(batch: &mut Batch, of: &Path, names: &Names, fields: &[String]) -> Result<(), Error> {
    let path = beside(of);
    if names.is_empty() && fields.is_empty() && !path.exists() {
        return Ok(());
    }
    add_file(batch, &path, names, fields)
}

/// Adds a names file by its own path.
///
/// # Errors
/// As [`write`].
pub fn add_file(batch: &mut Batch, path: &Path, names: &Names, fields: &[String]) -> Result<(), Error> {
    batch.add(path, |file| {
        serde_json::to_writer_pretty(&mut *file, &File { names, fields })?;
        file.write_all(b"\n")
    })
}

/// The names file beside a mesh, and its bytes.
fn bytes_beside(of: &Path) -> Result<Option<(PathBuf, Vec<u8>)>, Error> {
    let path = beside(of);
    match path.try_exists() {
        Ok(false) => Ok(None),
        _ => io::read_file(&path).map(|bytes| Some((path, bytes))),
    }
}

fn parse<'b, T: Deserialize<'b>>(path: &Path, bytes: &'b [u8]) -> Result<T, Error> {
    let wrong = |line: usize, why: String| Error::Content {
        path: path.into(),
        place: format!("line {line}"),
        message: format!(
            "no names of references ({why}); write {{\"triangles\": {{\"3\": {{\"name\": \"wing\", \"colour\": \"#aabbcc\"}}}}}} \
             as geo-adapt bootstrap does, or move the file away"
        ),
    };
    // A list would do for serde.
    if !bytes.trim_ascii_start().starts_with(b"{") {
        return Err(wrong(1, "an object in braces is expected".into()));
    }
    serde_json::from_slice(bytes).map_err(|error| wrong(error.line(), error.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_text(text: &str) -> Result<Names, String> {
        parse(Path::new("a.names.json"), text.as_bytes()).map_err(|error| error.to_string())
    }

    #[test]
    fn names_and_colours() {
        let names =
            read_text(r##"{"triangles": {"3": {"name": "wing", "color": "#ff0000"}, "-1": {}}, "more": 1}"##).unwrap();
        assert_eq!(names.triangles[&3], Label { name: Some("wing".into()), colour: Some("#ff0000".into()) });
        assert_eq!(names.triangles[&-1], Label::default());
        assert!(names.tetrahedra.is_empty());
    }

    #[test]
    fn what_is_wrong_is_named() {
        for (text, part) in [
            ("[1]", "line 1"),
            ("{", "line 1"),
            ("{\"triangles\":\n3}", "line 2"),
            (r#"{"tetrahedra": {"a": {}}}"#, "line 1"),
            (r#"{"triangles": {"3": {"color": "red"}}}"#, "the colour 'red' is not of the form #aabbcc"),
            (r##"{"triangles": {"3": {"color": "#é12"}}}"##, "is not of the form"),
        ] {
            let message = read_text(text).unwrap_err();
            assert!(message.contains(part) && message.contains("a.names.json: "), "{text}: {message}");
        }
    }

    #[test]
    fn a_names_file_comes_back_and_an_old_one_is_made_empty() {
        let folder = tempfile::tempdir().unwrap();
        let mesh = folder.path().join("wing.meshb");
        write(&mesh, &Names::default(), &[]).unwrap();
        assert!(!beside(&mesh).exists());
        let mut names = Names::default();
        names.edges.insert(7, Label { name: Some("edge".into()), colour: None });
        write(&mesh, &names, &["Mach".into(), "p".into()]).unwrap();
        assert_eq!((read(&mesh).unwrap(), read_fields(&mesh).unwrap()), (names, vec!["Mach".into(), "p".into()]));
        assert_eq!(read_file(&beside(&mesh)).unwrap().edges.len(), 1);
        write(&mesh, &Names::default(), &[]).unwrap();
        assert!(read(&mesh).unwrap().is_empty() && read_fields(&mesh).unwrap().is_empty());
        // The longer name goes first.
        std::fs::write(folder.path().join("wing.meshb.names.json"), "[]").unwrap();
        assert!(read(&mesh).unwrap_err().to_string().contains("wing.meshb.names.json"));
    }
}
