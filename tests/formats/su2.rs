//! SU2's meshes and restarts.
use crate::sample::{Place, dataset, labels, read, refusal};
use geo_adapt::formats::{self, Dataset};
use geo_adapt::mesh::io::FieldKind;

/// After the format's documentation: a tetrahedron with comments, numbers behind the rows, a second number of points.
const MESH: &str = "%\n% Problem dimension\n%\nNDIME= 3\n%\nNELEM= 1\n10 0 1 2 3 0\n%\nNPOIN= 4 4\n0 0 0 0\n1.0 0 0 1\n0 1e0 0 2\n\
    0 0 1.5D0 3\n%\nNMARK= 3\nMARKER_TAG= lower\nMARKER_ELEMS= 1\n5 0 2 1\nMARKER_TAG= upper\nMARKER_ELEMS= 2\n5 0 1 3 7\n5 1 2 3\n\
    MARKER_TAG= SEND_RECEIVE\nMARKER_ELEMS= 1\n1 0 0\n";

#[test]
fn a_mesh_as_documented_is_read() {
    let place = Place::new();
    let path = place.text("a.su2", MESH);
    let Dataset { mesh, names, fields, .. } = read(&path);
    assert_eq!(mesh.vertices, [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.5]]);
    assert_eq!((mesh.tets.nodes, mesh.tets.refs), (vec![[0, 1, 2, 3]], vec![1]));
    assert_eq!((mesh.triangles.nodes, mesh.triangles.refs), (vec![[0, 2, 1], [0, 1, 3], [1, 2, 3]], vec![1, 2, 2]));
    assert_eq!(names.triangles, labels(&[(1, "lower"), (2, "upper")]));
    assert!(fields.is_empty());
}

#[test]
fn what_is_wrong_is_named_by_its_line() {
    let with = |from: &str, to: &str| {
        assert!(MESH.contains(from));
        refusal("a.su2", MESH.replacen(from, to, 1))
    };
    assert_eq!(with("NDIME= 3", "NDIME= 2"), "line 4: NDIME= 2: meshes in 3D are read; give one");
    assert_eq!(with("NDIME= 3", ""), "line 6: NDIME= must come first; write NDIME= 3 above");
    let voxel = with("10 0 1 2 3 0", "11 0 1 2 3 4 5 6 7 0");
    assert!(
        voxel.starts_with("line 7: an element of type 11 (voxel): tetrahedra, prisms, pyramids and hexahedra are read"),
        "{voxel}"
    );
    let far = with("10 0 1 2 3 0", "12 0 1 2 3 4 5 6 7 0");
    let wanted = "cell 1 of those that are no tetrahedra, a hexahedron: it has a vertex that is not there: there are 4";
    assert_eq!(far, wanted);
    assert!(with("5 0 2 1\n", "9 0 2 1 3\n").starts_with("quadrilateral 1: it is the face of no prism"));
    assert!(with("10 0 1 2 3", "10 0 1 2 x").starts_with("line 7: a whole number is expected, not 'x'"));
    assert_eq!(with("10 0 1 2 3", "10 0 1 2 4"), "tetrahedron 1 of 1: it has a vertex that is not there: there are 4");
    assert!(with("10 0 1 2 3", "10 0 1 2 -1").contains("-1 is no number of a vertex; they count from 0"));
    assert!(with("NPOIN= 4 4", "NPOIN= 400000000000 4").starts_with("line 14: a finite number is expected, not '%'"));
    assert!(with("MARKER_TAG= upper\n", "").contains("MARKER_TAG= is missing before it"));
    assert!(refusal("a.su2", "").contains("there are no points"));
    assert!(refusal("a.su2", "NZONE= 2\n").contains("several zones"));
}

#[test]
fn the_marks_of_what_su2_cannot_carry_are_told() {
    let place = Place::new();
    let (_, notices) = place.write("a.su2", &dataset(), false);
    let text = notices.join("\n");
    for part in ["3 edges", "references of tetrahedra", "4 fields"] {
        assert!(text.contains(part), "{part}: {text}");
    }
}

/// The restart that SU2 8 writes, with few digits and in another order.
#[test]
fn a_restart_comes_onto_its_mesh() {
    let place = Place::new();
    let mut data = read(&place.text("a.su2", MESH));
    let csv = "\"PointID\",\"x\",\"y\",\"z\",\"Density\",\"Momentum_x\",\"Momentum_y\",\"Momentum_z\",\"Energy\"\n\
               1, 1.000000001e+00, 0, 0, 1.5, 1, 2, 3, 9\n0, 0, 0, 0, 1.25, 4, 5, 6, 8\n2, 0, 1, 0, 1, 0, 0, 0, nan\n3, 0, 0, 1.5, 2, 7, 8, 9, 1\n\n";
    let notices = formats::read_fields(&place.text("r.csv", csv), &mut data).unwrap();
    let found: Vec<_> = data.fields.iter().map(|field| (field.name.as_str(), field.kind)).collect();
    assert_eq!(found, [("Density", FieldKind::Scalar), ("Momentum", FieldKind::Vector)]);
    assert_eq!(data.fields[0].values, [1.25, 1.5, 1.0, 2.0]);
    assert_eq!(data.fields[1].values[..6], [4.0, 5.0, 6.0, 1.0, 2.0, 3.0]);
    assert!(notices[0].contains("field Energy is NaN at vertex 3: it is left out"), "{notices:?}");

    let mut refused = |name: &str, text: &str| {
        let path = place.text(name, text);
        formats::read_fields(&path, &mut data).unwrap_err().to_string()
    };
    assert!(
        refused("r.csv", &csv.replacen("1.000000001e+00", "1.1", 1))
            .contains("vertex 1 (from 0) is at [1.1, 0.0, 0.0]")
    );
    assert!(
        refused("r.csv", &csv.replacen("\n3, 0, 0, 1.5, 2, 7, 8, 9, 1", "", 1))
            .contains("values at 3 points, and the mesh has 4")
    );
    assert!(
        refused("r.csv", &csv.replacen("\n3, ", "\n2, ", 1))
            .contains("row 4 of 4: PointID 2 is no vertex, or comes twice")
    );
    assert!(refused("r.csv", &csv.replacen(", 8\n", "\n", 1)).contains("line 3: 8 values; 9 are expected"));
    assert!(refused("r.csv", &csv.replacen("1.25", "x", 1)).contains("line 3: a finite number is expected, not 'x'"));
    assert!(refused("r.csv", "1,2\n3,4\n").contains("names of fields are expected"));
    assert!(refused("r.dat", "\n").contains("names of fields are expected"));
    assert!(refused("r.dat", "").contains("byte 0: the file is empty"));
    assert!(refused("r.vtu", "\n").contains("give .sol, .solb, .csv or .dat"));
}

/// As SU2's CSU2BinaryFileWriter lays it out, on a machine of the other order of bytes too, with the numbers that SU2 6 added.
#[test]
fn a_binary_restart_is_read() {
    let place = Place::new();
    let mut data = read(&place.text("a.su2", MESH));
    for big in [false, true] {
        let int = |value: i32| if big { value.to_be_bytes() } else { value.to_le_bytes() };
        let real = |value: f64| if big { value.to_be_bytes() } else { value.to_le_bytes() };
        let names = ["x", "y", "z", "Pressure", "Velocity_x", "Velocity_y", "Velocity_z"];
        let mut bytes: Vec<u8> = [535_532, names.len() as i32, 4, 0, 0].into_iter().flat_map(int).collect();
        for name in names {
            bytes.extend(name.bytes().chain(std::iter::repeat(0)).take(33));
        }
        for (row, point) in data.mesh.vertices.iter().enumerate() {
            point.iter().for_each(|&x| bytes.extend(real(x)));
            (0..4).for_each(|column| bytes.extend(real((10 * row + column) as f64)));
        }
        let whole = bytes.clone();
        bytes.extend([0; 68]);
        assert!(formats::read_fields(&place.text("r.dat", &bytes), &mut data).unwrap().is_empty());
        assert_eq!((data.fields.len(), data.fields[0].name.as_str()), (2, "Pressure"));
        assert_eq!(data.fields[0].values, [0.0, 10.0, 20.0, 30.0]);
        assert_eq!(data.fields[1].values[3..6], [11.0, 12.0, 13.0]);
        for end in 4..whole.len() {
            formats::read_fields(&place.text("r.dat", &whole[..end]), &mut data).unwrap_err();
        }
        let mut lying = whole;
        lying[8..12].copy_from_slice(&int(i32::MAX));
        assert!(
            formats::read_fields(&place.text("r.dat", &lying), &mut data)
                .unwrap_err()
                .to_string()
                .contains("header: values at")
        );
        lying[4..8].copy_from_slice(&int(-1));
        assert!(formats::read_fields(&place.text("r.dat", &lying), &mut data).is_err());
    }
}
