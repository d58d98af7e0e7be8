//! Meshes of Abaqus and CalculiX (.inp): nodes, tetrahedra (C3D4), shells of three nodes, trusses and beams of two, and sets of elements and
//! surfaces that name them. Source: CalculiX's manual; Abaqus' "Input Syntax Rules". Words count whatever their case; what is between them
//! (materials, steps) is passed over.
mod sets;
mod write;

pub(super) use write::write;

use super::scan::Scan;
use super::sets::{Kind, Meaning};
use super::tags::Tags;
use super::{Dataset, error};
use crate::mesh::Elements;
use crate::mesh::io::number::{parse_int, parse_real};
use crate::mesh::io::{Error, Read};
use std::path::Path;

/// Elements of three nodes in space or in a plane.
const SHELLS: [&str; 14] =
    ["S3", "S3R", "S3RS", "S3T", "STRI3", "M3D3", "R3D3", "SFM3D3", "CPS3", "CPE3", "CAX3", "DS3", "DC2D3", "AC2D3"];

/// Elements of two nodes.
const LINES: [&str; 12] =
    ["T3D2", "T3D2H", "T3D2T", "T2D2", "B31", "B31H", "B31R", "B31OS", "B21", "B21H", "RB3D2", "R2D2"];

/// What begins the names of elements that are no part of a mesh.
const OTHERS: [&str; 9] = ["MASS", "SPRING", "DASHPOT", "CONN", "GAP", "DCOUP", "ROTARYI", "HEATCAP", "ITT"];

/// What the data lines that follow are.
enum Block {
    Nothing,
    Nodes,
    Elements {
        kind: Kind,
        group: usize,
    },
    /// Numbers of elements, or names of sets; or first, last and step of a row of numbers.
    Set {
        set: usize,
        is_row: bool,
    },
    /// A set or element and its side.
    Surface {
        set: usize,
    },
}

/// Elements of a kind: their numbers, nodes by number, and groups.
#[derive(Default)]
struct List<const N: usize> {
    numbers: Vec<usize>,
    nodes: Vec<[usize; N]>,
    groups: Vec<usize>,
}

/// Elements with the same reference.
struct Group {
    kind: Kind,
    name: String,
    noted: Option<Meaning>,
}

/// A set of elements, or a surface with the sides of its elements.
struct Set {
    name: String,
    is_surface: bool,
    elements: Vec<usize>,
    sides: Vec<(usize, u8)>,
    /// Sets that are in it, with their side if it is a surface.
    sets: Vec<(String, u8)>,
}

struct Reader<'a> {
    path: &'a Path,
    scan: Scan<'a>,
    numbers: Vec<usize>,
    data: Dataset,
    tets: List<4>,
    triangles: List<3>,
    edges: List<2>,
    groups: Vec<Group>,
    sets: Vec<Set>,
    /// What the last comment said.
    noted: Option<Meaning>,
    notices: Vec<String>,
}

/// Reads a mesh.
pub(super) fn read(path: &Path, bytes: &[u8]) -> Result<Read<Dataset>, Error> {
    let mut reader = Reader {
        path,
        scan: Scan::new(path, bytes),
        numbers: Vec::new(),
        data: Dataset::default(),
        tets: List::default(),
        triangles: List::default(),
        edges: List::default(),
        groups: Vec::new(),
        sets: Vec::new(),
        noted: None,
        notices: Vec::new(),
    };
    reader.lines()?;
    if reader.data.mesh.vertices.is_empty() {
        return Err(reader.scan.fail("there are no nodes (*NODE); give a mesh of Abaqus or CalculiX"));
    }
    reader.data.mesh.vertex_refs = vec![0; reader.data.mesh.vertices.len()];
    reader.resolve_sets();
    reader.elements()?;
    Ok(Read { content: reader.data, notices: reader.notices })
}

/// The words between commas.
fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(|&byte| byte == b',').map(<[u8]>::trim_ascii)
}

/// The value of a parameter of a keyword.
fn parameter<'l>(line: &'l str, name: &str) -> Option<&'l str> {
    let found = line.split(',').skip(1).find_map(|word| {
        let (key, value) = word.split_once('=').unwrap_or((word, ""));
        key.trim().eq_ignore_ascii_case(name).then_some(value)
    });
    found.map(|value| value.trim().trim_matches('"'))
}

impl Reader<'_> {
    fn lines(&mut self) -> Result<(), Error> {
        let mut block = Block::Nothing;
        while let Some(line) = self.scan.line() {
            if let Some(comment) = line.strip_prefix(b"**") {
                self.noted = Meaning::noted(&String::from_utf8_lossy(comment)).or(self.noted.take());
            } else if line.starts_with(b"*") {
                let mut text = String::from_utf8_lossy(line).into_owned();
                while text.ends_with(',')
                    && let Some(more) = self.scan.line()
                {
                    text += &String::from_utf8_lossy(more);
                }
                block = self.keyword(&text)?;
                self.noted = None;
            } else if !line.is_empty() {
                self.data_line(&block, line)?;
            }
        }
        Ok(())
    }

    fn keyword(&mut self, line: &str) -> Result<Block, Error> {
        let key = line.split(',').next().unwrap_or_default().trim().to_ascii_uppercase();
        Ok(match key.as_str() {
            "*NODE" if parameter(line, "SYSTEM").is_some_and(|system| !system.eq_ignore_ascii_case("R")) => {
                return Err(self.scan.fail("nodes in another coordinate system are not read; write Cartesian ones"));
            }
            "*NODE" => Block::Nodes,
            "*ELEMENT" => self.elements_of(line)?,
            "*ELSET" => {
                let Some(name) = parameter(line, "ELSET") else { return Err(self.scan.fail("ELSET= is missing here")) };
                Block::Set { set: self.set(name, false), is_row: parameter(line, "GENERATE").is_some() }
            }
            "*SURFACE" => {
                let is_of_elements = parameter(line, "TYPE").is_none_or(|kind| kind.eq_ignore_ascii_case("ELEMENT"));
                match parameter(line, "NAME") {
                    Some(name) if is_of_elements => Block::Surface { set: self.set(name, true) },
                    _ => Block::Nothing,
                }
            }
            "*INCLUDE" => {
                return Err(self.scan.fail("other files are not included; give one file with all of the mesh"));
            }
            "*NGEN" | "*NFILL" | "*NCOPY" | "*ELGEN" | "*ELCOPY" => {
                return Err(self
                    .scan
                    .fail(format!("{key} makes nodes or elements that are not in the file; write them out")));
            }
            _ => Block::Nothing,
        })
    }

    fn elements_of(&mut self, line: &str) -> Result<Block, Error> {
        let kind = parameter(line, "TYPE").unwrap_or_default().to_ascii_uppercase();
        let found = match kind.as_str() {
            "C3D4" | "C3D4H" | "C3D4P" | "C3D4T" | "DC3D4" | "AC3D4" | "F3D4" | "C3D4E" => Kind::Tetrahedra,
            shell if SHELLS.contains(&shell) => Kind::Triangles,
            line if LINES.contains(&line) => Kind::Edges,
            other if OTHERS.iter().any(|start| other.starts_with(start)) => {
                self.notices.push(format!("elements of type {} are left out", error::short(other)));
                return Ok(Block::Nothing);
            }
            other => {
                let other = error::short(other);
                let message = format!(
                    "elements of type {other}: tetrahedra (C3D4), triangles (S3) and lines (T3D2) are read; split the others"
                );
                return Err(self.scan.fail(message));
            }
        };
        let name = parameter(line, "ELSET").unwrap_or_default();
        let noted = self.noted.take().filter(|noted| noted.kind == found);
        let group = self.group(found, name, noted);
        Ok(Block::Elements { kind: found, group })
    }

    /// The group of such a name, a new one where there is none.
    fn group(&mut self, kind: Kind, name: &str, noted: Option<Meaning>) -> usize {
        let is_it = |group: &Group| group.kind == kind && group.noted == noted && group.name.eq_ignore_ascii_case(name);
        self.groups.iter().position(is_it).unwrap_or_else(|| {
            self.groups.push(Group { kind, name: name.to_owned(), noted });
            self.groups.len() - 1
        })
    }

    fn set(&mut self, name: &str, is_surface: bool) -> usize {
        let is_it = |set: &Set| set.is_surface == is_surface && set.name.eq_ignore_ascii_case(name);
        self.sets.iter().position(is_it).unwrap_or_else(|| {
            let (elements, sides, sets) = (Vec::new(), Vec::new(), Vec::new());
            self.sets.push(Set { name: name.to_owned(), is_surface, elements, sides, sets });
            self.sets.len() - 1
        })
    }

    fn data_line(&mut self, block: &Block, line: &[u8]) -> Result<(), Error> {
        match *block {
            Block::Nothing => {}
            Block::Nodes => {
                let mut words = words(line);
                let number = self.number(words.next())?;
                let mut point = [0.0; 3];
                for (x, word) in point.iter_mut().zip(words.filter(|word| !word.is_empty())) {
                    *x = parse_real(word).map_err(|message| self.scan.fail(message))?;
                }
                self.numbers.push(number);
                self.data.mesh.vertices.push(point);
            }
            Block::Elements { kind: Kind::Tetrahedra, group } => {
                let (number, nodes) = self.element(line)?;
                self.tets.push(number, nodes, group);
            }
            Block::Elements { kind: Kind::Triangles, group } => {
                let (number, nodes) = self.element(line)?;
                self.triangles.push(number, nodes, group);
            }
            Block::Elements { kind: Kind::Edges, group } => {
                let (number, nodes) = self.element(line)?;
                self.edges.push(number, nodes, group);
            }
            Block::Set { set, is_row: true } => {
                let mut words = words(line).filter(|word| !word.is_empty());
                let (first, last) = (self.number(words.next())?, self.number(words.next())?);
                let step = words.next().map_or(Ok(1), |word| self.number(Some(word)))?.max(1);
                // A row that no file of this size can hold is wrong, or of elements that are not there.
                let most = self.tets.numbers.len() + self.triangles.numbers.len() + self.edges.numbers.len();
                self.sets[set].elements.extend((first..=last).step_by(step).take(most));
            }
            Block::Set { set, .. } => {
                for word in words(line).filter(|word| !word.is_empty()) {
                    match parse_int(word).ok().and_then(|number| usize::try_from(number).ok()) {
                        Some(number) => self.sets[set].elements.push(number),
                        None => self.sets[set].sets.push((String::from_utf8_lossy(word).into_owned(), 0)),
                    }
                }
            }
            Block::Surface { set } => self.side(set, line),
        }
        Ok(())
    }

    /// A line of a surface: a set or an element, and the side S1 to S4. Sides of shells are the shells themselves.
    fn side(&mut self, set: usize, line: &[u8]) {
        let mut words = words(line);
        let (of, side) = (words.next().unwrap_or_default(), words.next().unwrap_or_default());
        let side = match side {
            [b'S' | b's', digit @ b'1'..=b'4'] => digit - b'0',
            _ => 0,
        };
        match parse_int(of).ok().and_then(|number| usize::try_from(number).ok()) {
            Some(number) if side > 0 => self.sets[set].sides.push((number, side)),
            Some(number) => self.sets[set].elements.push(number),
            None => self.sets[set].sets.push((String::from_utf8_lossy(of).into_owned(), side)),
        }
    }

    fn number(&self, word: Option<&[u8]>) -> Result<usize, Error> {
        let number = parse_int(word.unwrap_or_default()).map_err(|message| self.scan.fail(message))?;
        usize::try_from(number).map_err(|_| self.scan.fail(format!("{number} is no number of a node or element")))
    }

    fn element<const N: usize>(&self, line: &[u8]) -> Result<(usize, [usize; N]), Error> {
        let mut words = words(line);
        let number = self.number(words.next())?;
        let mut nodes = [0; N];
        for node in &mut nodes {
            *node = self.number(words.next())?;
        }
        match words.next() {
            None | Some(b"") => Ok((number, nodes)),
            // Beams may name a node for their direction.
            Some(_) if N == 2 => Ok((number, nodes)),
            Some(_) => Err(self.scan.fail(format!("element {number} has more than {N} nodes"))),
        }
    }

    /// From nodes by number to elements with their references and names.
    fn elements(&mut self) -> Result<(), Error> {
        let tags = Tags::new(&self.numbers).map_err(|twice| {
            error::at(self.path, "*NODE", format!("node {twice} is there twice; give a mesh of one part"))
        })?;
        let references = sets::references(&self.groups);
        for (group, &reference) in self.groups.iter().zip(&references) {
            let name = match &group.noted {
                Some(noted) => noted.name.clone(),
                None => Some(group.name.clone()).filter(|name| !name.is_empty() && *name != reference.to_string()),
            };
            if let Some(name) = name {
                group.kind.call(&mut self.data.names, reference, name);
            }
        }
        let mesh = &mut self.data.mesh;
        self.tets.resolve(self.path, &tags, &references, &mut mesh.tets)?;
        self.triangles.resolve(self.path, &tags, &references, &mut mesh.triangles)?;
        self.edges.resolve(self.path, &tags, &references, &mut mesh.edges)
    }
}

impl<const N: usize> List<N> {
    fn push(&mut self, number: usize, nodes: [usize; N], group: usize) {
        self.numbers.push(number);
        self.nodes.push(nodes);
        self.groups.push(group);
    }

    fn resolve(&self, path: &Path, tags: &Tags, references: &[i32], to: &mut Elements<N>) -> Result<(), Error> {
        for ((nodes, &group), number) in self.nodes.iter().zip(&self.groups).zip(&self.numbers) {
            let mut found = [0; N];
            for (place, &node) in found.iter_mut().zip(nodes) {
                *place = tags.place(node).ok_or_else(|| {
                    error::at(path, format!("element {number}"), format!("it has the node {node}, which is not there"))
                })?;
            }
            to.push(found, references[group]);
        }
        Ok(())
    }
}
