//! The first mesh of a surface that is given as triangles, as of a scan or an STL file: its constrained Delaunay tetrahedra.
use super::added;
use super::ladder::{Meshed, judge};
use super::rung::Rung;
use super::unused::{drop_unused, keep_used};
use crate::cli::table::place;
use crate::delaunay::{self, FlatWhile, PointError, Tetrahedra, tetrahedralise};
use crate::formats::{Format, read_surface};
use crate::geometry::classify::Classification;
use crate::geometry::discrete::DiscreteOptions;
use crate::geometry::{Discrete, Model, Names};
use crate::mesh::TetMesh;
use crate::mesh::adjacency::{sorted2, sorted3};
use crate::mesh::vector::{Vec3, lerp};
use crate::tasks::Team;
use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::path::Path;
use std::time::{Duration, Instant};

/// Files of triangles alone that are the model; meshes of all formats are too.
const KINDS: [&str; 3] = ["stl", "obj", "ply"];

/// Whether a file is a surface of triangles, by its extension.
pub fn is_surface(path: &Path) -> bool {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    ending.is_some_and(|ending| KINDS.contains(&ending.as_str()))
        || Format::of(path).is_ok_and(|format| !format.is_fields())
}

/// The surface as a model, its mesh, and what references are called. Where smooth patches go through each other the `options` become those
/// of flat ones.
///
/// # Errors
/// When it is no surface, is not closed, or crosses itself: where, and what to do.
pub fn run(
    team: Team<'_>,
    path: &Path,
    options: &mut DiscreteOptions,
    limit: Duration,
) -> Result<(Model, Meshed, Names), String> {
    let named = |error: String| format!("{}: {error}", path.display());
    let read = read_surface(team, path).map_err(|error| error.to_string())?;
    let mut surface = alone(read.content.mesh);
    // Regions are found anew.
    let names = Names { tetrahedra: BTreeMap::new(), ..read.content.names };
    let mut notices = read.notices;
    let count = surface.triangles.len();
    let kept = drop_repeated(&mut surface);
    let repeated = count - kept.len();
    if repeated > 0 {
        notices.push(format!(
            "{repeated} triangles are there twice, as between the parts of an assembly: each was taken once"
        ));
    }
    check_closed(&surface).map_err(named)?;
    let end = Instant::now().checked_add(limit);
    let go_on = || end.is_none_or(|end| Instant::now() < end);
    let (points, triangles) = (&surface.vertices, &surface.triangles.nodes);
    let mut filled = tetrahedralise(points, triangles, &mut FlatWhile(&go_on), delaunay::Options::default())
        .map_err(|error| named(describe(&error, &surface, &kept)))?;
    let solids = solids(&filled);
    look_out(&mut surface, &mut filled, &solids);
    let on_itself =
        |options: &DiscreteOptions| Discrete::new(team, &surface, options).map_err(|error| named(error.to_string()));
    let (mut discrete, mut on) = on_itself(options)?;
    if let Some(at) = discrete.crossing(team) {
        take_as_they_are(options, &format!("they go through each other near {}", place(at)));
        (discrete, on) = on_itself(options)?;
    }
    let model = Model::Discrete(discrete);
    let (mesh, on_model) = meshed(&model, &surface, &on, (&filled, &solids));
    let (mesh, place) = judge(team, mesh, &model, Some(on_model)).map_err(named)?;
    Ok((model, Meshed { mesh, place, by: Rung::Own { finer: 1.0 }, notices }, names))
}

/// Has the triangles taken as they are, and tells why smooth patches are not.
pub fn take_as_they_are(options: &mut DiscreteOptions, why: &str) {
    crate::cli::note(format_args!(
        "smooth patches do not fit this surface ({why}): its triangles are taken as they are; give --flat-surface to other commands too"
    ));
    options.smooth = false;
}

/// The triangles of a mesh with their vertices and what is listed on them.
fn alone(mesh: TetMesh) -> TetMesh {
    let TetMesh { vertices, vertex_refs, triangles, edges, corners, .. } = mesh;
    let mut surface = TetMesh { vertices, vertex_refs, triangles, edges, corners, ..TetMesh::default() };
    keep_used(&mut surface);
    surface
}

/// The sides of a triangle, the lower vertex first.
fn sides_of(nodes: &[u32; 3]) -> [[u32; 2]; 3] {
    [0, 1, 2].map(|k| sorted2([nodes[k], nodes[(k + 1) % 3]]))
}

/// Leaves out triangles that are there again, as between the parts of an assembly; gives the numbers that the others had.
fn drop_repeated(surface: &mut TetMesh) -> Vec<u32> {
    let mut known = HashSet::new();
    let mut kept = Vec::new();
    for (number, (nodes, reference)) in (0..).zip(std::mem::take(&mut surface.triangles).iter()) {
        if known.insert(sorted3(nodes)) {
            surface.triangles.push(nodes, reference);
            kept.push(number);
        }
    }
    kept
}

/// Whether each edge has triangles on two sides.
fn check_closed(surface: &TetMesh) -> Result<(), String> {
    let mut all: Vec<[u32; 2]> = surface.triangles.nodes.iter().flat_map(sides_of).collect();
    all.sort_unstable();
    let mut open = all.chunk_by(|a, b| a == b).filter(|same| same.len() == 1).map(|same| same[0]);
    let Some(first) = open.next() else { return Ok(()) };
    let [a, b] = first.map(|v| surface.vertices[v as usize]);
    Err(format!(
        "the surface is not closed: {} edges have a triangle on one side alone, the first about {}; close its holes in the program that \
         made it",
        1 + open.count(),
        place(lerp(a, b, 0.5))
    ))
}

/// An error in the words of the file, where the triangles have the numbers `kept`.
fn describe(error: &delaunay::Error, surface: &TetMesh, kept: &[u32]) -> String {
    let number = |triangle: u32| kept.get(triangle as usize).map_or(0, |number| number + 1);
    let at = |v: u32| place(surface.vertices[v as usize]);
    let repair = "repair it in the program that made it";
    match *error {
        delaunay::Error::Points(PointError::NotFinite(v)) => format!("vertex {} is at {}", v + 1, at(v)),
        delaunay::Error::Points(PointError::Duplicate([a, b])) => {
            format!("vertices {} and {} are both at {}: join them", a + 1, b + 1, at(a))
        }
        delaunay::Error::Points(PointError::Flat) => "the surface lies in one plane and bounds nothing".into(),
        delaunay::Error::Points(PointError::TooMany) => "it has more vertices than numbers of 32 bits allow".into(),
        delaunay::Error::Corners { triangle } => format!("triangle {} has a corner twice; {repair}", number(triangle)),
        delaunay::Error::Repeated { triangles: [a, b] } => {
            format!("triangles {} and {} are the same; {repair}", number(a), number(b))
        }
        delaunay::Error::Crossing { triangles: [a, b], at } => {
            format!("triangles {} and {} cross near {}; {repair}", number(a), number(b), place(at))
        }
        delaunay::Error::Touching { triangle, point, at } => {
            format!("vertex {} lies on triangle {} near {}; {repair}", point + 1, number(triangle), place(at))
        }
        delaunay::Error::Unrecovered { triangle, at } => {
            format!("triangle {} could not be kept near {}; {repair}", number(triangle), place(at))
        }
        delaunay::Error::Stopped => "its tetrahedra took too long; give a greater --time-limit".into(),
    }
}

/// The mesh, and where its vertices belong on the model.
fn meshed(
    model: &Model,
    surface: &TetMesh,
    on: &Classification,
    (filled, solids): (&Tetrahedra, &[Option<i32>]),
) -> (TetMesh, Vec<Vec3>) {
    let mut mesh = TetMesh { vertices: filled.points.clone(), ..TetMesh::default() };
    mesh.vertex_refs = surface.vertex_refs.clone();
    mesh.vertex_refs.resize(mesh.vertices.len(), 0);
    for ((nodes, source), sides) in filled.triangles.iter().zip(&filled.source).zip(&filled.sides) {
        // What lies between two regions without tetrahedra bounds nothing.
        if sides.iter().any(|&region| solids[region as usize].is_some()) {
            mesh.triangles.push(*nodes, on.faces[*source as usize] as i32 + 1);
        }
    }
    for (nodes, region) in filled.tets.iter().zip(&filled.regions) {
        if let Some(solid) = solids[*region as usize] {
            mesh.tets.push(*nodes, solid);
        }
    }
    let mut on_model = filled.points.clone();
    let mut curves: BTreeMap<[u32; 2], u32> = on.ridges.iter().map(|&(nodes, edge)| (sorted2(nodes), edge)).collect();
    for added in added::places(model, filled, |triangle| on.faces[triangle as usize], &mut curves) {
        on_model[added.vertex as usize] = added.point;
    }
    // The edges of the model are known: they are not to be guessed anew from angles.
    let sides = mesh.triangles.nodes.iter().flat_map(sides_of).collect::<BTreeSet<_>>();
    curves.retain(|nodes, _| sides.contains(nodes));
    curves.iter().for_each(|(nodes, edge)| mesh.edges.push(*nodes, *edge as i32 + 1));
    drop_unused(&mut mesh, &mut on_model);
    (mesh, on_model)
}

/// Turns triangles that look into a solid out of a void: programs write them in any orientation.
fn look_out(surface: &mut TetMesh, filled: &mut Tetrahedra, solids: &[Option<i32>]) {
    let mut is_turned = vec![false; surface.triangles.len()];
    let parts = filled.triangles.iter_mut().zip(&mut filled.sides).zip(&filled.source);
    for ((nodes, sides), &source) in parts {
        let [before, behind] = sides.map(|region| solids[region as usize]);
        if before.is_some() && behind.is_none() {
            nodes.swap(1, 2);
            sides.swap(0, 1);
            is_turned[source as usize] = true;
        }
    }
    for (nodes, _) in surface.triangles.nodes.iter_mut().zip(is_turned).filter(|(_, is_turned)| *is_turned) {
        nodes.swap(1, 2);
    }
}

/// The number of the solid that each region is; none for the outside and for voids. Where all edges have two triangles, each closed part
/// of the surface has the solid on one side and a void on the other, beginning with the outside; else all regions are solids.
fn solids(filled: &Tetrahedra) -> Vec<Option<i32>> {
    let count = filled.region_count as usize;
    let mut depth: Vec<Option<u32>> = vec![None; count];
    depth[0] = Some(0);
    let mut waiting = vec![0u32];
    let mut beside: Vec<Vec<u32>> = vec![Vec::new(); count];
    for &[a, b] in filled.sides.iter().filter(|[a, b]| a != b) {
        beside[a as usize].push(b);
        beside[b as usize].push(a);
    }
    let mut is_alternating = true;
    while let Some(region) = waiting.pop() {
        let here = depth[region as usize].unwrap_or(0);
        for &other in &beside[region as usize] {
            match depth[other as usize] {
                Some(there) => is_alternating &= (here + there) % 2 == 1,
                None => {
                    depth[other as usize] = Some(here + 1);
                    waiting.push(other);
                }
            }
        }
    }
    let is_void = |region: usize| region == 0 || is_alternating && depth[region].is_some_and(|depth| depth % 2 == 0);
    let mut numbers = vec![None; count];
    for (number, region) in (1..).zip((0..count).filter(|&region| !is_void(region))) {
        numbers[region] = Some(number);
    }
    numbers
}
