//! References of the elements of a zone: of our own descriptors, or by boundary conditions and sections.
use super::super::Dataset;
use super::{Element, Labels, Node, Section};
use crate::mesh::io::Error;
use crate::mesh::stack::Kind;
use std::collections::{BTreeMap, HashSet};

/// What no condition is of, until it has its section's.
const NONE: i32 = i32::MIN;

/// Gives the elements of a zone their references, and these names.
pub(super) fn refer(
    zone: &Node<'_>,
    base: usize,
    sections: &[Section],
    data: &mut Dataset,
    labels: &mut Labels,
) -> Result<(), Error> {
    if sections.iter().all(|section| section.reference.is_some()) {
        for section in sections {
            let reference = section.reference.unwrap_or(1);
            section.elements.iter().for_each(|&element| set(data, element, reference));
            if let (Some(name), Some(&element)) = (&section.called, section.elements.first()) {
                labels.call(dimension(element), reference, name);
            }
        }
        return Ok(());
    }
    let all = || sections.iter().flat_map(|section| section.elements.iter().map(move |&element| (section, element)));
    all().for_each(|(_, element)| set(data, element, NONE));
    for conditions in zone.labelled("ZoneBC_t")? {
        for condition in conditions.labelled("BC_t")? {
            let name = condition.text_of("FamilyName").filter(|name| !name.is_empty());
            let name = name.unwrap_or_else(|| condition.name.clone());
            for element in elements_of(&condition, base, sections, data)? {
                let reference = labels.reference(dimension(element), &name);
                set(data, element, reference);
            }
        }
    }
    // Where no kind of cells has several sections these are no regions that need names.
    let mut volumes: BTreeMap<Option<Kind>, usize> = BTreeMap::new();
    for element in sections.iter().filter_map(|section| section.elements.first()) {
        match *element {
            Element::Tet(_) => *volumes.entry(None).or_default() += 1,
            Element::Cell(at) => *volumes.entry(Some(data.stack.cells[at].kind)).or_default() += 1,
            _ => {}
        }
    }
    let is_one = volumes.values().all(|&count| count == 1);
    for (section, element) in all() {
        if reference(data, element) != NONE {
            continue;
        }
        let dimension = dimension(element);
        let given = if dimension == 3 && is_one { 1 } else { labels.reference(dimension, &section.name) };
        set(data, element, given);
    }
    Ok(())
}

/// The elements that a condition is of.
fn elements_of(condition: &Node<'_>, base: usize, sections: &[Section], data: &Dataset) -> Result<Vec<Element>, Error> {
    let list = |name: &str| condition.child(name).map(|node| node.ints()).transpose();
    let (of_elements, of_points) = (list("ElementRange")?, list("PointRange")?);
    let location = condition.text_of("GridLocation").unwrap_or_else(|| "Vertex".into());
    let (range, numbers, at_points) = match (of_elements, list("ElementList")?, of_points) {
        (Some(range), ..) => (Some(range), None, false),
        (_, Some(numbers), _) => (None, Some(numbers), false),
        (_, _, Some(range)) => (Some(range), None, location == "Vertex"),
        _ => (None, list("PointList")?, location == "Vertex"),
    };
    let is_in: Box<dyn Fn(i64) -> bool> = match (range.as_deref(), numbers) {
        (Some(&[first, last]), _) => Box::new(move |number| (first..=last).contains(&number)),
        (_, Some(numbers)) => {
            let all: HashSet<i64> = numbers.into_iter().collect();
            Box::new(move |number| all.contains(&number))
        }
        _ => return Ok(Vec::new()),
    };
    let has = |v: &u32| is_in(*v as i64 - base as i64 + 1);
    let mut found = Vec::new();
    for section in sections {
        for (&element, number) in section.elements.iter().zip(section.first..) {
            let is_of = match element {
                _ if !at_points => is_in(number),
                Element::Triangle(at) => data.mesh.triangles.nodes[at].iter().all(has),
                Element::Quad(at) => data.stack.quads.nodes[at].iter().all(has),
                _ => false,
            };
            found.extend(is_of.then_some(element));
        }
    }
    Ok(found)
}

fn dimension(element: Element) -> usize {
    match element {
        Element::Tet(_) | Element::Cell(_) => 3,
        Element::Triangle(_) | Element::Quad(_) => 2,
        Element::Edge(_) => 1,
        Element::Other => 0,
    }
}

fn set(data: &mut Dataset, element: Element, reference: i32) {
    match element {
        Element::Tet(at) => data.mesh.tets.refs[at] = reference,
        Element::Cell(at) => data.stack.cells[at].reference = reference,
        Element::Triangle(at) => data.mesh.triangles.refs[at] = reference,
        Element::Quad(at) => data.stack.quads.refs[at] = reference,
        Element::Edge(at) => data.mesh.edges.refs[at] = reference,
        Element::Other => {}
    }
}

fn reference(data: &Dataset, element: Element) -> i32 {
    match element {
        Element::Tet(at) => data.mesh.tets.refs[at],
        Element::Cell(at) => data.stack.cells[at].reference,
        Element::Triangle(at) => data.mesh.triangles.refs[at],
        Element::Quad(at) => data.stack.quads.refs[at],
        Element::Edge(at) => data.mesh.edges.refs[at],
        Element::Other => 1,
    }
}
