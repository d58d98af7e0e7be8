//! The elements of an .xdmf as a tree.
use super::super::error;
use crate::mesh::io::Error;
use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};
use std::borrow::Cow;
use std::path::Path;

/// Elements within each other at most. (Those of a file of many are as deep as it is long, and a tree is dropped level by level.)
const DEEPEST: usize = 64;

/// An element.
#[derive(Debug, Default)]
pub(super) struct Element<'a> {
    pub name: String,
    pub attributes: Vec<(String, String)>,
    pub children: Vec<Element<'a>>,
    pub text: Cow<'a, str>,
    /// Its line.
    pub line: usize,
}

impl<'a> Element<'a> {
    /// An attribute.
    pub fn get(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(other, _)| other == name).map(|(_, value)| value.trim())
    }

    /// The children of a name.
    pub fn all<'e>(&'e self, name: &'e str) -> impl Iterator<Item = &'e Element<'a>> {
        self.children.iter().filter(move |child| child.name == name)
    }

    /// An error here.
    pub fn fail(&self, path: &Path, message: impl Into<String>) -> Error {
        error::at(path, format!("line {}", self.line), message)
    }
}

/// Reads the tree: an element without a name that holds the outermost ones.
pub(super) fn tree<'a>(path: &Path, text: &'a str) -> Result<Element<'a>, Error> {
    let mut reader = Reader::from_str(text);
    let mut open = vec![Element::default()];
    let (mut line, mut seen) = (1, 0);
    loop {
        let at = (reader.buffer_position() as usize).min(text.len());
        line += text.as_bytes()[seen..at].iter().filter(|&&byte| byte == b'\n').count();
        seen = at;
        let fail = |message: String| error::at(path, format!("line {line}"), message);
        let event = reader.read_event().map_err(|error| fail(format!("no XML ({})", brief(&error))))?;
        let Some(inner) = open.last_mut() else { return Err(fail("an element ends that did not begin".into())) };
        match event {
            Event::Start(tag) => {
                if open.len() > DEEPEST {
                    return Err(fail("the elements stand too deep within each other".into()));
                }
                let element = element(&tag, line).map_err(fail)?;
                open.push(element);
            }
            Event::Empty(tag) => inner.children.push(element(&tag, line).map_err(fail)?),
            Event::End(_) => {
                let done = open.pop().unwrap_or_default();
                let Some(outer) = open.last_mut() else {
                    return Err(fail("an element ends that did not begin".into()));
                };
                outer.children.push(done);
            }
            Event::Text(part) => add(inner, part.into_inner()),
            Event::CData(part) => add(inner, part.into_inner()),
            Event::GeneralRef(reference) => {
                let known = match &*reference {
                    "lt" => Some('<'),
                    "gt" => Some('>'),
                    "amp" => Some('&'),
                    "quot" => Some('"'),
                    "apos" => Some('\''),
                    _ => reference.resolve_char_ref().ok().flatten(),
                };
                let known =
                    known.ok_or_else(|| fail(format!("the entity {} is not known", error::short(&reference))))?;
                inner.text.to_mut().push(known);
            }
            Event::Eof if open.len() > 1 => return Err(fail("the file ends within an element; it was cut".into())),
            Event::Eof => return Ok(open.pop().unwrap_or_default()),
            _ => {}
        }
    }
}

fn add<'a>(to: &mut Element<'a>, part: Cow<'a, str>) {
    if to.text.trim_ascii().is_empty() {
        to.text = part;
    } else if !part.is_empty() {
        to.text.to_mut().push_str(&part);
    }
}

fn element<'a>(tag: &BytesStart, line: usize) -> Result<Element<'a>, String> {
    let mut attributes = Vec::new();
    for attribute in tag.attributes().with_checks(false) {
        let wrong = |error: &dyn std::fmt::Display| format!("an attribute is wrong ({})", brief(error));
        let attribute = attribute.map_err(|error| wrong(&error))?;
        let value = attribute.normalized_value(XmlVersion::Implicit1_0).map_err(|error| wrong(&error))?;
        attributes.push((attribute.key.as_ref().to_owned(), value.into_owned()));
    }
    Ok(Element { name: tag.name().as_ref().to_owned(), attributes, line, ..Element::default() })
}

/// What is wrong with the XML; elements of damaged files can have very long names.
fn brief(error: &dyn std::fmt::Display) -> String {
    error.to_string().chars().take(120).flat_map(char::escape_debug).collect()
}
