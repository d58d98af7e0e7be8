//! CGNS as other programs may write it: sections of mixed elements, conditions by vertices or faces, solutions at cells.
use crate::sample::{Place, is_of_both, labels};
use geo_adapt::formats;
use hdf5_pure::{AttrValue, FileBuilder, GroupBuilder, LibVer};

/// The numbers of a node.
enum Data<'a> {
    None,
    Ints(&'a [i32]),
    Reals(&'a [f64]),
    Text(&'a str),
}

/// A node with its children.
fn node(name: &str, label: &str, data: Data<'_>, children: Vec<GroupBuilder>) -> GroupBuilder {
    let mut group = FileBuilder::new().create_group(name);
    group.set_attr("label", AttrValue::ascii_string_sized(label, 33).unwrap());
    match data {
        Data::None => {}
        Data::Ints(values) => drop(group.create_dataset(" data").with_i32_data(values)),
        Data::Reals(values) => drop(group.create_dataset(" data").with_f64_data(values)),
        Data::Text(text) => {
            let bytes: Vec<i8> = text.bytes().map(|byte| byte as i8).collect();
            group.create_dataset(" data").with_i8_data(&bytes);
        }
    }
    children.into_iter().for_each(|child| group.add_group(child.finish()));
    group
}

fn section(name: &str, kind: i32, range: [i32; 2], nodes: &[i32]) -> GroupBuilder {
    let range = node("ElementRange", "IndexRange_t", Data::Ints(&range), vec![]);
    let nodes = node("ElementConnectivity", "DataArray_t", Data::Ints(nodes), vec![]);
    node(name, "Elements_t", Data::Ints(&[kind, 0]), vec![range, nodes])
}

/// Two tetrahedra with the triangle between them, and three outside.
fn file(mixed: &[i32]) -> Vec<u8> {
    let axis = |name: &str, values: [f64; 5]| node(name, "DataArray_t", Data::Reals(&values), vec![]);
    let axes = vec![
        axis("CoordinateX", [0.0, 1.0, 0.0, 0.0, 0.0]),
        axis("CoordinateY", [0.0, 0.0, 1.0, 0.0, 0.0]),
        axis("CoordinateZ", [0.0, 0.0, 0.0, 1.0, -2.0]),
    ];
    let grid = node("GridCoordinates", "GridCoordinates_t", Data::None, axes);
    // At vertices where nothing else is said.
    let points = node("PointList", "IndexArray_t", Data::Ints(&[4, 2, 1]), vec![]);
    let wall = node("wall", "BC_t", Data::Text("BCWall"), vec![points]);
    let faces = vec![
        node("PointList", "IndexArray_t", Data::Ints(&[6]), vec![]),
        node("GridLocation", "GridLocation_t", Data::Text("FaceCenter"), vec![]),
        node("FamilyName", "FamilyName_t", Data::Text("inflow"), vec![]),
    ];
    let inlet = node("inlet", "BC_t", Data::Text("FamilySpecified"), faces);
    let cells = vec![
        node("GridLocation", "GridLocation_t", Data::Text("CellCenter"), vec![]),
        node("q", "DataArray_t", Data::Reals(&[1.0, 4.0]), vec![]),
        node("odd", "DataArray_t", Data::Reals(&[1.0, 4.0, 5.0]), vec![]),
    ];
    let vertices = vec![node("p", "DataArray_t", Data::Reals(&[1.0, 2.0, 3.0, 4.0, 5.5]), vec![])];
    let zone = vec![
        node("ZoneType", "ZoneType_t", Data::Text("Unstructured"), vec![]),
        grid,
        // The numbers begin with the mixed section, whatever it is called.
        section("a", 5, [5, 7], &[1, 2, 4, 1, 3, 4, 2, 3, 4]),
        section("cells", 20, [1, 4], mixed),
        node("ZoneBC", "ZoneBC_t", Data::None, vec![wall, inlet]),
        node("AtCells", "FlowSolution_t", Data::None, cells),
        node("AtVertices", "FlowSolution_t", Data::None, vertices),
    ];
    whole(node("Zone", "Zone_t", Data::Ints(&[5, 2, 0]), zone))
}

/// A file of one zone.
fn whole(zone: GroupBuilder) -> Vec<u8> {
    let base = node("Base", "CGNSBase_t", Data::Ints(&[3, 3]), vec![zone]);
    let mut builder = FileBuilder::new();
    builder.with_libver_bounds(LibVer::Earliest, LibVer::V18);
    builder.add_group(base.finish());
    let mut bytes = Vec::new();
    builder.finish_to(&mut bytes).unwrap();
    bytes
}

#[test]
fn mixed_sections_conditions_and_solutions_at_cells_are_read() {
    let place = Place::new();
    // A tetrahedron, a triangle, a point, a tetrahedron.
    let path = place.text("a.cgns", file(&[10, 1, 2, 3, 4, 5, 1, 2, 3, 2, 5, 10, 1, 3, 2, 5]));
    let found = formats::read(&path).unwrap();
    let (mesh, names) = (&found.content.mesh, &found.content.names);
    assert_eq!(mesh.tets.nodes, [[0, 1, 2, 3], [0, 2, 1, 4]]);
    assert_eq!(mesh.triangles.nodes, [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]]);
    let called = |at: usize| names.triangles[&mesh.triangles.refs[at]].name.as_deref().unwrap();
    assert_eq!([0, 1, 2, 3].map(called), ["cells", "wall", "inflow", "a"]);
    assert_eq!((&mesh.tets.refs[..], &names.tetrahedra), (&[1, 1][..], &labels(&[])));
    let field = |name: &str| &found.content.fields.iter().find(|field| field.name == name).unwrap().values;
    assert_eq!(field("p"), &[1.0, 2.0, 3.0, 4.0, 5.5]);
    assert!(is_of_both(field("q"), true), "{:?}", field("q"));
    assert_eq!(found.content.fields.len(), 2);
    let notices = found.notices.join("\n");
    assert!(notices.contains("q was given at cells") && notices.contains("odd has 3 values for 2 places"), "{notices}");
}

#[test]
fn mixed_sections_that_cannot_be_are_told() {
    let place = Place::new();
    let refusal = |mixed: &[i32]| formats::read(&place.text("a.cgns", file(mixed))).unwrap_err().to_string();
    assert!(refusal(&[10, 1, 2, 3, 4, 10, 1, 3, 2]).contains("the nodes of element 2 end too early"));
    assert!(refusal(&[10, 1, 2, 3, 4, 18, 1, 2, 3]).contains("elements of type 18"));
    assert!(refusal(&[10, 1, 2, 3, 9]).contains("element 1 has the point 9; they count from 1 to 5"));
    assert!(refusal(&[10, 1, 2, 3, 4]).contains("1 elements, and ElementRange is 1 to 4"));
}

/// A tetrahedron on a prism, whose quadrilaterals are a condition by vertices.
fn on_prism(prism: &[i32]) -> Vec<u8> {
    let axis = |name: &str, values: [f64; 7]| node(name, "DataArray_t", Data::Reals(&values), vec![]);
    let axes = vec![
        axis("CoordinateX", [0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0]),
        axis("CoordinateY", [0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0]),
        axis("CoordinateZ", [0.0, 0.0, 0.0, 0.5, 0.5, 0.5, 1.5]),
    ];
    let points = node("PointList", "IndexArray_t", Data::Ints(&[1, 2, 3, 4, 5, 6]), vec![]);
    let cells = vec![
        node("GridLocation", "GridLocation_t", Data::Text("CellCenter"), vec![]),
        node("q", "DataArray_t", Data::Reals(&[4.0, 1.0]), vec![]),
    ];
    let conditions = vec![node("side", "BC_t", Data::Text("BCWall"), vec![points])];
    let zone = vec![
        node("GridCoordinates", "GridCoordinates_t", Data::None, axes),
        section("prisms", 14, [1, 1], prism),
        section("rest", 20, [2, 3], &[10, 4, 5, 6, 7, 5, 4, 5, 7]),
        section("quads", 7, [4, 6], &[1, 2, 5, 4, 2, 3, 6, 5, 3, 1, 4, 6]),
        section("triangles", 5, [7, 9], &[1, 3, 2, 5, 6, 7, 6, 4, 7]),
        node("ZoneBC", "ZoneBC_t", Data::None, conditions),
        node("AtCells", "FlowSolution_t", Data::None, cells),
    ];
    whole(node("Zone", "Zone_t", Data::Ints(&[7, 2, 0]), zone))
}

#[test]
fn prisms_and_quadrilaterals_are_read() {
    let place = Place::new();
    let found = formats::read(&place.text("a.cgns", on_prism(&[1, 2, 3, 4, 5, 6]))).unwrap().content;
    let (mesh, stack, names) = (&found.mesh, &found.stack, &found.names);
    assert_eq!((stack.cells.len(), stack.cells[0].nodes()), (1, &[0, 1, 2, 3, 4, 5][..]));
    assert_eq!(mesh.tets.nodes[..stack.own()[0]], [[3, 4, 5, 6]]);
    assert_eq!(stack.quads.nodes, [[0, 1, 4, 3], [1, 2, 5, 4], [2, 0, 3, 5]]);
    let called = |reference: i32| names.triangles[&reference].name.as_deref().unwrap();
    assert!(stack.quads.refs.iter().all(|&reference| called(reference) == "side"));
    assert_eq!([0, 1, 2, 3].map(|at| called(mesh.triangles.refs[at])), ["rest", "side", "triangles", "triangles"]);
    // A section of prisms beside one of tetrahedra makes no regions.
    assert!(mesh.tets.refs.iter().all(|&reference| reference == 1) && names.tetrahedra.is_empty());
    // The prism has 4, the tetrahedron 1: as below and at the top.
    let values = &found.fields[0].values;
    assert!((values[0] - 4.0).abs() < 1e-12 && (values[6] - 1.0).abs() < 1e-12, "{values:?}");
    assert!((3..6).all(|v| (1.0..=4.0).contains(&values[v])), "{values:?}");
    let refusal = |prism: &[i32]| formats::read(&place.text("a.cgns", on_prism(prism))).unwrap_err().to_string();
    assert!(refusal(&[1, 2, 3, 4, 5]).contains("the nodes of element 1 end too early"));
    assert!(refusal(&[1, 2, 3, 4, 5, 8]).contains("element 1 has the point 8; they count from 1 to 7"));
    assert!(refusal(&[1, 2, 3, 4, 5, 5]).contains("it has vertex 5 twice"));
}
