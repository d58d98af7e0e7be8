//! Bulk data of Nastran (.bdf, .nas, .dat is SU2's): GRID, CTETRA, CTRIA3 and CTRIAR, CROD, CBAR, CBEAM, in small, large and free fields.
//! Source: MSC Nastran's Quick Reference Guide, "Format of Bulk Data Entries". References are the numbers of properties; their names are told
//! by comments: ours, HyperMesh's $HMNAME and ANSA's. Other entries are passed over.
mod card;
mod write;

pub(super) use write::write;

use super::scan::Scan;
use super::sets::{Kind, Meaning};
use super::tags::Tags;
use super::{Dataset, error};
use crate::mesh::Elements;
use crate::mesh::io::number::parse_int;
use crate::mesh::io::{Error, Read};
use card::{Card, real};
use std::collections::BTreeMap;
use std::path::Path;

/// What comments of ours begin with, before the number of the property.
const PROPERTY: &str = "property ";

/// Entries of elements that a mesh of tetrahedra has not.
const OTHERS: [&[u8]; 14] = [
    b"CHEXA", b"CPENTA", b"CPYRA", b"CPYRAM", b"CQUAD4", b"CQUADR", b"CQUAD8", b"CQUAD", b"CSHEAR", b"CTRIA6",
    b"CTRIAX", b"CTRIAX6", b"CBEND", b"CBEAM3",
];

/// Elements of a kind: nodes and properties by number.
#[derive(Default)]
struct List<const N: usize> {
    nodes: Vec<[usize; N]>,
    properties: Vec<i32>,
    /// Lines of the elements, for errors.
    places: Vec<usize>,
}

struct Reader<'a> {
    path: &'a Path,
    scan: Scan<'a>,
    numbers: Vec<usize>,
    data: Dataset,
    tets: List<4>,
    triangles: List<3>,
    edges: List<2>,
    /// What properties stand for, by our comments.
    noted: BTreeMap<i32, Meaning>,
    /// Their names, by those of other programs.
    called: BTreeMap<i32, String>,
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
        noted: BTreeMap::new(),
        called: BTreeMap::new(),
        notices: Vec::new(),
    };
    reader.lines()?;
    if reader.data.mesh.vertices.is_empty() {
        return Err(reader.scan.fail("there are no grid points (GRID); give a mesh in Nastran's bulk data"));
    }
    reader.data.mesh.vertex_refs = vec![0; reader.data.mesh.vertices.len()];
    reader.elements()?;
    Ok(Read { content: reader.data, notices: reader.notices })
}

impl<'a> Reader<'a> {
    fn lines(&mut self) -> Result<(), Error> {
        let mut card = Card::default();
        let mut number = 0;
        while let Some(line) = self.scan.raw_line() {
            number += 1;
            if let Some(comment) = line.strip_prefix(b"$") {
                self.comment(&String::from_utf8_lossy(comment));
                continue;
            }
            if card.goes_on(line) {
                continue;
            }
            self.card(&card)?;
            card.begin(line, number);
            if card.name.eq_ignore_ascii_case(b"ENDDATA") {
                return Ok(());
            }
        }
        self.card(&card)
    }

    /// Names of properties: `$ property 12 geo-adapt: triangles 7 called wing`, `$HMNAME PROP 12"wing"`,
    /// `$ANSA_NAME_COMMENT;12;PSHELL;wing;`.
    fn comment(&mut self, text: &str) {
        if let Some(rest) = text.trim().strip_prefix(PROPERTY) {
            let told =
                rest.split_once(' ').and_then(|(number, rest)| Some((number.parse().ok()?, Meaning::noted(rest)?)));
            self.noted.extend(told);
        } else if let Some(rest) = text.strip_prefix("HMNAME PROP") {
            let told = rest.split_once('"').and_then(|(number, name)| Some((number.trim().parse().ok()?, name)));
            self.called.extend(told.map(|(number, name)| (number, name.trim_end().trim_end_matches('"').to_owned())));
        } else if let Some(rest) = text.strip_prefix("ANSA_NAME_COMMENT;") {
            let mut words = rest.split(';');
            if let (Some(Ok(number)), Some(kind), Some(name)) =
                (words.next().map(str::parse), words.next(), words.next())
                && ["PSOLID", "PSHELL", "PBAR", "PROD", "PBEAM"].contains(&kind)
            {
                self.called.insert(number, name.to_owned());
            }
        }
    }

    fn fail(&self, card: &Card, message: impl Into<String>) -> Error {
        error::at(self.path, format!("line {}", card.line), message)
    }

    fn card(&mut self, card: &Card<'a>) -> Result<(), Error> {
        let name = card.name.to_ascii_uppercase();
        match name.as_slice() {
            b"GRID" => self.grid(card),
            b"CTETRA" => {
                let (nodes, property) = self.element(card)?;
                self.tets.push(nodes, property, card.line);
                Ok(())
            }
            b"CTRIA3" | b"CTRIAR" => {
                let (nodes, property) = self.element(card)?;
                self.triangles.push(nodes, property, card.line);
                Ok(())
            }
            b"CROD" | b"CBAR" | b"CBEAM" => {
                let (nodes, property) = self.element(card)?;
                self.edges.push(nodes, property, card.line);
                Ok(())
            }
            b"INCLUDE" => Err(self.fail(card, "other files are not included; give one file with all of the mesh")),
            name if OTHERS.contains(&name) => {
                let name = String::from_utf8_lossy(name);
                Err(self.fail(card, format!("{name}: CTETRA, CTRIA3 and CROD are read; split the others")))
            }
            _ => Ok(()),
        }
    }

    fn grid(&mut self, card: &Card<'a>) -> Result<(), Error> {
        let number = self.number(card, 0)?;
        if ![&b""[..], b"0"].contains(&card.field(1)) {
            return Err(self.fail(card, "the point is in a coordinate system of its own; write it in the basic one"));
        }
        let mut point = [0.0; 3];
        for (k, x) in point.iter_mut().enumerate() {
            let field = card.field(2 + k);
            if !field.is_empty() {
                *x = real(field).map_err(|message| self.fail(card, message))?;
            }
        }
        self.numbers.push(number);
        self.data.mesh.vertices.push(point);
        Ok(())
    }

    fn number(&self, card: &Card, field: usize) -> Result<usize, Error> {
        let word = card.field(field);
        let number = parse_int(word).map_err(|message| self.fail(card, message))?;
        usize::try_from(number).map_err(|_| self.fail(card, format!("{number} is no number of a point or element")))
    }

    fn element<const N: usize>(&self, card: &Card) -> Result<([usize; N], i32), Error> {
        let own = self.number(card, 0)?;
        // Without a property it has that of its own number.
        let property = if card.field(1).is_empty() { own } else { self.number(card, 1)? };
        let property = i32::try_from(property)
            .map_err(|_| self.fail(card, format!("the property {property} does not fit 32 bits; renumber them")))?;
        let mut nodes = [0; N];
        for (k, node) in nodes.iter_mut().enumerate() {
            *node = self.number(card, 2 + k)?;
        }
        let is_curved = N == 4 && (6..12).any(|field| !card.field(field).is_empty());
        if is_curved {
            return Err(self.fail(card, "a tetrahedron of ten points; write elements of the first order"));
        }
        Ok((nodes, property))
    }

    /// From points by number to elements with their references and names.
    fn elements(&mut self) -> Result<(), Error> {
        let tags = Tags::new(&self.numbers)
            .map_err(|twice| error::at(self.path, "GRID", format!("point {twice} is there twice; leave one out")))?;
        let mesh = &mut self.data.mesh;
        self.tets.resolve(self.path, &tags, &mut mesh.tets)?;
        self.triangles.resolve(self.path, &tags, &mut mesh.triangles)?;
        self.edges.resolve(self.path, &tags, &mut mesh.edges)?;
        for kind in Kind::ALL {
            let refs = match kind {
                Kind::Tetrahedra => &mut mesh.tets.refs,
                Kind::Triangles => &mut mesh.triangles.refs,
                Kind::Edges => &mut mesh.edges.refs,
            };
            let properties: std::collections::BTreeSet<i32> = refs.iter().copied().collect();
            let noted = |property: &i32| self.noted.get(property).filter(|noted| noted.kind == kind);
            for reference in &mut *refs {
                *reference = noted(reference).map_or(*reference, |noted| noted.reference);
            }
            for property in &properties {
                let (reference, name) = match noted(property) {
                    Some(noted) => (noted.reference, noted.name.clone()),
                    None => (*property, self.called.get(property).cloned()),
                };
                if let Some(name) = name {
                    kind.call(&mut self.data.names, reference, name);
                }
            }
        }
        Ok(())
    }
}

impl<const N: usize> List<N> {
    fn push(&mut self, nodes: [usize; N], property: i32, line: usize) {
        self.nodes.push(nodes);
        self.properties.push(property);
        self.places.push(line);
    }

    fn resolve(&self, path: &Path, tags: &Tags, to: &mut Elements<N>) -> Result<(), Error> {
        for ((nodes, &property), line) in self.nodes.iter().zip(&self.properties).zip(&self.places) {
            let mut found = [0; N];
            for (place, &node) in found.iter_mut().zip(nodes) {
                let missing = || format!("the point {node} is not there; write its GRID");
                *place = tags.place(node).ok_or_else(|| error::at(path, format!("line {line}"), missing()))?;
            }
            to.push(found, property);
        }
        Ok(())
    }
}
