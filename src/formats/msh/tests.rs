//! Meshes as gmsh writes them of a CAD model.
use super::*;
use crate::mesh::{OnEdge, OnFace, OnVertex};

const FILE: &str = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n5 6 1 9\n0 2 0 1\n9\n0 0 0\n1 4 1 1\n1\n1 0 0 0.25\n\
    2 3 1 1\n2\n0 1 0 0.5 0.75\n3 1 0 2\n3\n4\n0 0 1\n1 1 1\n2 7 0 1\n6\n7 7 7\n$EndNodes\n$Elements\n4 4 1 5\n0 2 15 1\n1 9\n\
    1 4 1 1\n2 9 1\n2 3 2 1\n3 9 1 2\n3 1 4 2\n4 1 9 2 3\n5 1 2 3 4\n$EndElements\n";

fn read(text: &str) -> Result<TetMesh, Error> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.msh");
    std::fs::write(&path, text).unwrap();
    read_msh(&path)
}

#[test]
fn nodes_come_with_their_entities_and_loose_ones_go() {
    let mesh = read(FILE).unwrap();
    assert_eq!(mesh.vertices, [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0; 3]]);
    assert_eq!(mesh.association.vertices, [OnVertex { vertex: 0, id: 2 }]);
    assert_eq!(mesh.association.edges, [OnEdge { vertex: 1, id: 4, t: 0.25, r: 0.0 }]);
    assert_eq!(mesh.association.faces, [OnFace { vertex: 2, id: 3, uv: [0.5, 0.75], r: 0.0 }]);
    assert_eq!((mesh.edges.nodes[0], mesh.edges.refs[0]), ([0, 1], 4));
    assert_eq!((mesh.triangles.nodes[0], mesh.triangles.refs[0]), ([0, 1, 2], 3));
    // One is negative and one positive: neither is turned.
    assert_eq!(mesh.tets.nodes, [[1, 0, 2, 3], [1, 2, 3, 4]]);
}

#[test]
fn a_mesh_of_negative_tetrahedra_is_turned() {
    let mesh = read(&FILE.replace("3 1 4 2\n4 1 9 2 3\n5 1 2 3 4", "3 1 4 1\n4 1 9 2 3")).unwrap();
    assert_eq!(mesh.tets.nodes, [[0, 1, 2, 3]]);
}

#[test]
fn what_is_wrong_is_named_by_its_line() {
    let message = |from: &str, to: &str| read(&FILE.replacen(from, to, 1)).unwrap_err().to_string();
    assert!(message("4.1 0 8", "3.0 0 8").contains("line 2: a mesh of MSH version 2.2 or 4.1"));
    assert!(message("4 1 9 2 3", "4 1 9 2 77").contains("there is no node 77"));
    assert!(message("4 1 9 2 3", "4 1 9 2").contains("there is no node 5"));
    assert!(message("4 1 9 2 3", "4 1 9 2 x").contains("a whole number is expected, not 'x'"));
    assert!(message("3 1 4 2\n", "3 1 11 2\n").contains("elements of type 11"));
    assert!(message("5 1 2 3 4\n$EndElements\n", "").contains("the file ends here; it was cut"));
    assert!(message("3\n4\n0 0 1", "3\n3\n0 0 1").contains("node 3 is there twice"));
}
