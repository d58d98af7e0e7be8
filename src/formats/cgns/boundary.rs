//! References of the elements of a zone: of our own descriptors, or by boundary conditions and sections.
use super::{Element, Labels, Node, Section};
use crate::mesh::TetMesh;
use crate::mesh::io::Error;
use std::collections::HashSet;

/// What no condition is of, until it has its section's.
const NONE: i32 = i32::MIN;

/// Gives the elements of a zone their references, and these names.
pub(super) fn refer(
    zone: &Node<'_>,
    base: usize,
    sections: &[Section],
    mesh: &mut TetMesh,
    labels: &mut Labels,
) -> Result<(), Error> {
    if sections.iter().all(|section| section.reference.is_some()) {
        for section in sections {
            let reference = section.reference.unwrap_or(1);
            section.elements.iter().for_each(|&element| set(mesh, element, reference));
            if let (Some(name), Some(&element)) = (&section.called, section.elements.first()) {
                labels.call(dimension(element), reference, name);
            }
        }
        return Ok(());
    }
    let all = || sections.iter().flat_map(|section| section.elements.iter().map(move |&element| (section, element)));
    all().for_each(|(_, element)| set(mesh, element, NONE));
    for conditions in zone.labelled("ZoneBC_t")? {
        for condition in conditions.labelled("BC_t")? {
            let name = condition.text_of("FamilyName").filter(|name| !name.is_empty());
            let name = name.unwrap_or_else(|| condition.name.clone());
            for element in elements_of(&condition, base, sections, mesh)? {
                let reference = labels.reference(dimension(element), &name);
                set(mesh, element, reference);
            }
        }
    }
    // One section of tetrahedra is no region that needs a name.
    let volumes =
        sections.iter().filter(|section| section.elements.first().is_some_and(|&e| dimension(e) == 3)).count();
    for (section, element) in all() {
        if reference(mesh, element) != NONE {
            continue;
        }
        let dimension = dimension(element);
        let given = if dimension == 3 && volumes == 1 { 1 } else { labels.reference(dimension, &section.name) };
        set(mesh, element, given);
    }
    Ok(())
}

/// The elements that a condition is of.
fn elements_of(condition: &Node<'_>, base: usize, sections: &[Section], mesh: &TetMesh) -> Result<Vec<Element>, Error> {
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
                Element::Triangle(at) => mesh.triangles.nodes[at].iter().all(has),
                _ => false,
            };
            found.extend(is_of.then_some(element));
        }
    }
    Ok(found)
}

fn dimension(element: Element) -> usize {
    match element {
        Element::Tet(_) => 3,
        Element::Triangle(_) => 2,
        Element::Edge(_) => 1,
        Element::Other => 0,
    }
}

fn set(mesh: &mut TetMesh, element: Element, reference: i32) {
    match element {
        Element::Tet(at) => mesh.tets.refs[at] = reference,
        Element::Triangle(at) => mesh.triangles.refs[at] = reference,
        Element::Edge(at) => mesh.edges.refs[at] = reference,
        Element::Other => {}
    }
}

fn reference(mesh: &TetMesh, element: Element) -> i32 {
    match element {
        Element::Tet(at) => mesh.tets.refs[at],
        Element::Triangle(at) => mesh.triangles.refs[at],
        Element::Edge(at) => mesh.edges.refs[at],
        Element::Other => 1,
    }
}
