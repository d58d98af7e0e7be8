//! Checks the whole store against everything that the operations promise; for tests.
use super::context::Context;
use super::ids::{EDGE, FACE, TetId, VertexId};
use super::store::Store;
use crate::geometry::{Entity, Geometry};
use crate::mesh::predicate::is_positive;
use crate::metric::quality::mean_ratio;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::Ordering::Relaxed;

/// Kept mean ratios are single precision, and were measured when the metric came from a hint of another walk.
const QUALITY: f64 = 1e-5;

macro_rules! ensure {
    ($holds:expr, $($what:tt)*) => {
        let holds: bool = $holds;
        if !holds {
            return Err(format!($($what)*));
        }
    };
}

/// Checks tetrahedra, neighbours, tags, vertices, surface, ridges and locks; says the first thing that is wrong.
pub fn check(context: &Context<'_>) -> Result<(), String> {
    if let Some((t, i)) = open_faces(&context.store).next() {
        return Err(format!("{t:?} face {i} is on the boundary without a tag"));
    }
    check_part(context)
}

/// The same of a part of a larger mesh, which has faces to other parts, without a tag.
pub fn check_part(context: &Context<'_>) -> Result<(), String> {
    let store = &context.store;
    for t in store.live_tets() {
        check_tet(store, t)?;
        for i in 0..4 {
            check_face(context, t, i)?;
        }
    }
    check_faces_once(store)?;
    let balls = balls(store);
    for v in store.live_vertices() {
        check_vertex(store, v, balls.get(&v).map_or(&[], Vec::as_slice))?;
    }
    for v in balls.keys() {
        ensure!(store.is_vertex(*v), "{v:?} is dead and has tetrahedra");
    }
    check_ridges(store)?;
    check_surface(context)
}

/// The faces with neither a tetrahedron behind them nor a tag.
pub fn open_faces(store: &Store) -> impl Iterator<Item = (TetId, usize)> + '_ {
    let sides = store.live_tets().flat_map(|t| (0..4).map(move |i| (t, i)));
    sides.filter(|&(t, i)| !store.neighbour(t, i).is_some() && store.tags(t)[i] == 0)
}

fn check_tet(store: &Store, t: TetId) -> Result<(), String> {
    let v = store.vertices(t);
    for k in 0..4 {
        ensure!(v[k].index() < store.vertex_bound() && store.is_vertex(v[k]), "{t:?} has the dead {:?}", v[k]);
        ensure!(!v[..k].contains(&v[k]), "{t:?} has {:?} twice", v[k]);
    }
    let points = v.map(|v| store.position(v));
    ensure!(is_positive(points), "{t:?} is inverted or flat");
    let logs = v.map(|v| store.log(v));
    let quality = mean_ratio(points, [&logs[0], &logs[1], &logs[2], &logs[3]]);
    ensure!((quality - store.quality(t)).abs() < QUALITY, "{t:?} keeps {} and is {quality}", store.quality(t));
    Ok(())
}

fn sorted(store: &Store, t: TetId, i: usize) -> [VertexId; 3] {
    let mut face = FACE[i].map(|k| store.vertices(t)[k]);
    face.sort_unstable();
    face
}

fn check_face(context: &Context<'_>, t: TetId, i: usize) -> Result<(), String> {
    let store = &context.store;
    let (n, tag) = (store.neighbour(t, i), store.tags(t)[i]);
    ensure!(
        tag as usize <= context.model.topology().faces.len(),
        "{t:?} face {i}: there is no model face of tag {tag}"
    );
    if !n.is_some() {
        return Ok(());
    }
    ensure!(n.index() < store.tet_bound() && store.is_tet(n), "{t:?} face {i}: the neighbour {n:?} is dead");
    let back: Vec<usize> = (0..4).filter(|&j| store.neighbour(n, j) == t).collect();
    let [j] = back[..] else { return Err(format!("{t:?} face {i}: {n:?} knows it {} times", back.len())) };
    ensure!(sorted(store, t, i) == sorted(store, n, j), "{t:?} and {n:?} do not share the face where they meet");
    ensure!(tag == store.tags(n)[j], "{t:?} and {n:?} give their face different tags");
    ensure!(tag != 0 || store.region(t) == store.region(n), "{t:?} and {n:?} are of two regions without a tag");
    Ok(())
}

/// A face belongs to one tetrahedron on the boundary and to two inside.
fn check_faces_once(store: &Store) -> Result<(), String> {
    let mut seen: BTreeMap<[VertexId; 3], usize> = BTreeMap::new();
    for t in store.live_tets() {
        (0..4).for_each(|i| *seen.entry(sorted(store, t, i)).or_default() += 1);
    }
    for t in store.live_tets() {
        for i in 0..4 {
            let wanted = if store.neighbour(t, i).is_some() { 2 } else { 1 };
            let face = sorted(store, t, i);
            ensure!(seen[&face] == wanted, "face {face:?} is there {} times and not {wanted}", seen[&face]);
        }
    }
    Ok(())
}

fn balls(store: &Store) -> BTreeMap<VertexId, Vec<TetId>> {
    let mut balls: BTreeMap<VertexId, Vec<TetId>> = BTreeMap::new();
    for t in store.live_tets() {
        store.vertices(t).iter().for_each(|&v| balls.entry(v).or_default().push(t));
    }
    balls
}

/// The vertex is not locked, knows one of its tetrahedra, and from there all others are found.
fn check_vertex(store: &Store, v: VertexId, ball: &[TetId]) -> Result<(), String> {
    ensure!(store.lock(v).load(Relaxed) == 0, "{v:?} is still locked");
    ensure!(store.owner(v).load(Relaxed) == 0, "{v:?} is still a part's");
    let first = store.tet_of(v);
    ensure!(ball.contains(&first), "{v:?} points to {first:?}, which has it not");
    let mut found = vec![first];
    let mut next = 0;
    while next < found.len() {
        let t = found[next];
        next += 1;
        for i in (0..4).filter(|&i| store.vertices(t)[i] != v) {
            let n = store.neighbour(t, i);
            if n.is_some() && !found.contains(&n) {
                found.push(n);
            }
        }
    }
    ensure!(found.len() == ball.len(), "of {} tetrahedra at {v:?} the faces join {}", ball.len(), found.len());
    ensure!(store.position(v).iter().all(|x| x.is_finite()), "{v:?} is nowhere");
    Ok(())
}

/// Model edges that leave a vertex: other end and curve.
fn ridges_of(store: &Store, v: VertexId) -> Vec<(VertexId, u32)> {
    match store.entity(v) {
        Entity::Vertex(_) => store.corner_ridges(v).collect(),
        Entity::Edge(curve) => {
            // A ridge may go on in another part of the mesh.
            let here = store.ridge(v).into_iter().filter(|other| other.is_some());
            here.map(|other| (other, curve)).collect()
        }
        _ => Vec::new(),
    }
}

/// Every ridge is an edge of the mesh that both of its ends know, on the same curve.
fn check_ridges(store: &Store) -> Result<(), String> {
    let mut edges: BTreeSet<[VertexId; 2]> = BTreeSet::new();
    for t in store.live_tets() {
        let v = store.vertices(t);
        edges.extend(EDGE.map(|[i, j]| [v[i].min(v[j]), v[i].max(v[j])]));
    }
    for v in store.live_vertices() {
        let ridges = ridges_of(store, v);
        for &(other, curve) in &ridges {
            let same = ridges.iter().filter(|ridge| ridge.0 == other).count();
            ensure!(same == 1, "{v:?} has {same} ridges to {other:?}");
            ensure!(edges.contains(&[v.min(other), v.max(other)]), "the ridge {v:?}–{other:?} is no edge of the mesh");
            let back = ridges_of(store, other).contains(&(v, curve));
            ensure!(back, "the ridge {v:?}–{other:?} on curve {curve} is not known at its other end");
        }
    }
    Ok(())
}

/// The triangles at a surface edge fit to the model: there are two on one face, or the edge is a ridge. Their vertices lie on entities of these.
fn check_surface(context: &Context<'_>) -> Result<(), String> {
    let store = &context.store;
    // At faces to other parts the surface goes on there.
    let mut open: BTreeSet<[VertexId; 2]> = BTreeSet::new();
    for (t, i) in open_faces(store) {
        let [a, b, c] = sorted(store, t, i);
        open.extend([[a, b], [a, c], [b, c], [a, a], [b, b], [c, c]]);
    }
    let mut tags: BTreeMap<[VertexId; 2], Vec<u32>> = BTreeMap::new();
    let mut on_surface: BTreeSet<VertexId> = BTreeSet::new();
    for t in store.live_tets() {
        for i in 0..4 {
            let (n, tag) = (store.neighbour(t, i), store.tags(t)[i]);
            if tag == 0 || (n.is_some() && n < t) {
                continue;
            }
            let [a, b, c] = sorted(store, t, i);
            for edge in [[a, b], [a, c], [b, c]] {
                tags.entry(edge).or_default().push(tag);
            }
            for v in [a, b, c] {
                on_surface.insert(v);
                let stray = matches!(store.entity(v), Entity::Face(face) if face + 1 != tag);
                ensure!(!stray, "{v:?} lies on {:?} and in a triangle of tag {tag}", store.entity(v));
                ensure!(store.entity(v) != Entity::Interior, "{v:?} lies inside and in a triangle of tag {tag}");
            }
        }
    }
    for ([a, b], tags) in &tags {
        match store.ridge_curve(*a, *b) {
            Some(curve) => {
                let faces = &context.model.topology().edges[curve as usize].faces;
                let beside = tags.iter().all(|tag| faces.contains(&(tag - 1)));
                ensure!(beside, "curve {curve} does not bound all of the triangles' tags {tags:?} at {a:?}–{b:?}");
            }
            None => {
                let smooth = (tags.len() == 2 && tags[0] == tags[1]) || (tags.len() == 1 && open.contains(&[*a, *b]));
                ensure!(smooth, "{a:?}–{b:?} has triangles of tags {tags:?} and is no ridge");
            }
        }
    }
    for v in store.live_vertices() {
        let wanted = store.entity(v) != Entity::Interior;
        let is_elsewhere = wanted && open.contains(&[v, v]);
        ensure!(
            wanted == on_surface.contains(&v) || is_elsewhere,
            "{v:?} lies on {:?}: in a triangle is {}",
            store.entity(v),
            !wanted
        );
    }
    Ok(())
}
