//! Our own first mesh: a triangulation of the model's surface, and the constrained Delaunay tetrahedra of that.
mod bodies;

use super::added;
use super::unused::drop_unused;
use crate::cli::table::place;
use crate::delaunay::{self, FlatWhile, PointError, Tetrahedra, tetrahedralise};
use crate::geometry::{Entity, Geometry, Model};
use crate::mesh::adjacency::sorted2;
use crate::mesh::vector::{Vec3, area2, dot, unit};
use crate::mesh::{OnEdge, OnFace, OnVertex, TetMesh};
use crate::surface::{ENOUGH, Options, Place, Surface, triangulate};
use crate::tasks::{Team, stage};
use std::collections::{BTreeMap, HashMap};
use std::time::{Duration, Instant};

/// A mesh whose surface is made of flat triangles between points of the model.
pub struct Own {
    /// The mesh. Vertices that were added to a triangle or an edge of the surface lie on it, not yet on the model.
    pub mesh: TetMesh,
    /// Each vertex where it belongs on the model.
    pub on_model: Vec<Vec3>,
}

/// Why there is no mesh of our own.
#[derive(Debug)]
pub struct Failure {
    /// What part of the surface could not be triangulated or filled, and where.
    pub why: String,
    /// Whether its triangles cross at all sizes: finer ones were tried.
    pub is_crossing: bool,
}

impl From<String> for Failure {
    fn from(why: String) -> Self {
        Self { why, is_crossing: false }
    }
}

/// Makes it, with the sizes of the surface divided by `finer`; none where the time was over.
///
/// # Errors
/// What part of the surface could not be triangulated or filled, and where.
pub fn run(team: Team<'_>, model: &Model, finer: f64, limit: Duration) -> Result<Option<Own>, Failure> {
    let Model::Occt(cad) = model else { return Err("it is no CAD model".to_string().into()) };
    let options = Options::new(model.topology().diagonal()).finer(finer);
    let end = Instant::now().checked_add(limit);
    let go_on = || end.is_none_or(|end| Instant::now() < end);
    let Some(surface) = triangulate(team, cad, &options, &go_on) else { return Ok(None) };
    stage("surface");
    if let Some(face) = surface.missing.first() {
        let count = surface.missing.len();
        return Err(format!("{count} faces have no triangles, the first is face {}", face + 1).into());
    }
    let mut own: Option<Own> = None;
    for mut surface in parts(surface).map_err(|why| Failure { why, is_crossing: true })? {
        merge(&mut surface);
        let (points, triangles) = (&surface.points, &surface.triangles);
        let filled = match tetrahedralise(points, triangles, &mut FlatWhile(&go_on), delaunay::Options::default()) {
            Err(delaunay::Error::Stopped) => return Ok(None),
            filled => filled.map_err(|error| describe(&error, &surface))?,
        };
        let part = meshed(model, &surface, &filled);
        own = Some(match own {
            Some(own) => own.beside(&part),
            None => part,
        });
    }
    stage("tetrahedra");
    own.map(Some).ok_or_else(|| "its surface has no triangles".to_string().into())
}

impl Own {
    /// The meshes of two bodies as one.
    fn beside(mut self, other: &Self) -> Self {
        let offset = self.mesh.vertices.len() as u32;
        let (mesh, more) = (&mut self.mesh, &other.mesh);
        mesh.vertices.extend(&more.vertices);
        mesh.vertex_refs.extend(&more.vertex_refs);
        more.tets.iter().for_each(|(nodes, solid)| mesh.tets.push(nodes.map(|v| v + offset), solid));
        more.triangles.iter().for_each(|(nodes, face)| mesh.triangles.push(nodes.map(|v| v + offset), face));
        more.edges.iter().for_each(|(nodes, edge)| mesh.edges.push(nodes.map(|v| v + offset), edge));
        let (on, of) = (&mut mesh.association, &more.association);
        on.vertices.extend(of.vertices.iter().map(|on| OnVertex { vertex: on.vertex + offset, ..*on }));
        on.edges.extend(of.edges.iter().map(|on| OnEdge { vertex: on.vertex + offset, ..*on }));
        on.faces.extend(of.faces.iter().map(|on| OnFace { vertex: on.vertex + offset, ..*on }));
        self.on_model.extend(&other.on_model);
        self
    }
}

/// What is to be filled together: all, unless bodies that share no face cross, as balls do where they touch their seat along no edge of
/// the model: those are filled one by one, and what of their surfaces still crosses when they are fine is told in the end.
///
/// # Errors
/// Which triangles of one body cross.
fn parts(surface: Surface) -> Result<Vec<Surface>, String> {
    if surface.crossings.is_empty() {
        return Ok(vec![surface]);
    }
    let bodies = bodies::Bodies::of(&surface);
    if surface.crossings.iter().any(|pair| !bodies.are_apart(&surface, *pair)) {
        let pair = of_most(&surface);
        let [a, b] = pair.map(|t| surface.faces[t as usize] + 1);
        let at = surface.points[surface.triangles[pair[0] as usize][0] as usize];
        let count = surface.crossings.len();
        let least = if count < ENOUGH { "" } else { "at least " };
        let solids = match apart(&surface, pair) {
            [Some(a), Some(b)] => format!(": solids {} and {} overlap there, or touch along no edge", a + 1, b + 1),
            _ => String::new(),
        };
        return Err(format!(
            "{least}{count} pairs of triangles of its surface cross, the first of faces {a} and {b} near {}{solids}",
            place(at)
        ));
    }
    if let Some(pair) = surface.crossings.iter().find(|pair| cosine(&surface, **pair) > TOUCHING) {
        let [a, b] = pair.map(|t| sides(&surface, t).next().map_or(0, |solid| solid + 1));
        let at = surface.points[surface.triangles[pair[0] as usize][0] as usize];
        return Err(format!("solids {a} and {b} overlap near {}", place(at)));
    }
    Ok(bodies.divide(&surface))
}

/// Of the two faces of which most triangles cross, the first pair that does. Other faces may cross only because division ended early for
/// these.
fn of_most(surface: &Surface) -> [u32; 2] {
    let mut found: BTreeMap<[u32; 2], (usize, [u32; 2])> = BTreeMap::new();
    for &pair in &surface.crossings {
        let faces = sorted2(pair.map(|t| surface.faces[t as usize]));
        found.entry(faces).or_insert((0, pair)).0 += 1;
    }
    found.into_values().rev().max_by_key(|(count, _)| *count).expect("some triangles cross").1
}

/// The solids of a triangle's face.
fn sides(surface: &Surface, triangle: u32) -> impl Iterator<Item = u32> + '_ {
    surface.sides[surface.faces[triangle as usize] as usize].iter().flatten().copied()
}

/// A solid of each of two triangles, if they have none in common.
fn apart(surface: &Surface, [a, b]: [u32; 2]) -> [Option<u32>; 2] {
    if sides(surface, a).any(|solid| sides(surface, b).any(|other| other == solid)) {
        return [None; 2];
    }
    [a, b].map(|t| sides(surface, t).next())
}

/// Surfaces that touch look at each other, and so do their chords there, with a smaller cosine between their normals.
const TOUCHING: f64 = -0.5;

/// The cosine between the normals of two triangles.
fn cosine(surface: &Surface, pair: [u32; 2]) -> f64 {
    let [a, b] = pair.map(|t| {
        let [p, q, r] = surface.triangles[t as usize].map(|v| surface.points[v as usize]);
        unit(area2(p, q, r))
    });
    dot(a, b)
}

/// Makes one of points at the same place: edges of bodies that touch there. (Our kernel takes the bodies apart again.)
fn merge(surface: &mut Surface) {
    let mut first: HashMap<[u64; 3], u32> = HashMap::new();
    let (mut points, mut places) = (Vec::new(), Vec::new());
    let mut number = Vec::with_capacity(surface.points.len());
    for (point, place) in surface.points.iter().zip(&surface.places) {
        // −0 and 0 are the same place.
        let known = *first.entry(point.map(|x| (x + 0.0).to_bits())).or_insert(points.len() as u32);
        if known as usize == points.len() {
            points.push(*point);
            places.push(*place);
        }
        number.push(known);
    }
    let renumber = |v: &mut u32| *v = number[*v as usize];
    surface.triangles.iter_mut().flatten().for_each(renumber);
    surface.chains.iter_mut().flatten().for_each(renumber);
    (surface.points, surface.places) = (points, places);
}

/// An error in the words of the model.
fn describe(error: &delaunay::Error, surface: &Surface) -> String {
    let face = |t: u32| surface.faces[t as usize] + 1;
    match error {
        delaunay::Error::Points(error) => {
            let at = |p: u32| place(surface.points[p as usize]);
            match *error {
                PointError::NotFinite(p) => format!("point {p} of its surface is at {}", at(p)),
                PointError::Duplicate([a, b]) => format!("points {a} and {b} of its surface are both at {}", at(a)),
                PointError::Flat => "its surface lies in one plane".into(),
                PointError::TooMany => "its surface has too many points for numbers of 32 bits".into(),
            }
        }
        delaunay::Error::Corners { triangle } => format!("a triangle of face {} is damaged", face(*triangle)),
        delaunay::Error::Repeated { triangles: [a, b] } => {
            format!("faces {} and {} have the same triangle", face(*a), face(*b))
        }
        delaunay::Error::Crossing { triangles: [a, b], at } => {
            format!("triangles of faces {} and {} cross near {}", face(*a), face(*b), place(*at))
        }
        delaunay::Error::Touching { triangle, at, .. } => {
            format!("a point lies on a triangle of face {} near {}", face(*triangle), place(*at))
        }
        delaunay::Error::Unrecovered { triangle, at } => {
            format!("a triangle of face {} was not recovered near {}", face(*triangle), place(*at))
        }
        delaunay::Error::Stopped => "it was ended".into(),
    }
}

/// The mesh, with its places on the model.
fn meshed(model: &Model, surface: &Surface, filled: &Tetrahedra) -> Own {
    let mut mesh = TetMesh { vertices: filled.points.clone(), ..TetMesh::default() };
    mesh.vertex_refs = vec![0; mesh.vertices.len()];
    for (nodes, source) in filled.triangles.iter().zip(&filled.source) {
        mesh.triangles.push(*nodes, surface.faces[*source as usize] as i32 + 1);
    }
    let solids = solids(surface, filled);
    for (nodes, region) in filled.tets.iter().zip(&filled.regions) {
        if let Some(solid) = solids[*region as usize] {
            mesh.tets.push(*nodes, solid as i32 + 1);
        }
    }
    for (place, vertex) in surface.places.iter().zip(0..) {
        associate(&mut mesh, vertex, *place);
    }
    let mut on_model = mesh.vertices.clone();
    let mut curves: BTreeMap<[u32; 2], u32> = BTreeMap::new();
    for (chain, edge) in surface.chains.iter().zip(0..) {
        curves.extend(chain.windows(2).map(|ends| (sorted2([ends[0], ends[1]]), edge)));
    }
    for added in added::places(model, filled, |triangle| surface.faces[triangle as usize], &mut curves) {
        on_model[added.vertex as usize] = added.point;
        match added.entity {
            Entity::Edge(edge) => associate(&mut mesh, added.vertex, Place::Edge(edge, added.parameters[0])),
            Entity::Face(face) => associate(&mut mesh, added.vertex, Place::Face(face, added.parameters)),
            Entity::Vertex(_) | Entity::Interior => {}
        }
    }
    curves.into_iter().for_each(|(nodes, edge)| mesh.edges.push(nodes, edge as i32 + 1));
    drop_unused(&mut mesh, &mut on_model);
    Own { mesh, on_model }
}

fn associate(mesh: &mut TetMesh, vertex: u32, place: Place) {
    match place {
        Place::Vertex(id) => mesh.association.vertices.push(OnVertex { vertex, id: id as i32 + 1 }),
        Place::Edge(id, t) => mesh.association.edges.push(OnEdge { vertex, id: id as i32 + 1, t, r: 0.0 }),
        Place::Face(id, uv) => mesh.association.faces.push(OnFace { vertex, id: id as i32 + 1, uv, r: 0.0 }),
    }
}

/// The solid of each region, by the sides of its triangles; none for what is no solid.
fn solids(surface: &Surface, filled: &Tetrahedra) -> Vec<Option<u32>> {
    let mut votes: Vec<HashMap<Option<u32>, usize>> = vec![HashMap::new(); filled.region_count as usize];
    for (sides, source) in filled.sides.iter().zip(&filled.source) {
        let [behind, before] = surface.sides[surface.faces[*source as usize] as usize];
        *votes[sides[1] as usize].entry(behind).or_default() += 1;
        *votes[sides[0] as usize].entry(before).or_default() += 1;
    }
    let most = |votes: &HashMap<Option<u32>, usize>| votes.iter().map(|(solid, count)| (*count, *solid)).max();
    votes.iter().map(|votes| most(votes).and_then(|(_, solid)| solid)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two bodies with a triangle each: one lies flat, the other turned about the x axis, and they cross.
    fn crossing(turned_deg: f64) -> Surface {
        let (sine, cosine) = turned_deg.to_radians().sin_cos();
        let turned = |[x, y]: [f64; 2]| [x, y * cosine, y * sine];
        Surface {
            points: vec![
                [-1.0, -1.0, 0.0],
                [1.0, -1.0, 0.0],
                [0.0, 1.0, 0.0],
                turned([-1.0, -1.0]),
                turned([1.0, -1.0]),
                turned([0.0, 1.0]),
            ],
            places: (0..6).map(Place::Vertex).collect(),
            triangles: vec![[0, 1, 2], [3, 4, 5]],
            faces: vec![0, 1],
            sides: vec![[Some(0), None], [Some(1), None]],
            chains: Vec::new(),
            crossings: vec![[0, 1]],
            ..Surface::default()
        }
    }

    #[test]
    fn bodies_that_touch_are_divided_and_those_that_overlap_told() {
        assert_eq!(parts(crossing(170.0)).unwrap().len(), 2);
        for turned in [90.0, 60.0, 10.0] {
            let error = parts(crossing(turned)).unwrap_err();
            assert!(error.contains("solids 1 and 2 overlap near (-1.000000, -1.000000, 0.000000)"), "{error}");
        }
    }
    #[test]
    fn the_faces_that_cross_most_are_told() {
        let (faces, crossings) = (vec![3, 5, 5, 8, 3], vec![[0, 1], [1, 3], [3, 2], [2, 4]]);
        // Faces 4 and 6 cross twice, 6 and 9 twice: of as many, the first.
        assert_eq!(
            of_most(&Surface { faces: faces.clone(), crossings: crossings.clone(), ..Surface::default() }),
            [0, 1]
        );
        let crossings = crossings[1..].to_vec();
        assert_eq!(of_most(&Surface { faces, crossings, ..Surface::default() }), [1, 3]);
    }
}
