//! Stacks made by hand.
use super::*;
use crate::mesh::samples::{of_all_kinds, on_prisms};
use crate::mesh::vector::volume6;

fn volume_of(mesh: &TetMesh, tets: &[[u32; 4]]) -> f64 {
    let volume = |nodes: &[u32; 4]| {
        let [a, b, c, d] = nodes.map(|v| mesh.vertices[v as usize]);
        volume6(a, b, c, d) / 6.0
    };
    assert!(tets.iter().all(|nodes| volume(nodes) > 0.0));
    tets.iter().map(volume).sum()
}

#[test]
fn cells_are_cut_into_positive_tetrahedra_whatever_the_lowest_vertex() {
    // The unit cube, the prism below its diagonal and the pyramid on its base.
    let points: Vec<_> = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
        .map(|p| p.map(f64::from))
        .into();
    for (kind, nodes, volume) in [
        (Kind::Hexahedron, vec![0, 1, 2, 3, 4, 5, 6, 7], 1.0),
        (Kind::Prism, vec![0, 1, 2, 4, 5, 6], 0.5),
        (Kind::Pyramid, vec![0, 1, 2, 3, 5], 1.0 / 3.0),
    ] {
        for lowest in nodes.clone() {
            for turned in [false, true] {
                // The lowest vertex changes places with the first.
                let other = |v: u32| {
                    if v == 0 {
                        lowest
                    } else if v == lowest {
                        0
                    } else {
                        v
                    }
                };
                let mut mesh = TetMesh { vertices: points.clone(), vertex_refs: vec![0; 8], ..TetMesh::default() };
                mesh.vertices.swap(0, lowest as usize);
                let mut nodes: Vec<u32> = nodes.iter().map(|&v| other(v)).collect();
                if turned {
                    match kind {
                        Kind::Pyramid => nodes.swap(1, 3),
                        _ => nodes.rotate_left(kind.corners() / 2),
                    }
                }
                let mut stack = Stack { cells: vec![Cell::new(kind, &nodes, 7)], ..Stack::default() };
                assert_eq!(stack.join(&mut mesh), Ok(None));
                assert_eq!((mesh.tets.len(), mesh.tets.refs[0]), (kind.pieces(), 7));
                let found = volume_of(&mesh, &mesh.tets.nodes);
                assert!((found - volume).abs() < 1e-15, "{kind:?}, lowest {lowest}, turned {turned}: {found}");
                assert_eq!(stack.cells[0].nodes(), nodes);
            }
        }
    }
}

#[test]
fn a_stack_fits_to_itself_and_to_the_tetrahedra() {
    let (mut mesh, mut stack) = on_prisms(3, 0.1);
    let before = mesh.clone();
    assert_eq!(stack.join(&mut mesh), Ok(None));
    assert!((volume_of(&mesh, &mesh.tets.nodes) - 1.1).abs() < 1e-12);
    // The boundary of what was cut is closed: five sides of 18 triangles above, 18 below and 12 quadrilaterals around the prisms.
    let faces = crate::mesh::adjacency::sorted_faces(&mesh.tets.nodes);
    let open = faces.chunk_by(|a, b| a.nodes == b.nodes).filter(|group| group.len() == 1).count();
    assert_eq!(open, 5 * 18 + 18 + 2 * 12);
    assert_eq!(stack.without(&mesh), before);
    let outside = Outside::of(&stack, &mut mesh);
    assert_eq!((outside.interface.len(), outside.held.len()), (18, 16));
    assert_eq!((outside.mesh.tets.len(), outside.mesh.triangles.len()), (before.tets.len(), 5 * 18));
    // Faces of the stack alone, halves of quadrilaterals among them, stay with it.
    assert_eq!(stack.quads.len(), 12);
    // Put together without a change, the stack comes first.
    let whole = outside.rejoin(&stack, &mesh, &outside.mesh, &outside.held);
    // Vertices below the prisms' tops are of no tetrahedron, and no adapted mesh has such.
    assert_eq!(whole.map(|whole| whole.stack.cells[0].nodes().iter().all(|&v| v < 32)), Ok(true));
}

#[test]
fn cells_of_all_kinds_fit_together() {
    let (mut mesh, mut stack) = of_all_kinds();
    assert_eq!(stack.join(&mut mesh), Ok(None));
    assert!((volume_of(&mesh, &mesh.tets.nodes) - (1.0 + 0.3 + 0.5 * 0.7 * 0.3)).abs() < 1e-12);
    assert_eq!((stack.counts(), stack.told().as_str()), ([1; 3], "1 pyramid, 1 prism, 1 hexahedron"));
    let faces = crate::mesh::adjacency::sorted_faces(&mesh.tets.nodes);
    let mut open: Vec<_> = faces
        .chunk_by(|a, b| a.nodes == b.nodes)
        .filter(|group| group.len() == 1)
        .map(|group| group[0].nodes)
        .collect();
    let mut listed: Vec<_> = mesh.triangles.nodes.iter().map(|&nodes| crate::mesh::adjacency::sorted3(nodes)).collect();
    open.sort_unstable();
    listed.sort_unstable();
    assert_eq!(open, listed);
    let outside = Outside::of(&stack, &mut mesh);
    assert_eq!((outside.interface.len(), &outside.held[..]), (4, &[0, 1, 2, 3, 8][..]));
}

#[test]
fn what_cannot_be_is_told() {
    let told = |change: &dyn Fn(&mut TetMesh, &mut Stack)| {
        let (mut mesh, mut stack) = on_prisms(1, 0.5);
        change(&mut mesh, &mut stack);
        let error = stack.join(&mut mesh).unwrap_err();
        format!("{}: {error}", error.place())
    };
    let renode = |stack: &mut Stack, at: usize, place: usize, v: u32| stack.cells[at].nodes_mut()[place] = v;
    let first = "cell 1 of those that are no tetrahedra, a prism: ";
    assert!(
        told(&|_, stack| renode(stack, 0, 4, 99))
            .starts_with(&format!("{first}it has a vertex that is not there: there are 12"))
    );
    let twice = |_: &mut TetMesh, stack: &mut Stack| {
        let last = stack.cells[0].nodes()[5];
        renode(stack, 0, 4, last);
    };
    assert!(told(&twice).contains("twice"));
    assert!(told(&|mesh, _| mesh.vertices.iter_mut().for_each(|p| p[2] = 0.0)).contains("no volume"));
    assert!(told(&|mesh, _| mesh.vertices[9][0] = f64::NAN).contains("no volume"));
    assert!(told(&|_, stack| stack.cells.extend([stack.cells[0]; 2])).contains("two other cells"));
    assert!(
        told(&|_, stack| stack.quads.push([0, 1, 2, 3], 4)).starts_with("quadrilateral 5: it is the face of no prism")
    );
    // A tetrahedron on half of a side.
    let beside = |mesh: &mut TetMesh, stack: &mut Stack| {
        let quad = stack.cells[0]
            .faces()
            .find(|face| face.len() == 4 && !face.iter().all(|v| stack.cells[1].nodes().contains(v)));
        let quad = quad.unwrap();
        mesh.vertices.push([5.0; 3]);
        mesh.vertex_refs.push(0);
        mesh.tets.push([quad[0], quad[1], quad[2], mesh.vertices.len() as u32 - 1], 1);
    };
    assert!(told(&beside).contains("put a pyramid between"));
}

#[test]
fn values_of_cells_go_to_their_pieces_and_back() {
    let (mut mesh, mut stack) = on_prisms(1, 0.5);
    stack.join(&mut mesh).unwrap();
    let values: Vec<f64> = (0..2 * (6 + 2)).map(f64::from).collect();
    let spread = stack.spread(values.clone(), 2);
    assert_eq!(spread.len(), 2 * mesh.tets.len());
    assert_eq!(spread[12..18], [12.0, 13.0, 12.0, 13.0, 12.0, 13.0]);
    assert_eq!(stack.gather(spread, 2), values);
}
