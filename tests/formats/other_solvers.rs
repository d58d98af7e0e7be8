//! Meshes of structural solvers (.inp, .bdf), as their manuals have them: what is read, and what is refused.
use crate::sample::{Place, labels, read, refusal};

/// Two tetrahedra, a surface of a side of each, and what a file of CalculiX has besides.
const INP: &str = "** a comment\n*HEADING\na title, with words\n*Node, NSET=all\n 10, 0, 0, 0\n 20, 1.0, 0.,\n 30, 0, 1.D0, 0\n40,0,0,1\n50,1,1,1\n\
    *Element, type=C3D4,\n elset=Solid\n1, 10, 20, 30, 40\n2, 20, 30, 40, 50\n*ELEMENT, TYPE=S3\n3, 10, 20, 30\n*ELEMENT, TYPE=MASS, ELSET=m\n9, 10\n\
    *ELSET, ELSET=skin\n3,\n*ELSET, ELSET=rows, GENERATE\n1, 2, 1\n*SURFACE, NAME=top, TYPE=ELEMENT\n2, S3\nSolid, S1\n\
    *MATERIAL, NAME=steel\n*ELASTIC\n210000., .3\n*STEP\n*END STEP\n";

#[test]
fn sets_and_surfaces_of_abaqus_name_references() {
    let place = Place::new();
    let data = read(&place.text("a.inp", INP));
    assert_eq!(data.mesh.vertices.len(), 5);
    assert_eq!(data.mesh.vertices[..3], [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    assert_eq!(data.mesh.tets.nodes, [[0, 1, 2, 3], [1, 2, 3, 4]]);
    // A set of the whole solid is its name; the shell's set names it; the side that is the shell is there already.
    assert_eq!(data.names.tetrahedra, labels(&[(1, "rows")]));
    let skin = data.names.triangles.iter().find(|(_, label)| label.name.as_deref() == Some("skin")).unwrap().0;
    let top = data.names.triangles.iter().find(|(_, label)| label.name.as_deref() == Some("top")).unwrap().0;
    let of = |reference: i32| data.mesh.triangles.iter().filter(|t| t.1 == reference).map(|t| t.0).collect::<Vec<_>>();
    assert_eq!(of(*skin), [[0, 1, 2]]);
    // S3 of the second is 2-4-3; S1 of the first is the shell, that of the second 1-2-3.
    assert_eq!(of(*top), [[2, 4, 3], [1, 2, 3]]);
}

#[test]
fn what_is_no_mesh_of_tetrahedra_is_refused_with_its_place() {
    for (name, text, parts) in [
        ("a.inp", INP.replace("C3D4", "C3D10"), &["line 11", "elements of type C3D10", "split the others"][..]),
        ("a.inp", INP.replace("40,0,0,1\n", ""), &["element 1", "the node 40, which is not there"]),
        ("a.inp", INP.replace("40,0,0,1\n", "20,0,0,1\n"), &["node 20 is there twice"]),
        ("a.inp", INP.replace("1, 10, 20, 30, 40", "1, 10, 20, 30"), &["line 12", "a whole number is expected"]),
        ("a.inp", INP.replace("*HEADING", "*INCLUDE, INPUT=b.inp"), &["line 2", "give one file"]),
        ("a.inp", "*HEADING\n".into(), &["there are no nodes"]),
        ("a.bdf", BDF.replace("CTETRA,5", "CHEXA,5"), &["line 10", "CHEXA", "split the others"]),
        ("a.bdf", BDF.replace("GRID,4,,", "GRID,4,7,"), &["line 9", "coordinate system"]),
        ("a.bdf", BDF.replace("GRID,4,,", "GRID,44,,"), &["line 10", "the point 4 is not there"]),
        ("a.bdf", BDF.replace("4\nCTRIA3", "4,5,6,7,8,9,10\nCTRIA3"), &["line 10", "ten points"]),
        (
            "a.vtk",
            "# vtk DataFile Version 3.0\n\nASCII\nDATASET STRUCTURED_GRID\n".into(),
            &["line 4", "UNSTRUCTURED_GRID"],
        ),
        ("a.vtk", "hello".into(), &["line 1", "# vtk DataFile Version 3.0"]),
        (
            "a.vtk",
            VTK.replace("CELL_TYPES 1\n10", "CELL_TYPES 1\n12"),
            &["cell 1 of 1", "(hexahedron)", "split the others"],
        ),
        ("a.vtk", VTK.replace("4 0 1 2 3", "4 0 1 2 9"), &["cell 1 of 1", "the point 9, and there are 4"]),
        ("a.vtk", VTK.replace("CELL_TYPES 1\n10\n", ""), &["CELL_TYPES", "0 types for 1 cells"]),
    ] {
        let said = refusal(name, &text);
        parts.iter().for_each(|part| assert!(said.contains(part), "'{part}' is not in: {said}"));
    }
}

/// All three kinds of fields, continuations, a coordinate without an E, and names of HyperMesh and ANSA.
const BDF: &str = "SOL 101\nCEND\n$HMNAME PROP                   3\"skin of it\"\nBEGIN BULK\nGRID           1              0.     0.0      0.\n\
    GRID*                  2                              1.              0.*\n*                    0.0\n\
    GRID,3,,0.,1.+0,0.\nGRID,4,,0.,0.,10.-1\nCTETRA,5,1,1,2,+a\n+a,3,4\nCTRIA3         6       3       1       2       3\nCBAR,7,8,1,2,0.,0.,1.\n\
    $ANSA_NAME_COMMENT;1;PSOLID;fluid;;\nPSOLID,1,1\nENDDATA\n";

const VTK: &str = "# vtk DataFile Version 2.0\na title\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n0 0 0  1 0 0\n0 1 0 0 0 1\nCELLS 1 5\n\
    4 0 1 2 3\nCELL_TYPES 1\n10\nPOINT_DATA 4\nSCALARS p float 1\nLOOKUP_TABLE default\n1 2 3 4\nCOLOR_SCALARS c 1\n0 0 0 1\n\
    TENSORS t double\n1 2 3 4 5 6 7 8 9 1 2 3 4 5 6 7 8 9\n1 2 3 4 5 6 7 8 9 1 2 3 4 5 6 7 8 9\nNORMALS n float\n1 0 0 1 0 0 1 0 0 1 0 0\n\
    CELL_DATA 1\nSCALARS ids int\nLOOKUP_TABLE default\n7\n";

#[test]
fn fields_of_nastran_are_read_however_they_are_written() {
    let place = Place::new();
    let data = read(&place.text("a.bdf", BDF));
    assert_eq!(data.mesh.vertices, [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    assert_eq!((&data.mesh.tets.nodes[..], &data.mesh.tets.refs[..]), (&[[0, 1, 2, 3]][..], &[1][..]));
    assert_eq!((data.mesh.triangles.refs[0], data.mesh.edges.nodes[0], data.mesh.edges.refs[0]), (3, [0, 1], 8));
    assert_eq!(data.names.triangles, labels(&[(3, "skin of it")]));
    assert_eq!(data.names.tetrahedra, labels(&[(1, "fluid")]));
}

#[test]
fn arrays_of_legacy_vtk_are_read_in_all_their_forms() {
    let place = Place::new();
    let data = read(&place.text("a.vtk", VTK));
    let names: Vec<_> = data.fields.iter().map(|field| (field.name.as_str(), field.kind.values())).collect();
    assert_eq!(names, [("p", 1), ("t", 9), ("n", 3)]);
    assert_eq!((&data.fields[0].values[..], data.mesh.tets.refs[0]), (&[1.0, 2.0, 3.0, 4.0][..], 1));
}
