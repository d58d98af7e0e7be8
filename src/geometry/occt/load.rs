//! Reading of a model file.
use super::OcctModel;
use super::bridge::ffi;
use super::entities;
use crate::geometry::{Error, FarField, Healed, Names, Remedy};
use crate::mesh::io::{self, check_regular};
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;
use std::sync::{Mutex, PoisonError};

/// OCCT's readers share global state: two at a time crash.
static LOADING: Mutex<()> = Mutex::new(());

#[derive(Clone, Copy, PartialEq)]
enum Format {
    Step = 0,
    Iges = 1,
    Brep = 2,
}

/// Reads a model: see [`OcctModel::read`].
pub fn read(path: &Path) -> Result<OcctModel, Error> {
    let fail = |message: String| Error::Model { path: path.into(), message };
    let format = format_of(path).ok_or_else(|| {
        fail("unknown kind of model; the name must end in .step, .stp, .iges, .igs, .brep or .egads".into())
    })?;
    check_regular(path).map_err(|error| match error {
        io::Error::System { path, source } => Error::Open { path, source },
        io::Error::Content { .. } => fail(error.to_string()),
    })?;
    let (head, tail) = ends(path).map_err(|source| Error::Open { path: path.into(), source })?;
    check(format, &head, &tail).map_err(|message| fail(message.into()))?;
    let name = path.to_str().ok_or_else(|| fail("the file's name is not UTF-8; rename it".into()))?;
    let _guard = LOADING.lock().unwrap_or_else(PoisonError::into_inner);
    let occt = ffi::load_model(name, format as u32).map_err(|error| fail(error.what().into()))?;
    let model =
        entities::build(occt).map_err(|error| fail(format!("OpenCASCADE cannot use the model: {}", error.what())))?;
    let (tolerance, diagonal) = (model.topology.tolerance, model.topology.diagonal());
    if tolerance > diagonal {
        return Err(fail(format!(
            "its largest tolerance, {tolerance:.3}, is greater than the model itself, whose box has a diagonal of {diagonal:.3}: its faces and \
             edges do not meet; the file is damaged, export it again"
        )));
    }
    Ok(model)
}

/// Reads what [`save`] has written.
pub fn read_saved(path: &Path) -> Result<OcctModel, Error> {
    let fail = |message: String| Error::Model { path: path.into(), message };
    let name = path.to_str().ok_or_else(|| fail("the file's name is not UTF-8; rename it".into()))?;
    let _guard = LOADING.lock().unwrap_or_else(PoisonError::into_inner);
    let occt = ffi::load_saved(name).map_err(|error| fail(error.what().into()))?;
    entities::build(occt).map_err(|error| fail(format!("OpenCASCADE cannot use the model: {}", error.what())))
}

/// Writes a model for another process: see [`OcctModel::save`].
pub fn save(occt: &ffi::Model, path: &Path) -> Result<(), Error> {
    let fail = |message: String| Error::Model { path: path.into(), message };
    // The file is written whole or not at all.
    let part = path.with_extension("part");
    let name = part.to_str().ok_or_else(|| fail("the file's name is not UTF-8; rename it".into()))?;
    let _guard = LOADING.lock().unwrap_or_else(PoisonError::into_inner);
    occt.save(name).map_err(|error| fail(error.what().into()))?;
    std::fs::rename(&part, path).map_err(|error| fail(error.to_string()))
}

/// Writes a model: see [`OcctModel::write_brep`].
pub fn write(occt: &ffi::Model, path: &Path) -> Result<(), Error> {
    let fail = |message: String| Error::Model { path: path.into(), message };
    let name = path.to_str().ok_or_else(|| fail("the file's name is not UTF-8; rename it".into()))?;
    let _guard = LOADING.lock().unwrap_or_else(PoisonError::into_inner);
    occt.write_brep(name).map_err(|error| fail(error.what().into()))
}

/// The same model with these names: OpenCASCADE hands them on to what becomes of its faces.
fn named(occt: &ffi::Model, names: &Names) -> Result<cxx::SharedPtr<ffi::Model>, cxx::Exception> {
    let counts = [occt.edge_count()?, occt.face_count()?, occt.solid_count()?];
    let kinds = [&names.edges, &names.triangles, &names.tetrahedra].into_iter().zip(counts).zip(1..);
    let records = kinds.flat_map(|((labels, count), dimension)| {
        labels.range(1..=count as i32).map(move |(&number, label)| ffi::NamedRecord {
            dimension,
            index: number as u32 - 1,
            name: label.name.clone().unwrap_or_default(),
            colour: label.colour.clone().unwrap_or_default(),
        })
    });
    occt.relabelled(&records.collect::<Vec<_>>())
}

/// The far field without a body: see [`OcctModel::domain`].
pub fn domain(occt: &ffi::Model, names: &Names, far: &FarField) -> Result<OcctModel, Error> {
    let fail = |message: String| Error::Model { path: "the far field".into(), message };
    let (centre, radius) = far.sphere.unwrap_or_default();
    let (axis, at) = far.symmetry.map_or((-1, 0.0), |(axis, at)| (axis as i32, at));
    let [low, high] = far.bounds;
    let record = ffi::DomainRecord { low, high, centre, radius, axis, at };
    let _guard = LOADING.lock().unwrap_or_else(PoisonError::into_inner);
    let domain = named(occt, names).and_then(|occt| occt.domain(&record)).map_err(|error| fail(error.what().into()))?;
    entities::build(domain).map_err(|error| fail(format!("OpenCASCADE cannot use it: {}", error.what())))
}

/// A model without what is smaller than a length: see [`OcctModel::healed`].
pub fn healed(occt: &ffi::Model, names: &Names, length: f64) -> Result<(OcctModel, Vec<Healed>), Error> {
    let fail = |message: String| Error::Model { path: "the healed model".into(), message };
    let _guard = LOADING.lock().unwrap_or_else(PoisonError::into_inner);
    let mut done = Vec::new();
    let healed = named(occt, names)
        .and_then(|occt| occt.healed(length, &mut done))
        .map_err(|error| fail(error.what().into()))?;
    let model =
        entities::build(healed).map_err(|error| fail(format!("OpenCASCADE cannot use it: {}", error.what())))?;
    let what = |what: u32| match what {
        0 => Remedy::CollapsedEdge,
        1 => Remedy::CollapsedFace,
        _ => Remedy::SewnEdge,
    };
    let done = done.iter().map(|done| Healed { remedy: what(done.what), at: done.at, size: done.size });
    Ok((model, done.collect()))
}

/// A model in other units or at another place: see [`OcctModel::placed`].
pub fn placed(occt: &ffi::Model, names: &Names, factor: f64, by: &[f64; 3]) -> Result<OcctModel, Error> {
    let fail = |message: String| Error::Model { path: "the scaled model".into(), message };
    let _guard = LOADING.lock().unwrap_or_else(PoisonError::into_inner);
    let placed = occt.placed(factor, by).map_err(|error| fail(error.what().into()))?;
    let mut model =
        entities::build(placed).map_err(|error| fail(format!("OpenCASCADE cannot use it: {}", error.what())))?;
    model.rename(names.clone());
    Ok(model)
}

/// The format by the file's extension.
fn format_of(path: &Path) -> Option<Format> {
    match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
        "step" | "stp" => Some(Format::Step),
        "iges" | "igs" => Some(Format::Iges),
        "brep" | "egads" => Some(Format::Brep),
        _ => None,
    }
}

/// The first and the last kilobytes of a file.
fn ends(path: &Path) -> std::io::Result<(Vec<u8>, Vec<u8>)> {
    const LENGTH: u64 = 4096;
    let mut file = File::open(path)?;
    let (mut head, mut tail) = (Vec::new(), Vec::new());
    file.by_ref().take(LENGTH).read_to_end(&mut head)?;
    let size = file.metadata()?.len();
    file.seek(SeekFrom::Start(size.saturating_sub(LENGTH)))?;
    file.read_to_end(&mut tail)?;
    Ok((head, tail))
}

/// Finds files of another kind, and cut files, before OCCT reads them: it takes what it finds without complaint.
fn check(format: Format, head: &[u8], tail: &[u8]) -> Result<(), &'static str> {
    let has = |text: &[u8], word: &str| text.windows(word.len()).any(|window| window == word.as_bytes());
    let letter = |line: &[u8], letter: u8| line.get(72) == Some(&letter);
    if head.iter().all(u8::is_ascii_whitespace) {
        return Err("the file is empty; export the model again");
    }
    match format {
        Format::Step if !has(head, "ISO-10303-21") => {
            Err("this is no STEP file (it does not begin with ISO-10303-21); export the model as STEP")
        }
        Format::Step if !has(tail, "END-ISO-10303-21") => {
            Err("the STEP file is cut off (END-ISO-10303-21 is missing); copy or export it again")
        }
        Format::Iges if !head.split(|&c| c == b'\n').next().is_some_and(|line| letter(line, b'S')) => {
            Err("this is no IGES file (its first line is no start record); export the model as IGES")
        }
        Format::Iges if !tail.split(|&c| c == b'\n').any(|line| letter(line, b'T')) => {
            Err("the IGES file is cut off (its terminate record is missing); copy or export it again")
        }
        Format::Brep if !has(head, "CASCADE Topology V") => Err(
            "this is no OpenCASCADE BREP file (no line `CASCADE Topology V…`); write the model as BREP text or STEP",
        ),
        _ => Ok(()),
    }
}
