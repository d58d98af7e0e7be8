//! The UGRID of AFLR3, FUN3D and refine: .ugrid (text), .b8.ugrid and .lb8.ugrid (binary, the most or least significant byte first), with
//! the names of the boundaries in .mapbc. Sources: SimCenter's "UGRID 3D Grid File Type", FUN3D's manual. Seven counts, coordinates,
//! triangles, quadrilaterals, references of both, tetrahedra, pyramids, prisms, hexahedra; indices count from 1.
use super::scan::Scan;
use super::text::Text;
use super::{Dataset, error, stacks};
use crate::geometry::{Label, Names};
use crate::mesh::io::{Batch, Error, Read};
use crate::mesh::stack::{Cell, Kind, Stack};
use crate::mesh::{Elements, TetMesh};
use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// How numbers stand in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// Words.
    Text,
    /// Bytes.
    Binary {
        /// Whether the most significant comes first.
        big: bool,
        /// Whether coordinates have 8 bytes, else 4.
        double: bool,
        /// Whether whole numbers have 8 bytes, else 4.
        long: bool,
    },
}

impl Encoding {
    /// By the word before `.ugrid`, as SimCenter and FUN3D write it.
    pub(super) fn of(word: &str) -> Option<Self> {
        let binary = |big, double, long| Some(Self::Binary { big, double, long });
        match word {
            "b8" => binary(true, true, false),
            "lb8" => binary(false, true, false),
            "b4" => binary(true, false, false),
            "lb4" => binary(false, false, false),
            "b8l" => binary(true, true, true),
            "lb8l" => binary(false, true, true),
            "r8" | "lr8" | "r4" | "lr4" => None,
            _ => Some(Self::Text),
        }
    }
}

/// Walks through the numbers of a file.
struct Source<'a> {
    scan: Scan<'a>,
    encoding: Encoding,
}

impl Source<'_> {
    fn fail(&self, message: impl Into<String>) -> Error {
        match self.encoding {
            Encoding::Text => self.scan.fail(message),
            Encoding::Binary { .. } => self.scan.fail_at_byte(message),
        }
    }

    #[inline]
    fn int(&mut self) -> Result<i64, Error> {
        match self.encoding {
            Encoding::Text => self.scan.int(),
            Encoding::Binary { big, long: false, .. } => {
                self.scan.number(big).map(|bytes| i32::from_ne_bytes(bytes).into())
            }
            Encoding::Binary { big, .. } => self.scan.number(big).map(i64::from_ne_bytes),
        }
    }

    #[inline]
    fn real(&mut self) -> Result<f64, Error> {
        match self.encoding {
            Encoding::Text => self.scan.real(),
            Encoding::Binary { big, double: true, .. } => self.scan.number(big).map(f64::from_ne_bytes),
            Encoding::Binary { big, .. } => self.scan.number(big).map(|bytes| f32::from_ne_bytes(bytes).into()),
        }
    }

    fn vertices<const N: usize>(&mut self) -> Result<[u32; N], Error> {
        let mut nodes = [0; N];
        for node in &mut nodes {
            let value = self.int()?;
            *node = u32::try_from(value.wrapping_sub(1))
                .map_err(|_| self.fail(format!("{value} is no number of a vertex; they count from 1")))?;
        }
        Ok(nodes)
    }

    fn elements<const N: usize>(&mut self, count: usize) -> Result<Vec<[u32; N]>, Error> {
        let mut nodes = Vec::with_capacity(self.scan.room(count, 2 * N));
        for _ in 0..count {
            nodes.push(self.vertices()?);
        }
        Ok(nodes)
    }

    fn references(&mut self, count: usize) -> Result<Vec<i32>, Error> {
        let mut refs = Vec::with_capacity(self.scan.room(count, 2));
        for _ in 0..count {
            let value = self.int()?;
            let fits = i32::try_from(value);
            refs.push(fits.map_err(|_| self.fail(format!("the reference {value} does not fit 32 bits")))?);
        }
        Ok(refs)
    }
}

/// Where the nodes of a pyramid stand in the file: UGRID has its apex in the third place (VTK, SU2 and CGNS in the last).
const PYRAMID: [usize; 5] = [1, 0, 3, 4, 2];

/// Reads a grid without what lies beside.
pub(super) fn read(path: &Path, bytes: &[u8], encoding: Encoding) -> Result<Read<Dataset>, Error> {
    let mut source = Source { scan: Scan::new(path, bytes), encoding };
    let mut counts = [0; 7];
    for count in &mut counts {
        let value = source.int()?;
        *count = usize::try_from(value)
            .map_err(|_| source.fail(format!("the count {value} cannot be{}", other(encoding))))?;
    }
    let [vertices, triangles, quadrilaterals, tets, pyramids, prisms, hexahedra] = counts;
    // 24 bytes a vertex, or three digits and blanks.
    if counts.iter().any(|&count| count > source.scan.left()) {
        return Err(
            source.fail(format!("the counts {counts:?} do not fit into the file; it was cut{}", other(encoding)))
        );
    }
    let mut mesh = TetMesh { vertices: Vec::with_capacity(source.scan.room(vertices, 6)), ..TetMesh::default() };
    for _ in 0..vertices {
        mesh.vertices.push([source.real()?, source.real()?, source.real()?]);
    }
    mesh.vertex_refs = vec![0; vertices];
    let (of_triangles, of_quads) = (source.elements(triangles)?, source.elements(quadrilaterals)?);
    mesh.triangles = Elements { nodes: of_triangles, refs: source.references(triangles)? };
    let quads = Elements { nodes: of_quads, refs: source.references(quadrilaterals)? };
    let nodes = source.elements(tets)?;
    mesh.tets = Elements { refs: vec![1; nodes.len()], nodes };
    let mut stack = Stack::default();
    stack.quads = quads;
    let pyramids = source.elements::<5>(pyramids)?.into_iter().map(|nodes| PYRAMID.map(|i| nodes[i]));
    stack.cells.extend(pyramids.map(|nodes| Cell::new(Kind::Pyramid, &nodes, 1)));
    stack.cells.extend(source.elements::<6>(prisms)?.iter().map(|nodes| Cell::new(Kind::Prism, nodes, 1)));
    stack.cells.extend(source.elements::<8>(hexahedra)?.iter().map(|nodes| Cell::new(Kind::Hexahedron, nodes, 1)));
    let mut notices = Vec::new();
    stacks::join(path, &mut mesh, &mut stack, &mut notices)?;
    let left = &bytes[source.scan.at..];
    if !left.trim_ascii().is_empty() {
        notices.push(format!("{}: {} bytes behind the cells are not read", path.display(), left.len()));
    }
    Ok(Read { content: Dataset { mesh, stack, ..Dataset::default() }, notices })
}

/// What else a wrong count may mean.
fn other(encoding: Encoding) -> &'static str {
    match encoding {
        Encoding::Binary { big: true, .. } => ", or the least significant byte comes first: name it .lb8.ugrid then",
        Encoding::Binary { big: false, .. } => ", or the most significant byte comes first: name it .b8.ugrid then",
        Encoding::Text => ", or it is binary: name it .b8.ugrid or .lb8.ugrid then",
    }
}

/// The names file of a grid: grid.mapbc beside grid.b8.ugrid.
pub(super) fn names_path(path: &Path) -> PathBuf {
    let stem = path.with_extension("");
    let word = stem.extension().and_then(|word| word.to_str()).unwrap_or("");
    let is_encoding = !word.is_empty() && !matches!(Encoding::of(&word.to_ascii_lowercase()), Some(Encoding::Text));
    if is_encoding { stem.with_extension("mapbc") } else { path.with_extension("mapbc") }
}

/// A line of a names file: reference, boundary condition, name.
fn rows(path: &Path, bytes: &[u8]) -> Result<Vec<(i32, i64, String)>, Error> {
    let mut scan = Scan::new(path, bytes);
    let line = scan.line().unwrap_or_default();
    let count = scan.count(line)?;
    let mut rows = Vec::new();
    while rows.len() < count {
        let Some(line) = scan.line() else {
            return Err(scan.fail(format!(
                "{} boundaries are said to be there, and {} are; correct the count",
                count,
                rows.len()
            )));
        };
        if line.is_empty() {
            continue;
        }
        let text = String::from_utf8_lossy(line);
        let mut words = text.split_ascii_whitespace();
        let number = |word: Option<&str>| word.and_then(|word| word.parse::<i64>().ok());
        let (reference, condition) = (number(words.next()), number(words.next()));
        let (Some(reference), Some(condition)) = (reference.and_then(|r| i32::try_from(r).ok()), condition) else {
            return Err(scan.fail("the number of a boundary, its condition and its name are expected: 1 4000 wing"));
        };
        rows.push((reference, condition, words.collect::<Vec<_>>().join(" ")));
    }
    Ok(rows)
}

/// Reads the names that lie beside.
pub(super) fn read_beside(path: &Path, names: &mut Names) -> Result<(), Error> {
    let beside = names_path(path);
    if !beside.exists() {
        return Ok(());
    }
    for (reference, _, name) in rows(&beside, &error::read(&beside)?)? {
        if !name.is_empty() {
            names.triangles.insert(reference, Label { name: Some(name), colour: None });
        }
    }
    Ok(())
}

/// Writes a grid, and its names beside it where it has some. Boundary conditions that are there already stay; new boundaries have 0.
pub(super) fn write(batch: &mut Batch, path: &Path, data: &Dataset, encoding: Encoding) -> Result<Vec<String>, Error> {
    let mesh = &data.mesh;
    if encoding != Encoding::Text
        && mesh.vertices.len().max(mesh.tets.len()) > i32::MAX as usize
        && !matches!(encoding, Encoding::Binary { long: true, .. })
    {
        return Err(error::at(path, "counts", "they do not fit 32 bits; write .lb8l.ugrid"));
    }
    batch.add_main(path, |to| emit(to, (mesh, &data.stack), encoding))?;
    let references: BTreeSet<i32> = mesh.triangles.refs.iter().chain(&data.stack.quads.refs).copied().collect();
    let name = |reference: &i32| data.names.triangles.get(reference).and_then(|label| label.name.clone());
    let beside = names_path(path);
    if !references.iter().any(|reference| name(reference).is_some()) && !beside.exists() {
        return Ok(Vec::new());
    }
    let old: BTreeMap<i32, i64> = if beside.is_file() {
        rows(&beside, &error::read(&beside)?)?
            .into_iter()
            .map(|(reference, condition, _)| (reference, condition))
            .collect()
    } else {
        BTreeMap::new()
    };
    batch.add(&beside, |to| {
        writeln!(to, "{}", references.len())?;
        for reference in &references {
            let name = name(reference).unwrap_or_default();
            let name = name.split_whitespace().collect::<Vec<_>>().join(" ");
            writeln!(to, "{}", format!("{reference} {} {name}", old.get(reference).unwrap_or(&0)).trim_end())?;
        }
        Ok(())
    })?;
    let mut notices = vec![format!("the names are in {}", beside.display())];
    let new = references.iter().filter(|reference| !old.contains_key(reference)).count();
    if new > 0 {
        notices.push(format!("{new} boundaries have the condition 0 there; write those of your solver"));
    }
    Ok(notices)
}

fn emit(to: &mut dyn Write, (mesh, stack): (&TetMesh, &Stack), encoding: Encoding) -> io::Result<()> {
    let mut text = Text::new(to);
    let int = |text: &mut Text, value: i64| match encoding {
        Encoding::Text => text.int(value),
        Encoding::Binary { big: true, long: true, .. } => text.raw(&value.to_be_bytes()),
        Encoding::Binary { big: false, long: true, .. } => text.raw(&value.to_le_bytes()),
        Encoding::Binary { big: true, .. } => text.raw(&(value as i32).to_be_bytes()),
        Encoding::Binary { .. } => text.raw(&(value as i32).to_le_bytes()),
    };
    let real = |text: &mut Text, value: f64| match encoding {
        Encoding::Text => text.real(value),
        Encoding::Binary { big: true, double: true, .. } => text.raw(&value.to_be_bytes()),
        Encoding::Binary { double: true, .. } => text.raw(&value.to_le_bytes()),
        Encoding::Binary { big: true, .. } => text.raw(&(value as f32).to_be_bytes()),
        Encoding::Binary { .. } => text.raw(&(value as f32).to_le_bytes()),
    };
    let end_row = |text: &mut Text| if encoding == Encoding::Text { text.end_line() } else { text.hand_on() };
    let [pyramids, prisms, hexahedra] = stack.counts();
    let [vertices, triangles, quads, tets] =
        [mesh.vertices.len(), mesh.triangles.len(), stack.quads.len(), mesh.tets.len()];
    [vertices, triangles, quads, tets, pyramids, prisms, hexahedra]
        .iter()
        .for_each(|&count| int(&mut text, count as i64));
    end_row(&mut text)?;
    for point in &mesh.vertices {
        point.iter().for_each(|&x| real(&mut text, x));
        end_row(&mut text)?;
    }
    let row = |text: &mut Text, nodes: &[u32]| {
        nodes.iter().for_each(|&v| int(text, i64::from(v) + 1));
        end_row(text)
    };
    mesh.triangles.nodes.iter().try_for_each(|nodes| row(&mut text, nodes))?;
    stack.quads.nodes.iter().try_for_each(|nodes| row(&mut text, nodes))?;
    for &reference in mesh.triangles.refs.iter().chain(&stack.quads.refs) {
        int(&mut text, reference.into());
        end_row(&mut text)?;
    }
    mesh.tets.nodes.iter().try_for_each(|nodes| row(&mut text, nodes))?;
    for cell in stack.cells_of(Kind::Pyramid) {
        let mut nodes = [0; 5];
        PYRAMID.iter().zip(cell.nodes()).for_each(|(&place, &v)| nodes[place] = v);
        row(&mut text, &nodes)?;
    }
    let others = stack.cells_of(Kind::Prism).chain(stack.cells_of(Kind::Hexahedron));
    others.into_iter().try_for_each(|cell| row(&mut text, cell.nodes()))?;
    text.finish()
}
