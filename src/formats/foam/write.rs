//! From tetrahedra to faces with the cells on both sides (polyMesh).
use super::boundary::Patch;
use super::field::{write_labels, write_reals};
use super::file::head_text;
use super::ordered::Ordered;
use super::words::words;
use super::{unnamed_region, unnamed_surface};
use crate::formats::Dataset;
use crate::geometry::{Label, Names};
use crate::mesh::adjacency::NONE;
use crate::mesh::io::{Batch, Error};
use crate::tasks::Team;
use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;

/// Writes the polyMesh `folder`, which is made where it is not there; `kind` says of which type the patch of a reference with a name is.
/// Returns the patches, in their order: by reference.
///
/// # Errors
/// [`Error::Content`] when the mesh has a boundary face without a triangle, or a face of more than two tetrahedra; [`Error::System`]
/// when a file cannot be written.
pub fn write_poly_mesh(
    team: Team<'_>,
    folder: &Path,
    data: &Dataset,
    kind: &dyn Fn(i32, &str) -> String,
    text: bool,
) -> Result<Vec<Patch>, Error> {
    let mut batch = Batch::new();
    let patches = add_poly_mesh(&mut batch, team, folder, data, kind, text)?;
    batch.commit()?;
    Ok(patches)
}

/// Adds what [`write_poly_mesh`] writes to files that belong together. The faces of an older mesh are removed first, and the new
/// ones come last. Without faces there is no mesh, so points of one mesh and faces of another are never read together.
pub(super) fn add_poly_mesh(
    batch: &mut Batch,
    team: Team<'_>,
    folder: &Path,
    data: &Dataset,
    kind: &dyn Fn(i32, &str) -> String,
    text: bool,
) -> Result<Vec<Patch>, Error> {
    let data = &*data.as_written();
    let (mesh, names) = (&data.mesh, &data.names);
    let faces = Ordered::of(team, folder, data, kind)?;
    batch.folder(folder)?;
    remove_old(batch, folder);
    let head = |name: &str, class: &str, text| head_text(class, "constant/polyMesh", name, text);
    let mut file = |name: &str, class: &str, body: &dyn Fn(&mut dyn Write) -> std::io::Result<()>| {
        batch.add(&folder.join(name), |w| {
            w.write_all(head(name, class, text).as_bytes())?;
            body(w)
        })
    };
    file("points", "vectorField", &|w| write_reals(w, mesh.vertices.as_flattened(), 3, text))?;
    file("owner", "labelList", &|w| write_labels(w, &faces.owner, text))?;
    file("neighbour", "labelList", &|w| write_labels(w, &faces.neighbour, text))?;
    add_zones(batch, folder, data, &faces)?;
    batch.add(&folder.join("boundary"), |w| write_boundary(w, &faces.patches, names))?;
    batch.add_main(&folder.join("faces"), |w| write_faces(w, &faces.nodes, text))?;
    Ok(faces.patches)
}

fn write_faces(w: &mut dyn Write, nodes: &[[u32; 4]], text: bool) -> std::io::Result<()> {
    let class = if text { "faceList" } else { "faceCompactList" };
    w.write_all(head_text(class, "constant/polyMesh", "faces", text).as_bytes())?;
    if text {
        write!(w, "\n{}\n(", nodes.len())?;
        nodes.iter().try_for_each(|&[a, b, c, d]| match d {
            NONE => write!(w, "\n3({a} {b} {c})"),
            d => write!(w, "\n4({a} {b} {c} {d})"),
        })?;
        return w.write_all(b"\n)\n");
    }
    let mut starts = vec![0; nodes.len() + 1];
    for (face, nodes) in nodes.iter().enumerate() {
        starts[face + 1] = starts[face] + if nodes[3] == NONE { 3 } else { 4 };
    }
    write_labels(w, &starts, text)?;
    write_labels(w, &nodes.as_flattened().iter().copied().filter(|&node| node != NONE).collect::<Vec<_>>(), text)
}

fn write_boundary(w: &mut dyn Write, patches: &[Patch], names: &Names) -> std::io::Result<()> {
    w.write_all(head_text("polyBoundaryMesh", "constant/polyMesh", "boundary", true).as_bytes())?;
    write!(w, "\n{}\n(\n", patches.len())?;
    for Patch { name, reference, kind, faces, parts } in patches {
        let (count, start) = (faces.len(), faces.start);
        writeln!(w, "    {name}\n    {{\n        type {kind};\n        nFaces {count};\n        startFace {start};")?;
        if !parts.is_empty() {
            let parts: Vec<String> = parts.iter().map(|(reference, count)| format!("{reference} {count}")).collect();
            writeln!(w, "        parts ({});", parts.join(" "))?;
        }
        writeln!(w, "        reference {reference};\n{}    }}", label_entry(names.triangles.get(reference), name))?;
    }
    w.write_all(b")\n")
}

/// The files of a polyMesh.
pub(super) const FILES: [&str; 8] =
    ["faces", "points", "owner", "neighbour", "boundary", "cellZones", "faceZones", "pointZones"];

/// What another mesh may have left, and would be read with this one.
fn remove_old(batch: &mut Batch, folder: &Path) {
    for name in FILES {
        for path in [folder.join(format!("{name}.gz")), folder.join(name)] {
            let is_replaced = path.extension().is_none() && !name.ends_with("Zones") && name != "faces";
            if !is_replaced && path.is_file() {
                batch.remove(&path);
            }
        }
    }
}

/// Keeps a name that OpenFOAM would not take as it is.
fn label_entry(label: Option<&Label>, word: &str) -> String {
    match label.and_then(|label| label.name.as_deref()) {
        Some(name) if name != word && !name.contains(['"', '\n']) => format!("        label \"{name}\";\n"),
        _ => String::new(),
    }
}

/// Regions as zones of cells, unless there is but the one of reference 1 without a name; triangles inside as zones of faces.
fn add_zones(batch: &mut Batch, folder: &Path, data: &Dataset, faces: &Ordered) -> Result<(), Error> {
    let names = &data.names;
    let refs = data.mesh.tets.refs.iter().copied().chain(data.stack.cells.iter().map(|cell| cell.reference));
    let mut cells: BTreeMap<i32, Vec<u32>> = BTreeMap::new();
    refs.zip(0..).for_each(|(reference, cell)| cells.entry(reference).or_default().push(cell));
    let plain =
        cells.len() < 2 && cells.keys().all(|reference| *reference == 1 && !names.tetrahedra.contains_key(reference));
    if !plain {
        add_zone_file(
            batch,
            folder,
            "cellZone",
            "cellLabels",
            &cells,
            words(&cells.keys().copied().collect(), &names.tetrahedra, unnamed_region),
            &names.tetrahedra,
        )?;
    }
    let mut inside: BTreeMap<i32, Vec<u32>> = BTreeMap::new();
    for &(face, reference) in &faces.inside {
        inside.entry(reference).or_default().push(face);
    }
    if inside.is_empty() {
        return Ok(());
    }
    // A patch may have the same name: zones have names of their own.
    let words = words(&inside.keys().copied().collect(), &names.triangles, unnamed_surface);
    add_zone_file(batch, folder, "faceZone", "faceLabels", &inside, words, &names.triangles)
}

fn add_zone_file(
    batch: &mut Batch,
    folder: &Path,
    kind: &str,
    list: &str,
    zones: &BTreeMap<i32, Vec<u32>>,
    words: BTreeMap<i32, String>,
    labels: &BTreeMap<i32, Label>,
) -> Result<(), Error> {
    let name = format!("{kind}s");
    batch.add(&folder.join(&name), |w| {
        w.write_all(head_text("regIOobject", "constant/polyMesh", &name, true).as_bytes())?;
        write!(w, "\n{}\n(\n", zones.len())?;
        for (reference, members) in zones {
            let word = &words[reference];
            write!(w, "    {word}\n    {{\n        type {kind};\n        {list} List<label>")?;
            write_labels(w, members, true)?;
            w.write_all(b";\n")?;
            if kind == "faceZone" {
                writeln!(w, "        flipMap List<bool> {}{{0}};", members.len())?;
            }
            writeln!(w, "        reference {reference};\n{}    }}", label_entry(labels.get(reference), word))?;
        }
        w.write_all(b")\n")
    })
}
