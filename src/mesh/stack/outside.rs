//! The tetrahedra beside a stack as a mesh of their own, and both joined again.
use super::sides::{Sides, against_tets};
use super::{Stack, cell};
use crate::mesh::adjacency::{sorted2, sorted3};
use crate::mesh::{Elements, TetMesh};
use std::collections::HashSet;

/// The tetrahedra beside a stack. At the faces to it their mesh is open: there are no triangles.
pub struct Outside {
    /// The mesh; its vertices are those of the whole mesh, of which some are of no tetrahedron.
    pub mesh: TetMesh,
    /// The number of each of its triangles in the mesh that is placed.
    pub placed: Vec<u32>,
    /// The triangles between the tetrahedra and the stack.
    pub interface: Vec<[u32; 3]>,
    /// Vertices of the tetrahedra that are the stack's too, ascending.
    pub held: Vec<u32>,
    /// Triangles and edges of the whole mesh that stay with the stack.
    triangles: Elements<3>,
    edges: Elements<2>,
}

/// A mesh with its stack, put together again.
pub struct Rejoined {
    /// The stack, its nodes renumbered.
    pub stack: Stack,
    /// The whole mesh: the stack's vertices come first, in the order in which they were, and then the others.
    pub mesh: TetMesh,
    /// For each vertex its number in the mesh outside; none inside the stack.
    pub from: Vec<Option<u32>>,
    /// The other way.
    pub number: Vec<u32>,
}

/// The triangles of the faces of a stack, nodes ascending.
struct Faces {
    /// On its boundary, towards tetrahedra or not.
    open: HashSet<[u32; 3]>,
    /// Between two of its cells.
    inner: HashSet<[u32; 3]>,
}

impl Faces {
    fn of(stack: &Stack) -> Self {
        let mut faces = Self { open: HashSet::new(), inner: HashSet::new() };
        for group in Sides::of(stack).groups() {
            let to = if group.len() == 1 { &mut faces.open } else { &mut faces.inner };
            to.extend(cell::fan(&group[0].nodes).map(sorted3));
        }
        faces
    }
}

impl Outside {
    /// Of a whole mesh with triangles on all of its boundary. Takes away those of its triangles that lie between the stack and the tetrahedra or
    /// within the stack: what is left is to be placed on a model.
    pub fn of(stack: &Stack, whole: &mut TetMesh) -> Self {
        let faces = Faces::of(stack);
        let against = against_tets(stack, whole, &faces.open);
        let mut interface: Vec<[u32; 3]> = against.iter().copied().collect();
        interface.sort_unstable();
        let is_of_stack =
            |nodes: [u32; 3]| faces.open.contains(&sorted3(nodes)) || faces.inner.contains(&sorted3(nodes));
        let own = stack.own[1];
        let mut triangles = Elements::default();
        for (nodes, reference) in whole.triangles.iter().take(own).filter(|(nodes, _)| is_of_stack(*nodes)) {
            triangles.push(nodes, reference);
        }
        keep_triangles(whole, |nodes| !against.contains(&sorted3(nodes)) && !faces.inner.contains(&sorted3(nodes)));
        let mut mesh = whole.clone();
        mesh.tets.truncate(stack.own[0]);
        let placed = keep_triangles(&mut mesh, |nodes| !is_of_stack(nodes));
        let mut is_outside = vec![false; whole.vertices.len()];
        mesh.tets.nodes.iter().flatten().for_each(|&v| is_outside[v as usize] = true);
        let mut is_held = vec![false; whole.vertices.len()];
        stack.nodes().for_each(|v| is_held[v as usize] = is_outside[v as usize]);
        let held = (0..).zip(&is_held).filter(|(_, held)| **held).map(|(v, _)| v).collect();
        let free = |[a, b]: [u32; 2]| {
            let [a, b] = [a as usize, b as usize];
            is_outside[a] && is_outside[b] && !(is_held[a] && is_held[b])
        };
        let edges = take_edges(&mut mesh, free);
        Self { mesh, placed, interface, held, triangles, edges }
    }

    /// The edges of the mesh's triangles, ends ascending.
    pub fn surface_edges(&self) -> HashSet<[u32; 2]> {
        let edges = self.mesh.triangles.nodes.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        edges.map(sorted2).collect()
    }

    /// What the mesh has become, with the stack as it was in the `whole` mesh; `held` are the numbers that the held vertices have now.
    ///
    /// # Errors
    /// Those of [`Stack::join`].
    pub fn rejoin(
        &self,
        stack: &Stack,
        whole: &TetMesh,
        adapted: &TetMesh,
        held: &[u32],
    ) -> Result<Rejoined, super::Error> {
        const NONE: u32 = u32::MAX;
        let mut of_stack: Vec<u32> = stack.nodes().collect();
        of_stack.sort_unstable();
        of_stack.dedup();
        let mut rank = vec![NONE; whole.vertices.len()];
        of_stack.iter().zip(0..).for_each(|(&v, at)| rank[v as usize] = at);
        let mut number = vec![NONE; adapted.vertices.len()];
        self.held.iter().zip(held).for_each(|(&old, &new)| number[new as usize] = rank[old as usize]);
        let mut from = vec![None; of_stack.len()];
        for (v, number) in (0..).zip(&mut number) {
            if *number == NONE {
                *number = from.len() as u32;
                from.push(Some(v));
            } else {
                from[*number as usize] = Some(v);
            }
        }
        let (behind, inside) = (from[of_stack.len()..].iter().flatten(), of_stack.iter());
        let mut mesh = TetMesh {
            vertices: inside.clone().map(|&v| whole.vertices[v as usize]).collect(),
            vertex_refs: inside.map(|&v| whole.vertex_refs[v as usize]).collect(),
            ..adapted.clone()
        };
        mesh.vertices.extend(behind.clone().map(|&v| adapted.vertices[v as usize]));
        mesh.vertex_refs.extend(behind.map(|&v| adapted.vertex_refs[v as usize]));
        let to = |v: &mut u32| *v = number[*v as usize];
        mesh.tets.nodes.iter_mut().flatten().for_each(to);
        mesh.triangles.nodes.iter_mut().flatten().for_each(to);
        mesh.edges.nodes.iter_mut().flatten().for_each(to);
        mesh.corners.iter_mut().chain(&mut mesh.required_vertices).for_each(to);
        let on = &mut mesh.association;
        on.vertices.iter_mut().for_each(|on| to(&mut on.vertex));
        on.edges.iter_mut().for_each(|on| to(&mut on.vertex));
        on.faces.iter_mut().for_each(|on| to(&mut on.vertex));
        for (nodes, reference) in self.triangles.iter() {
            mesh.triangles.push(nodes.map(|v| rank[v as usize]), reference);
        }
        let known: HashSet<[u32; 2]> = mesh.edges.nodes.iter().map(|&edge| sorted2(edge)).collect();
        for (nodes, reference) in self.edges.iter() {
            let nodes = nodes.map(|v| rank[v as usize]);
            if !nodes.contains(&NONE) && !known.contains(&sorted2(nodes)) {
                mesh.edges.push(nodes, reference);
            }
        }
        let mut stack = stack.clone();
        stack.nodes_mut().for_each(|v| *v = rank[*v as usize]);
        stack.join(&mut mesh)?;
        Ok(Rejoined { stack, mesh, from, number })
    }
}

/// Keeps some of a mesh's triangles: their old numbers.
fn keep_triangles(mesh: &mut TetMesh, is_kept: impl Fn([u32; 3]) -> bool) -> Vec<u32> {
    let kept: Vec<u32> =
        (0..).zip(&mesh.triangles.nodes).filter(|(_, nodes)| is_kept(**nodes)).map(|(t, _)| t).collect();
    let old = std::mem::take(&mut mesh.triangles);
    kept.iter().for_each(|&t| mesh.triangles.push(old.nodes[t as usize], old.refs[t as usize]));
    renumber(&mut mesh.required_triangles, &kept);
    kept
}

/// Takes the edges out of a mesh that are not kept.
fn take_edges(mesh: &mut TetMesh, is_kept: impl Fn([u32; 2]) -> bool) -> Elements<2> {
    let (old, mut kept, mut taken) = (std::mem::take(&mut mesh.edges), Vec::new(), Elements::default());
    for ((nodes, reference), e) in old.iter().zip(0..) {
        if is_kept(nodes) {
            kept.push(e);
            mesh.edges.push(nodes, reference);
        } else {
            taken.push(nodes, reference);
        }
    }
    renumber(&mut mesh.required_edges, &kept);
    renumber(&mut mesh.ridges, &kept);
    taken
}

/// The new numbers of what is `kept`, by their old numbers, ascending.
fn renumber(list: &mut Vec<u32>, kept: &[u32]) {
    *list = list.iter().filter_map(|old| kept.binary_search(old).ok().map(|new| new as u32)).collect();
}
