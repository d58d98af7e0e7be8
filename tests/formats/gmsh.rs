//! gmsh's files: those that it writes are read, ours it reads.
use crate::sample::{Place, dataset, is_of_both, read, refusal};
use geo_adapt::formats::{self, Dataset};
use geo_adapt::mesh::io::FieldKind;
use geo_adapt::mesh::{Elements, TetMesh, validity};
use std::path::Path;
use std::process::Command;

/// A box with physical groups: some faces of one group, a group without a name, a face without a group, data at nodes and elements.
const BOX: &str = "SetFactory(\"OpenCASCADE\");\nBox(1) = {0, 0, 0, 1, 2, 1};\nPhysical Surface(\"inlet\") = {1};\n\
    Physical Surface(\"outlet\", 70) = {2};\nPhysical Surface(\"side walls\") = {3, 4};\nPhysical Surface(90) = {5};\n\
    Physical Surface(\"top\") = {6};\nPhysical Curve(\"edge\") = {1, 2};\nPhysical Volume(\"fluid\") = {1};\n\
    Mesh.MeshSizeMin = 0.4;\nMesh.MeshSizeMax = 0.4;\n";

/// Runs gmsh; nothing where it is not installed and the tests were not set up.
fn gmsh(place: &Place, arguments: &[&str]) -> Option<()> {
    let program = std::env::var("GEO_ADAPT_GMSH").unwrap_or_else(|_| "gmsh".into());
    let mut command = Command::new(program);
    command.current_dir(place.path("")).args(["-nt", "1", "-v", "1"]).args(arguments);
    let Ok(done) = command.output() else {
        assert!(std::env::var_os("GEO_ADAPT_SET_UP").is_none(), "gmsh is missing");
        eprintln!("gmsh is not installed: not tested");
        return None;
    };
    let said = String::from_utf8_lossy(&done.stdout) + String::from_utf8_lossy(&done.stderr);
    assert!(done.status.success() && !said.contains("Error"), "{arguments:?}: {said}");
    Some(())
}

/// The mesh with vertices and elements in the order of their places: gmsh orders them by entity when it reads version 2.2.
fn by_place(data: &Dataset) -> TetMesh {
    let mut mesh = data.mesh.clone();
    let mut order: Vec<usize> = (0..mesh.vertices.len()).collect();
    order.sort_by(|&a, &b| mesh.vertices[a].partial_cmp(&mesh.vertices[b]).unwrap());
    let mut number = vec![0; order.len()];
    order.iter().zip(0..).for_each(|(&old, new)| number[old] = new);
    mesh.vertices = order.iter().map(|&old| mesh.vertices[old]).collect();
    fn sort<const N: usize>(elements: &mut Elements<N>, number: &[u32]) {
        let mut all: Vec<_> = elements.iter().map(|(nodes, r)| (nodes.map(|v| number[v as usize]), r)).collect();
        all.sort();
        *elements = Elements::default();
        all.into_iter().for_each(|(nodes, reference)| elements.push(nodes, reference));
    }
    sort(&mut mesh.tets, &number);
    sort(&mut mesh.triangles, &number);
    sort(&mut mesh.edges, &number);
    mesh
}

fn name(data: &Dataset, reference: i32) -> Option<&str> {
    data.names.triangles.get(&reference)?.name.as_deref()
}

#[test]
fn what_gmsh_writes_is_read() {
    let place = Place::new();
    place.text("box.geo", BOX);
    let mut before: Option<Dataset> = None;
    for (version, binary) in [("41", "0"), ("41", "1"), ("22", "0"), ("22", "1")] {
        let arguments = [
            "box.geo",
            "-3",
            "-format",
            &format!("msh{version}"),
            "-setnumber",
            "Mesh.Binary",
            binary,
            "-o",
            "box.msh",
        ];
        if gmsh(&place, &arguments).is_none() {
            return;
        }
        let found = formats::read(&place.path("box.msh")).unwrap();
        let data = found.content;
        assert!(validity::check(&data.mesh).is_valid(), "{version} {binary}: {:?}", validity::check(&data.mesh));
        assert!(data.mesh.tets.len() > 50 && data.mesh.edges.len() > 5);
        let names: Vec<_> = (1..=6).map(|face| name(&data, face).unwrap()).collect();
        assert_eq!(names, ["inlet", "outlet", "side walls", "side walls", "group 90", "top"]);
        assert_eq!(data.names.edges[&1].name.as_deref(), Some("edge"));
        assert_eq!(data.names.tetrahedra[&1].name.as_deref(), Some("fluid"));
        assert!(data.mesh.association.is_empty());
        // Texts have 16 digits.
        if let Some(before) = &before {
            assert_eq!(before.mesh.tets, data.mesh.tets);
            let near = |(a, b): (&[f64; 3], &[f64; 3])| (0..3).all(|i| (a[i] - b[i]).abs() < 1e-14);
            assert!(before.mesh.vertices.iter().zip(&data.mesh.vertices).all(near));
        }
        before = Some(data);
    }
}

/// With the nodes on their entities, as bootstrap asks for them; also those of faces and edges that no element has.
#[test]
fn parameters_are_read_as_text_and_binary() {
    let place = Place::new();
    place.text(
        "box.geo",
        BOX.replace("Box(1) = {0, 0, 0, 1, 2, 1}", "Sphere(1) = {0, 0, 0, 1}").split("Physical").next().unwrap(),
    );
    let mut all = Vec::new();
    for binary in ["0", "1"] {
        let arguments = ["box.geo", "-3", "-format", "msh41", "-setnumber", "Mesh.Binary", binary];
        let more = ["-setnumber", "Mesh.SaveParametric", "1", "-setnumber", "Mesh.MeshSizeMax", "0.5", "-o", "box.msh"];
        if gmsh(&place, &[&arguments[..], &more].concat()).is_none() {
            return;
        }
        let mesh = formats::read_msh(&place.path("box.msh")).unwrap();
        assert!(validity::check(&mesh).is_valid());
        assert!(mesh.association.faces.len() > 10, "{}", mesh.association.faces.len());
        for on in &mesh.association.faces {
            let ([u, v], p) = (on.uv, mesh.vertices[on.vertex as usize]);
            let there = [v.cos() * u.cos(), v.cos() * u.sin(), v.sin()];
            assert!((0..3).all(|i| (there[i] - p[i]).abs() < 1e-6), "{on:?} {p:?}");
        }
        all.push(mesh.association);
    }
    assert_eq!(
        (all[0].vertices.len(), all[0].edges.len(), all[0].faces.len()),
        (all[1].vertices.len(), all[1].edges.len(), all[1].faces.len())
    );
}

/// gmsh reads our files and writes what it has: the same mesh, names and fields.
#[test]
fn what_we_write_gmsh_reads() {
    let data = dataset();
    for (written, text) in [("a.msh", false), ("a.msh", true), ("a.msh2", false), ("a.msh2", true)] {
        let place = Place::new();
        place.write(written, &data, text);
        std::fs::rename(place.path(written), place.path("ours.msh")).unwrap();
        if gmsh(
            &place,
            &[
                "ours.msh",
                "-0",
                "-format",
                "msh41",
                "-setnumber",
                "Mesh.Binary",
                "1",
                "-setnumber",
                "Mesh.SaveAll",
                "1",
                "-o",
                "theirs.msh",
            ],
        )
        .is_none()
        {
            return;
        }
        let found = read(&place.path("theirs.msh"));
        assert_eq!(found.names, data.names, "{written} {text}");
        assert_eq!(by_place(&found), by_place(&data), "{written} {text}");
    }
}

#[test]
fn data_at_elements_and_odd_numbers_are_read() {
    let nodes = "$Nodes\n5\n10 0 0 0\n7 1 0 0\n3 0 1 0\n900 0 0 1\n4 0 0 -2\n$EndNodes\n";
    let elements = "$Elements\n3\n8 4 2 5 1 10 7 3 900\n2 4 2 5 1 10 3 7 4\n6 15 2 0 1 7\n$EndElements\n";
    let data = "$ElementData\n1\n\"q\"\n1\n0\n3\n0\n1\n2\n2 4\n8 1\n$EndElementData\n\
                $NodeData\n2\n\"v v\"\n\"scheme\"\n1\n0\n4\n0\n3\n5\n0\n7 1 2 3\n3 4 5 6\n10 7 8 9\n900 0 0 0\n4 0 0 1\n$EndNodeData\n\
                $NodeData\n1\n\"half\"\n0\n3\n0\n1\n2\n7 1\n3 4\n$EndNodeData\n$Periodic\n0\n$EndPeriodic\n";
    let text =
        format!("$Comments\nhello $Nodes\n$EndComments\n$MeshFormat\n2.2 0 8\n$EndMeshFormat\n{nodes}{elements}{data}");
    let place = Place::new();
    let read = formats::read(&place.text("a.msh", &text)).unwrap();
    let found = read.content;
    let fields: Vec<_> = found.fields.iter().map(|field| (field.name.as_str(), field.kind)).collect();
    assert_eq!(fields, [("q", FieldKind::Scalar), ("v v", FieldKind::Vector)]);
    assert!(is_of_both(&found.fields[0].values, false), "{:?}", found.fields[0]);
    assert_eq!(found.fields[1].values[..6], [7.0, 8.0, 9.0, 1.0, 2.0, 3.0]);
    assert_eq!(found.mesh.tets.nodes, [[0, 1, 2, 3], [0, 2, 1, 4]]);
    assert_eq!(found.names.tetrahedra[&1].name.as_deref(), Some("group 5"));
    assert!(read.notices.iter().any(|notice| notice.contains("half: values at 2 of 5 nodes")), "{:?}", read.notices);

    let with = |from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        refusal("a.msh", text.replacen(from, to, 1))
    };
    assert!(
        with("8 4 2 5 1 10 7 3 900", "8 11 2 5 1 10 7 3 900")
            .contains("line 17: elements of type 11 (of second order): only cells")
    );
    assert!(with("8 4 2 5 1 10", "8 4 2 5 1 11").contains("line 17: there is no node 11"));
    assert!(with("7 1 0 0", "10 1 0 0").contains("node 10 is there twice"));
    assert!(with("2.2 0 8", "1.0 0 8").contains("version 2.2 or 4.1 is expected"));
    assert!(with("2.2 0 8", "2.2 1 8").contains("the number 1 is expected behind the head"));
    assert!(with("$EndPeriodic", "").contains("$EndPeriodic is missing"));
    assert!(with("$EndElements\n", &format!("$EndElements\n{elements}")).contains("$Elements comes a second time"));
    assert!(with("$EndNodes\n", &format!("$EndNodes\n{nodes}")).contains("$Nodes comes a second time"));
    assert!(with("$MeshFormat", "$Format").contains("$MeshFormat must come first"));
    assert!(with("$EndMeshFormat\n$Nodes\n5", "$EndMeshFormat\n$Nodes\n99999999999999").contains("too many nodes"));
    assert!(refusal("a.msh", "").contains("there are no nodes"));
    let loose = formats::read_bytes(
        formats::Format::Msh { is_new: true },
        Path::new("b.msh"),
        text.replacen("2 4 2 5 1 10 3 7 4", "2 15 2 5 1 4", 1).as_bytes(),
    )
    .unwrap();
    assert_eq!((loose.content.mesh.vertices.len(), loose.content.fields.len()), (4, 2));
    assert_eq!(loose.content.fields[1].values.len(), 12);
    assert!(loose.notices.iter().any(|notice| notice.contains("1 nodes without elements are left out")));
}

/// Written by gmsh 4.15 of a box: six sections of triangles, each in a boundary condition of its family.
#[test]
fn what_gmsh_writes_as_cgns_is_read() {
    let found = read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/formats/gmsh.cgns"));
    assert_eq!((found.mesh.vertices.len(), found.mesh.tets.len(), found.mesh.triangles.len()), (341, 1140, 540));
    let names: Vec<_> = found.names.triangles.values().filter_map(|label| label.name.as_deref()).collect();
    assert_eq!(found.names.triangles.keys().copied().collect::<Vec<_>>(), [1, 2, 3, 4, 5, 6]);
    assert!((1..=6).all(|k| names.contains(&&*format!("S_{k}"))), "{names:?}");
}
