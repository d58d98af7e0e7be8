//! UGRID with its names.
use crate::sample::{Place, dataset, labels, read, refusal};
use geo_adapt::formats;

/// One tetrahedron, as SimCenter describes the format.
const GRID: &str = "4 4 0 1 0 0 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 3 2\n1 2 4\n2 3 4\n1 4 3\n1 2 2 9\n1 2 3 4\n";

#[test]
fn a_grid_and_its_names_are_read() {
    let place = Place::new();
    place.text("wing.mapbc", "3\n1 4000 body\n\n2 5000   far field\n9 6662\n");
    let data = read(&place.text("wing.ugrid", GRID));
    assert_eq!((data.mesh.tets.nodes, data.mesh.triangles.refs), (vec![[0, 1, 2, 3]], vec![1, 2, 2, 9]));
    assert_eq!(data.names.triangles, labels(&[(1, "body"), (2, "far field")]));
    // Single precision, as bytes with the most significant first.
    let mut bytes = Vec::new();
    for (place, word) in GRID.split_ascii_whitespace().enumerate() {
        let word: i32 = word.parse().unwrap();
        let is_coordinate = (7..19).contains(&place);
        bytes.extend(if is_coordinate { (word as f32).to_be_bytes() } else { word.to_be_bytes() });
    }
    let single = read(&place.text("wing.b4.ugrid", &bytes));
    assert_eq!((single.mesh.vertices, single.names), (data.mesh.vertices, data.names));
    for end in 0..bytes.len() {
        refusal("wing.b4.ugrid", &bytes[..end]);
    }
    assert!(refusal("wing.lb4.ugrid", &bytes).contains("the most significant byte comes first: name it .b8.ugrid"));
}

#[test]
fn what_is_wrong_is_named() {
    let with = |from: &str, to: &str| refusal("a.ugrid", GRID.replacen(from, to, 1));
    assert!(with("4 4 0 1 0 0 0", "4 4 0 1 0 3 0").contains("the file ends here"));
    assert!(with("4 4 0 1 0 0 0", "4 4 0 100000 0 0 0").contains("do not fit into the file"));
    assert!(with("4 4 0 1 0 0 0", "4 4 0 -1 0 0 0").contains("the count -1 cannot be"));
    assert!(with("1 3 2\n", "0 3 2\n").contains("line 6: 0 is no number of a vertex; they count from 1"));
    assert!(with("1 3 2\n", "5 3 2\n").contains("triangle 1 of 4: it has a vertex that is not there"));
    let place = Place::new();
    place.text("a.mapbc", "2\n1 4000 body\n");
    let error = formats::read(&place.text("a.ugrid", GRID)).unwrap_err().to_string();
    assert!(error.contains("a.mapbc: line 2: 2 boundaries are said to be there, and 1 are"), "{error}");
    place.text("a.mapbc", "1\nwing 4000\n");
    assert!(formats::read(&place.path("a.ugrid")).unwrap_err().to_string().contains("a.mapbc: line 2: "));
    let error = formats::read(&place.text("a.r8.ugrid", GRID)).unwrap_err().to_string();
    assert!(error.contains("the unformatted UGRID of Fortran is not read"), "{error}");
}

#[test]
fn boundary_conditions_that_are_there_stay() {
    let place = Place::new();
    place.text("a.mapbc", "2\n3 4000 old name\n21 6662 y\n");
    let (_, notices) = place.write("a.lb8.ugrid", &dataset(), false);
    let text = std::fs::read_to_string(place.path("a.mapbc")).unwrap();
    assert_eq!(text, "6\n3 4000 wing\n6 0\n7 0 far-field\n8 0\n11 0 42\n21 6662 symmetry\n");
    assert!(notices.iter().any(|notice| notice.contains("4 boundaries have the condition 0")), "{notices:?}");
}
