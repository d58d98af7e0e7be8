//! From tetrahedra to faces with the cells on both sides (polyMesh).
use super::boundary::Patch;
use super::field::{write_labels, write_reals};
use super::file::head_text;
use super::{unnamed_region, unnamed_surface};
use crate::geometry::{Label, Names};
use crate::mesh::TetMesh;
use crate::mesh::adjacency::{FACES, MatchedFaces, NONE, Side, TriangleIndex};
use crate::mesh::io::{Batch, Error};
use crate::tasks::Team;
use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;
use std::path::Path;

/// The faces of a mesh in OpenFOAM's order: inner ones by owner, then neighbour ("upper triangular"), then those of each patch.
struct Ordered {
    nodes: Vec<[u32; 3]>,
    owner: Vec<u32>,
    neighbour: Vec<u32>,
    patches: Vec<Patch>,
    /// Inner faces that are triangles of the mesh, with what triangle, ascending.
    inside: Vec<(u32, u32)>,
}

/// Writes the polyMesh `folder`, which is made where it is not there; `kind` says of which type the patch of a reference with a name is.
/// Returns the patches, in their order: by reference.
///
/// # Errors
/// [`Error::Content`] when the mesh has a boundary face without a triangle, or a face of more than two tetrahedra; [`Error::System`]
/// when a file cannot be written.
pub fn write_poly_mesh(
    team: Team<'_>,
    folder: &Path,
    mesh: &TetMesh,
    names: &Names,
    kind: &dyn Fn(i32, &str) -> String,
    text: bool,
) -> Result<Vec<Patch>, Error> {
    let mut batch = Batch::new();
    let patches = add_poly_mesh(&mut batch, team, folder, mesh, names, kind, text)?;
    batch.commit()?;
    Ok(patches)
}

/// Adds what [`write_poly_mesh`] writes to files that belong together. The faces of an older mesh are removed first, and the new
/// ones come last. Without faces there is no mesh, so points of one mesh and faces of another are never read together.
pub(super) fn add_poly_mesh(
    batch: &mut Batch,
    team: Team<'_>,
    folder: &Path,
    mesh: &TetMesh,
    names: &Names,
    kind: &dyn Fn(i32, &str) -> String,
    text: bool,
) -> Result<Vec<Patch>, Error> {
    let faces = Ordered::of(team, folder, mesh, names, kind)?;
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
    add_zones(batch, folder, mesh, names, &faces)?;
    batch.add(&folder.join("boundary"), |w| write_boundary(w, &faces.patches, names))?;
    batch.add_main(&folder.join("faces"), |w| write_faces(w, &faces.nodes, text))?;
    Ok(faces.patches)
}

fn write_faces(w: &mut dyn Write, nodes: &[[u32; 3]], text: bool) -> std::io::Result<()> {
    let class = if text { "faceList" } else { "faceCompactList" };
    w.write_all(head_text(class, "constant/polyMesh", "faces", text).as_bytes())?;
    if text {
        write!(w, "\n{}\n(", nodes.len())?;
        nodes.iter().try_for_each(|[a, b, c]| write!(w, "\n3({a} {b} {c})"))?;
        return w.write_all(b"\n)\n");
    }
    let starts: Vec<u32> = (0..=nodes.len() as u32).map(|face| 3 * face).collect();
    write_labels(w, &starts, text)?;
    write_labels(w, nodes.as_flattened(), text)
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

/// A word for each reference, by its name where it has one; no two are the same.
fn words(
    references: &BTreeSet<i32>,
    labels: &BTreeMap<i32, Label>,
    unnamed: fn(i32) -> String,
) -> BTreeMap<i32, String> {
    let mut taken = BTreeSet::new();
    let mut words = BTreeMap::new();
    for &reference in references {
        let name = labels.get(&reference).and_then(|label| label.name.as_deref());
        let mut word = name.map_or_else(|| unnamed(reference), word);
        if !taken.insert(word.clone()) {
            word = format!("{word}_{reference}");
            while !taken.insert(word.clone()) {
                word.push('_');
            }
        }
        words.insert(reference, word);
    }
    words
}

/// A name as OpenFOAM's words are: of letters, digits and few other signs, not beginning like a number.
fn word(name: &str) -> String {
    let fits = |c: char| if c.is_ascii_alphanumeric() || c == '_' || c == '.' { c } else { '_' };
    let word: String = name.chars().map(fits).collect();
    if word.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_') { word } else { format!("_{word}") }
}

impl Ordered {
    fn of(
        team: Team<'_>,
        folder: &Path,
        mesh: &TetMesh,
        names: &Names,
        kind: &dyn Fn(i32, &str) -> String,
    ) -> Result<Self, Error> {
        let wrong =
            |message: String| Error::Content { path: folder.to_owned(), place: "mesh to write".to_owned(), message };
        let matched = MatchedFaces::of(team, &mesh.tets.nodes);
        if let Some(crowd) = matched.crowded {
            return Err(wrong(format!(
                "{} tetrahedra share the face of the nodes {:?} (from 0): `geo-adapt inspect` has more",
                crowd.tets, crowd.nodes
            )));
        }
        let tets = &mesh.tets.nodes;
        let around = &matched.neighbours;
        let sides = TriangleIndex::new(team, &mesh.triangles.nodes, mesh.vertices.len()).sides(team, tets);
        // In the order of the tetrahedra, and so are the sides.
        let mut sides = sides.into_iter().peekable();
        let (mut nodes, mut owner, mut neighbour, mut inside) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let mut boundary: BTreeMap<i32, Vec<Side>> = BTreeMap::new();
        for (tet, around) in around.iter().enumerate() {
            let mut of_face = [NONE; 4];
            while let Some(side) = sides.next_if(|side| side.tet as usize == tet) {
                of_face[side.face as usize] = side.triangle;
            }
            let mut upper: Vec<_> =
                (0..4).filter(|&face| around[face] != NONE && around[face] as usize > tet).collect();
            upper.sort_unstable_by_key(|&face| around[face]);
            for face in upper {
                if of_face[face] != NONE {
                    inside.push((nodes.len() as u32, of_face[face]));
                }
                nodes.push(FACES[face].map(|i| tets[tet][i]));
                owner.push(tet as u32);
                neighbour.push(around[face]);
            }
            for face in (0..4).filter(|&face| around[face] == NONE) {
                if of_face[face] == NONE {
                    return Err(wrong(format!(
                        "face {face} of tetrahedron {} has no neighbour and no triangle: `geo-adapt inspect` has more",
                        tet + 1
                    )));
                }
                let side = Side { triangle: of_face[face], tet: tet as u32, face: face as u32 };
                boundary.entry(mesh.triangles.refs[side.triangle as usize]).or_default().push(side);
            }
        }
        let joined = joined(boundary.keys().copied(), names, kind);
        let words = words(&joined.keys().copied().collect(), &names.triangles, unnamed_surface);
        let mut patches = Vec::new();
        for (reference, of_name) in joined {
            let start = nodes.len();
            for side in of_name.iter().flat_map(|reference| &boundary[reference]) {
                nodes.push(FACES[side.face as usize].map(|i| tets[side.tet as usize][i]));
                owner.push(side.tet);
            }
            let name = words[&reference].clone();
            let kind = kind(reference, &name);
            let mut parts: Vec<_> = of_name.iter().map(|reference| (*reference, boundary[reference].len())).collect();
            if parts.len() == 1 {
                parts.clear();
            }
            patches.push(Patch { name, reference, kind, faces: start..nodes.len(), parts });
        }
        Ok(Self { nodes, owner, neighbour, patches, inside })
    }
}

/// References by the first of the same name and type, which become one patch: a name stays one name.
fn joined(
    references: impl Iterator<Item = i32>,
    names: &Names,
    kind: &dyn Fn(i32, &str) -> String,
) -> BTreeMap<i32, Vec<i32>> {
    let mut first: BTreeMap<(&str, String), i32> = BTreeMap::new();
    let mut joined: BTreeMap<i32, Vec<i32>> = BTreeMap::new();
    for reference in references {
        let name = names.triangles.get(&reference).and_then(|label| label.name.as_deref());
        let to = name.map_or(reference, |name| *first.entry((name, kind(reference, name))).or_insert(reference));
        joined.entry(to).or_default().push(reference);
    }
    joined
}

/// Regions as zones of cells, unless there is but the one of reference 1 without a name; triangles inside as zones of faces.
fn add_zones(batch: &mut Batch, folder: &Path, mesh: &TetMesh, names: &Names, faces: &Ordered) -> Result<(), Error> {
    let mut cells: BTreeMap<i32, Vec<u32>> = BTreeMap::new();
    mesh.tets.refs.iter().zip(0..).for_each(|(&reference, cell)| cells.entry(reference).or_default().push(cell));
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
    for &(face, triangle) in &faces.inside {
        inside.entry(mesh.triangles.refs[triangle as usize]).or_default().push(face);
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
