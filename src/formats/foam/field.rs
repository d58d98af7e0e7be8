//! Fields at the cells (volScalarField and its like) in files.
use super::file::{FoamFile, head_text};
use super::list;
use super::scan::{Scanner, Token};
use crate::mesh::io::{Batch, Error, FieldKind, write_beside};
use std::io::Write;
use std::path::Path;

/// Values at the cells.
#[derive(Clone, Debug, PartialEq)]
pub struct CellField {
    /// What it holds.
    pub kind: FieldKind,
    /// Shape (cells, values of the kind), row by row, or of one row: the same everywhere. Symmetric tensors 11 12 22 13 23 33.
    pub values: Vec<f64>,
}

/// The class of files of a kind, and the word for its values in lists.
const CLASSES: [(FieldKind, &str, &str); 4] = [
    (FieldKind::Scalar, "volScalarField", "scalar"),
    (FieldKind::Vector, "volVectorField", "vector"),
    (FieldKind::SymmetricTensor, "volSymmTensorField", "symmTensor"),
    (FieldKind::Tensor, "volTensorField", "tensor"),
];

/// The class of files of a kind at cells, and the word for its values.
fn words_of(kind: FieldKind) -> (&'static str, &'static str) {
    let (_, class, word) = CLASSES[CLASSES.iter().position(|(known, ..)| *known == kind).unwrap_or(0)];
    (class, word)
}

/// OpenFOAM has xx xy xz yy yz zz, files of libMeshb 11 12 22 13 23 33: the third and the fourth change places.
fn reorder(kind: FieldKind, values: &mut [f64]) {
    if kind == FieldKind::SymmetricTensor {
        values.chunks_exact_mut(6).for_each(|six| six.swap(2, 3));
    }
}

/// Reads a field of so many cells, every value finite; none where the file holds no field that we know (its class is returned).
///
/// # Errors
/// [`Error::System`] when the file cannot be read, [`Error::Content`] when it is damaged, of another number of cells, or needs OpenFOAM's macros.
pub fn read_cell_field(path: &Path, cells: usize) -> Result<Result<CellField, String>, Error> {
    let file = FoamFile::open(path)?;
    let (head, mut scanner) = file.parts()?;
    let Some(&(kind, _, word)) = CLASSES.iter().find(|(_, class, _)| *class == head.class) else {
        return Ok(Err(head.class));
    };
    find_entry(&mut scanner, b"internalField")?;
    let mut values = Vec::new();
    match scanner.word()? {
        b"uniform" => {
            list::tuple(&mut scanner, kind.values(), &mut values)?;
            values = values.repeat(cells);
        }
        b"nonuniform" => {
            let list = scanner.word()?;
            // An empty list may come without its type.
            if list != format!("List<{word}>").as_bytes() && list != b"0" {
                return Err(scanner.fail(format!("expected List<{word}>, found {}", Token::Word(list).shown())));
            }
            if list != b"0" {
                values = list::reals(&mut scanner, &head, kind.values(), Some(cells))?;
            }
        }
        other => {
            return Err(scanner.fail(format!(
                "expected `uniform` or `nonuniform`, found {}: run the case through OpenFOAM first",
                Token::Word(other).shown()
            )));
        }
    }
    if values.len() != cells * kind.values() {
        return Err(scanner.fail(format!("the field has no values for the {cells} cells")));
    }
    scanner.expect(b';')?;
    reorder(kind, &mut values);
    Ok(Ok(CellField { kind, values }))
}

/// Passes over the entries before the one of that name, and over the name.
fn find_entry(scanner: &mut Scanner, name: &[u8]) -> Result<(), Error> {
    while scanner.word()? != name {
        scanner.skip_entry()?;
    }
    Ok(())
}

/// The exponents of a velocity.
pub const VELOCITY: [i32; 4] = [0, 1, -1, 0];

/// The exponents of a pressure over a density.
pub const KINEMATIC_PRESSURE: [i32; 4] = [0, 2, -2, 0];

/// Exponents of mass, length, time and temperature, as OpenFOAM wants them of the fields that its solvers read; else none.
pub(super) fn dimensions(path: &Path) -> [i32; 4] {
    match path.file_name().unwrap_or_default().to_string_lossy().as_ref() {
        "p" => [1, -1, -2, 0],
        "T" => [0, 0, 0, 1],
        "U" => VELOCITY,
        "rho" => [1, -3, 0, 0],
        _ => [0; 4],
    }
}

/// Writes a field with the entries of its patches: (name, what stands between the braces). `cells` is how many cells there are.
///
/// # Errors
/// [`Error::System`] when the file cannot be written, [`Error::Content`] when a value is not finite or there are too few.
pub fn write_cell_field(
    path: &Path,
    field: &CellField,
    cells: usize,
    patches: &[(String, String)],
    text: bool,
) -> Result<(), Error> {
    write_cell_field_of(path, field, cells, patches, text, dimensions(path))
}

/// The same with other dimensions than usually belong to the name: exponents of mass, length, time and temperature.
///
/// # Errors
/// As [`write_cell_field`].
pub fn write_cell_field_of(
    path: &Path,
    field: &CellField,
    cells: usize,
    patches: &[(String, String)],
    text: bool,
    dimensions: [i32; 4],
) -> Result<(), Error> {
    let mut batch = Batch::new();
    add_cell_field(&mut batch, path, field, cells, patches, text, dimensions)?;
    batch.commit()
}

/// Adds what [`write_cell_field_of`] writes to files that belong together.
pub(super) fn add_cell_field(
    batch: &mut Batch,
    path: &Path,
    field: &CellField,
    cells: usize,
    patches: &[(String, String)],
    text: bool,
    dimensions: [i32; 4],
) -> Result<(), Error> {
    let wrong = |message: String| Error::Content { path: path.to_owned(), place: "values".to_owned(), message };
    let width = field.kind.values();
    if let Some(at) = field.values.iter().position(|value| !value.is_finite()) {
        return Err(wrong(format!("{} of cell {} is not finite", field.values[at], at / width)));
    }
    let uniform = field.values.len() == width;
    if !uniform && field.values.len() != cells * width {
        return Err(wrong(format!("there are {} for {cells} cells of {width} each", field.values.len())));
    }
    let (class, _) = words_of(field.kind);
    let mut values = field.values.clone();
    reorder(field.kind, &mut values);
    let content = Content { class, kind: field.kind, values: &values, uniform, patches, dimensions };
    batch.add(path, |w| content.write(w, path, text))
}

/// Writes a value for each inner face (surfaceScalarField), with the entries of the patches.
///
/// # Errors
/// [`Error::System`] when the file cannot be written.
pub fn write_face_field(path: &Path, values: &[f64], patches: &[(String, String)], text: bool) -> Result<(), Error> {
    let content = Content {
        class: "surfaceScalarField",
        kind: FieldKind::Scalar,
        values,
        uniform: false,
        patches,
        dimensions: dimensions(path),
    };
    write_beside(path, |w| content.write(w, path, text))
}

/// What a field file holds.
struct Content<'a> {
    class: &'a str,
    kind: FieldKind,
    values: &'a [f64],
    /// One value stands for all.
    uniform: bool,
    patches: &'a [(String, String)],
    dimensions: [i32; 4],
}

impl Content<'_> {
    fn write(&self, w: &mut dyn Write, path: &Path, text: bool) -> std::io::Result<()> {
        let Self { class, kind, values, uniform, patches, dimensions } = *self;
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let location = path.parent().and_then(Path::file_name).unwrap_or_default().to_string_lossy();
        let (_, word) = words_of(kind);
        let [mass, length, time, temperature] = dimensions;
        write!(w, "{}", head_text(class, &location, &name, text))?;
        write!(w, "\ndimensions      [{mass} {length} {time} {temperature} 0 0 0];\n\ninternalField   ")?;
        if uniform {
            w.write_all(b"uniform ")?;
            write_tuple(w, values)?;
        } else {
            write!(w, "nonuniform List<{word}>")?;
            write_reals(w, values, kind.values(), text)?;
        }
        w.write_all(b";\n\nboundaryField\n{\n")?;
        patches.iter().try_for_each(|(name, entries)| writeln!(w, "    {name}\n    {{\n        {entries}\n    }}"))?;
        w.write_all(b"}\n")
    }
}

fn write_tuple(w: &mut dyn Write, values: &[f64]) -> std::io::Result<()> {
    if let [value] = values {
        return write!(w, "{value:?}");
    }
    w.write_all(b"(")?;
    for (i, value) in values.iter().enumerate() {
        write!(w, "{}{value:?}", if i == 0 { "" } else { " " })?;
    }
    w.write_all(b")")
}

/// A list of tuples of `width` reals.
pub(super) fn write_reals(w: &mut dyn Write, values: &[f64], width: usize, text: bool) -> std::io::Result<()> {
    write!(w, "\n{}\n(", values.len() / width)?;
    if text {
        for tuple in values.chunks(width) {
            w.write_all(b"\n")?;
            write_tuple(w, tuple)?;
        }
        w.write_all(b"\n")?;
    } else {
        let mut bytes = Vec::with_capacity(8 * 4096);
        for values in values.chunks(4096) {
            bytes.clear();
            values.iter().for_each(|value| bytes.extend(value.to_le_bytes()));
            w.write_all(&bytes)?;
        }
    }
    w.write_all(b")\n")
}

/// A list of whole numbers.
pub(super) fn write_labels(w: &mut dyn Write, labels: &[u32], text: bool) -> std::io::Result<()> {
    write!(w, "\n{}\n(", labels.len())?;
    if text {
        labels.iter().try_for_each(|label| write!(w, "\n{label}"))?;
        w.write_all(b"\n")?;
    } else {
        let mut bytes = Vec::with_capacity(4 * 8192);
        for labels in labels.chunks(8192) {
            bytes.clear();
            labels.iter().for_each(|label| bytes.extend(label.to_le_bytes()));
            w.write_all(&bytes)?;
        }
    }
    w.write_all(b")\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_comes_back_in_text_and_bytes() {
        let folder = tempfile::tempdir().unwrap();
        for text in [true, false] {
            for (kind, ..) in CLASSES {
                for cells in [1, 3] {
                    let values = (0..cells * kind.values()).map(|i| 0.1 * i as f64 - 1e-9).collect();
                    let field = CellField { kind, values };
                    let path = folder.path().join("x");
                    let patches = [("wall".to_owned(), "type zeroGradient;".to_owned())];
                    write_cell_field(&path, &field, cells, &patches, text).unwrap();
                    assert_eq!(read_cell_field(&path, cells).unwrap().unwrap(), field);
                }
            }
        }
    }

    #[test]
    fn other_fields_are_refused_with_their_place() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("p");
        let read = |text: &str| {
            std::fs::write(&path, format!("FoamFile {{ class volScalarField; }} {text}")).unwrap();
            read_cell_field(&path, 2).map_err(|error| error.to_string())
        };
        let field = read("dimensions [0 1 0]; internalField uniform 3; boundaryField {}").unwrap().unwrap();
        assert_eq!(field.values, [3.0, 3.0]);
        assert!(
            read("internalField nonuniform List<scalar> 3(1 2 3);")
                .unwrap_err()
                .contains("a list of 2 should stand here")
        );
        assert!(read("internalField nonuniform List<vector> 2(1 2);").unwrap_err().contains("expected List<scalar>"));
        assert!(read("internalField $inner;").unwrap_err().contains("run the case through OpenFOAM"));
        assert!(read("internalField nonuniform 0;").unwrap_err().contains("no values for the 2 cells"));
        assert!(read("dimensions [0 1 0];").unwrap_err().contains("expected a word, found the end"));
        std::fs::write(&path, "FoamFile { class surfaceScalarField; }").unwrap();
        assert_eq!(read_cell_field(&path, 2).unwrap(), Err("surfaceScalarField".to_owned()));
        let bad = CellField { kind: FieldKind::Scalar, values: vec![1.0, f64::NAN] };
        assert!(write_cell_field(&path, &bad, 2, &[], true).unwrap_err().to_string().contains("cell 1 is not finite"));
    }
}
