//! The elements of a zone.
use super::super::Dataset;
use super::kind::{self, BAR_2, MIXED, QUAD_4, TETRA_4, TRI_3};
use super::{Element, NAME, Node, REFERENCE, Section};
use crate::mesh::io::Error;
use crate::mesh::stack::Cell;

/// Reads the sections of a zone, those of the least numbers first. References are 1 at first.
pub(super) fn read(zone: &Node<'_>, base: usize, data: &mut Dataset) -> Result<Vec<Section>, Error> {
    let mut found = Vec::new();
    for node in zone.labelled("Elements_t")? {
        let range = node.child("ElementRange").ok_or_else(|| node.fail("the section has no ElementRange"))?.ints()?;
        let &[first, last] = &range[..] else { return Err(node.fail("ElementRange has two numbers")) };
        found.push((first, last, node));
    }
    found.sort_by_key(|(first, ..)| *first);
    found.into_iter().map(|(first, last, node)| section(&node, [first, last], base, data)).collect()
}

fn section(node: &Node<'_>, [first, last]: [i64; 2], base: usize, data: &mut Dataset) -> Result<Section, Error> {
    let Dataset { mesh, stack, .. } = data;
    let points = mesh.vertices.len() - base;
    let of_section = node.ints()?.first().copied().unwrap_or(0);
    // The number of a kind that is not read is told before its nodes are.
    let nodes_of = |number| {
        kind::nodes(number).ok_or_else(|| {
            node.fail(format!(
                "elements of type {number}: TETRA_4, PYRA_5, PENTA_6, HEXA_8, TRI_3, QUAD_4, BAR_2 and MIXED of these are read; split the others"
            ))
        })
    };
    if of_section != MIXED {
        nodes_of(of_section)?;
    }
    let nodes = node.child("ElementConnectivity").ok_or_else(|| node.fail("the section has no ElementConnectivity"))?;
    let nodes = nodes.ints()?;
    let mut elements = Vec::new();
    let mut rest = &nodes[..];
    while let Some(&head) = rest.first() {
        let kind = if of_section == MIXED {
            rest = &rest[1..];
            head
        } else {
            of_section
        };
        let count = nodes_of(kind)?;
        let number = elements.len() as i64 + first;
        let (own, behind) = rest
            .split_at_checked(count)
            .ok_or_else(|| node.fail(format!("the nodes of element {number} end too early")))?;
        rest = behind;
        let mut vertices = [0; 8];
        for (vertex, &node_number) in vertices.iter_mut().zip(own) {
            let at = usize::try_from(node_number).ok().filter(|at| (1..=points).contains(at));
            let at = at.ok_or_else(|| {
                node.fail(format!("element {number} has the point {node_number}; they count from 1 to {points}"))
            })?;
            *vertex = (base + at - 1) as u32;
        }
        let [a, b, c, d, ..] = vertices;
        elements.push(match (kind, kind::of_stack(kind)) {
            (TETRA_4, _) => {
                mesh.tets.push([a, b, c, d], 1);
                Element::Tet(mesh.tets.len() - 1)
            }
            (TRI_3, _) => {
                mesh.triangles.push([a, b, c], 1);
                Element::Triangle(mesh.triangles.len() - 1)
            }
            (QUAD_4, _) => {
                stack.quads.push([a, b, c, d], 1);
                Element::Quad(stack.quads.len() - 1)
            }
            (BAR_2, _) => {
                mesh.edges.push([a, b], 1);
                Element::Edge(mesh.edges.len() - 1)
            }
            (_, Some(of_stack)) => {
                stack.cells.push(Cell::new(of_stack, &vertices[..count], 1));
                Element::Cell(stack.cells.len() - 1)
            }
            _ => Element::Other,
        });
    }
    if last.checked_sub(first).and_then(|count| count.checked_add(1)) != Some(elements.len() as i64) {
        return Err(node.fail(format!("{} elements, and ElementRange is {first} to {last}", elements.len())));
    }
    let reference = node.text_of(REFERENCE).and_then(|text| text.trim().parse().ok());
    Ok(Section { name: node.name.clone(), first, elements, reference, called: node.text_of(NAME) })
}
