//! Writing triangles: the boundary of a mesh, those of a reference together.
use super::super::sets::{Kind, Meaning, groups, meaning};
use super::super::text::Text;
use super::super::{Dataset, error};
use super::Shape;
use crate::geometry::discrete::complete_boundary;
use crate::mesh::io::{Batch, Error};
use crate::mesh::vector::{area2, unit, volume6};
use crate::tasks::Team;
use std::collections::HashMap;
use std::io::{self, Write};
use std::path::Path;

/// The triangles of a reference, and what it is called.
struct Group {
    name: String,
    meaning: Meaning,
    nodes: Vec<[u32; 3]>,
}

/// Writes the surface: solids of STL as text, groups of OBJ, or PLY in bytes with the reference of each face.
pub(in super::super) fn write(
    batch: &mut Batch,
    team: Team<'_>,
    path: &Path,
    data: &Dataset,
    shape: Shape,
    as_text: bool,
) -> Result<Vec<String>, Error> {
    let mut surface = Dataset { mesh: data.mesh.clone(), names: data.names.clone(), ..Dataset::default() };
    // As one region: what lies between regions is not the outside.
    surface.mesh.tets.refs.fill(1);
    complete_boundary(team, &mut surface.mesh);
    turn_outward(&mut surface);
    surface.mesh.tets = Default::default();
    surface.mesh.edges = Default::default();
    let mesh = &surface.mesh;
    if mesh.triangles.is_empty() {
        return Err(error::at(path, "triangles", "none in the mesh, and a surface is wanted"));
    }
    let parts: Vec<Group> = groups(&surface)
        .into_iter()
        .map(|((kind, reference), members)| {
            let meaning = meaning(&surface, (kind, reference));
            let name = meaning.name.clone().unwrap_or_else(|| format!("{}_{reference}", Kind::Triangles.unnamed()));
            let nodes = members.iter().map(|&at| mesh.triangles.nodes[at as usize]).collect();
            Group { name, meaning, nodes }
        })
        .collect();
    let points = &mesh.vertices;
    batch.add_main(path, |to| match shape {
        Shape::Stl => stl(to, points, &parts),
        _ => {
            let mut place = vec![u32::MAX; points.len()];
            let mut used = Vec::new();
            for &vertex in parts.iter().flat_map(|part| part.nodes.as_flattened()) {
                if place[vertex as usize] == u32::MAX {
                    place[vertex as usize] = used.len() as u32;
                    used.push(points[vertex as usize]);
                }
            }
            if shape == Shape::Obj { obj(to, &used, &place, &parts) } else { ply(to, &used, &place, &parts, as_text) }
        }
    })?;
    Ok(Vec::new())
}

/// Turns boundary triangles so that their normals point out of the tetrahedra.
fn turn_outward(data: &mut Dataset) {
    let sorted = |mut nodes: [u32; 3]| {
        nodes.sort_unstable();
        nodes
    };
    let mesh = &mut data.mesh;
    // The fourth vertex, none where there is a tetrahedron on either side.
    let mut behind: HashMap<[u32; 3], Option<u32>> =
        mesh.triangles.nodes.iter().map(|&nodes| (sorted(nodes), None)).collect();
    let mut seen: HashMap<[u32; 3], usize> = HashMap::new();
    for &[a, b, c, d] in &mesh.tets.nodes {
        for (nodes, other) in [([b, c, d], a), ([a, c, d], b), ([a, b, d], c), ([a, b, c], d)] {
            let key = sorted(nodes);
            if let Some(found) = behind.get_mut(&key) {
                let count = seen.entry(key).or_default();
                *count += 1;
                *found = (*count == 1).then_some(other);
            }
        }
    }
    for nodes in &mut mesh.triangles.nodes {
        let Some(&Some(other)) = behind.get(&sorted(*nodes)) else { continue };
        let [a, b, c] = nodes.map(|v| mesh.vertices[v as usize]);
        if volume6(a, b, c, mesh.vertices[other as usize]) > 0.0 {
            nodes.swap(1, 2);
        }
    }
}

/// A name as one line.
fn one_word(name: &str) -> String {
    name.split_whitespace().collect::<Vec<_>>().join("_")
}

fn stl(to: &mut dyn Write, points: &[[f64; 3]], parts: &[Group]) -> io::Result<()> {
    let mut text = Text::new(to);
    for part in parts {
        let name = one_word(&part.name);
        text.put(format_args!("solid {name}\n"));
        for nodes in &part.nodes {
            let corners = nodes.map(|v| points[v as usize]);
            let normal = unit(area2(corners[0], corners[1], corners[2]));
            let [x, y, z] = normal.map(|x| if x.is_finite() { x } else { 0.0 });
            text.put(format_args!("facet normal {x:?} {y:?} {z:?}\nouter loop\n"));
            for [x, y, z] in corners {
                text.put(format_args!("vertex {x:?} {y:?} {z:?}\n"));
            }
            text.put(format_args!("endloop\nendfacet\n"));
            text.hand_on()?;
        }
        text.put(format_args!("endsolid {name}\n"));
    }
    text.finish()
}

fn obj(to: &mut dyn Write, points: &[[f64; 3]], place: &[u32], parts: &[Group]) -> io::Result<()> {
    let mut text = Text::new(to);
    for [x, y, z] in points {
        text.put(format_args!("v {x:?} {y:?} {z:?}\n"));
        text.hand_on()?;
    }
    for part in parts {
        text.put(format_args!("# {}\ng {}\n", part.meaning.note(), one_word(&part.name)));
        for nodes in &part.nodes {
            let [a, b, c] = nodes.map(|v| place[v as usize] + 1);
            text.put(format_args!("f {a} {b} {c}\n"));
            text.hand_on()?;
        }
    }
    text.finish()
}

fn ply(to: &mut dyn Write, points: &[[f64; 3]], place: &[u32], parts: &[Group], as_text: bool) -> io::Result<()> {
    let mut text = Text::new(to);
    let format = if as_text { "ascii" } else { "binary_little_endian" };
    text.put(format_args!("ply\nformat {format} 1.0\n"));
    for part in parts {
        text.put(format_args!("comment {}\n", part.meaning.note()));
    }
    let faces: usize = parts.iter().map(|part| part.nodes.len()).sum();
    text.put(format_args!("element vertex {}\n", points.len()));
    ["x", "y", "z"].iter().for_each(|axis| text.put(format_args!("property double {axis}\n")));
    text.put(format_args!(
        "element face {faces}\nproperty list uchar int vertex_indices\nproperty int reference\nend_header\n"
    ));
    for &point in points {
        if as_text {
            text.put(format_args!("{:?} {:?} {:?}\n", point[0], point[1], point[2]));
        } else {
            point.iter().for_each(|x| text.raw(&x.to_le_bytes()));
        }
        text.hand_on()?;
    }
    for part in parts {
        for nodes in &part.nodes {
            let [a, b, c] = nodes.map(|v| place[v as usize]);
            let reference = part.meaning.reference;
            if as_text {
                text.put(format_args!("3 {a} {b} {c} {reference}\n"));
            } else {
                text.raw(&[3]);
                [a, b, c].iter().for_each(|v| text.raw(&v.to_le_bytes()));
                text.raw(&reference.to_le_bytes());
            }
            text.hand_on()?;
        }
    }
    text.finish()
}
