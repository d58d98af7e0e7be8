//! What is known of a mesh in files as a whole: each tetrahedron is read once for it, and none is kept but those at the boundary.
use super::super::Error;
use super::super::bytes::{put, take};
use super::files::{Files, MetricOf};
use super::skin::Skin;
use super::{Input, Vertices};
use crate::adapt;
use crate::geometry::classify::Classification;
use crate::geometry::discrete::outward_triangles;
use crate::mesh::TetMesh;
use crate::mesh::adjacency::{FACES, Side, TriangleIndex, sorted3};
use crate::mesh::predicate::is_positive;
use crate::mesh::ranges::renumbered;
use crate::metric;
use crate::metric::Sym3;
use crate::metric::field::complexity_terms;
use crate::ranks::{Ranks, agree};
use crate::tasks::{GRAIN, Team};
use std::hash::{DefaultHasher, Hasher};
use std::sync::Arc;

/// Tetrahedra that are looked at together.
const SCAN: usize = 64 * GRAIN;

/// The boundary of a mesh in files, with the tetrahedra at it, and what else is known of it as a whole.
pub struct Shell {
    /// All triangles, edges and lists of the mesh, and the tetrahedra that have a triangle.
    pub mesh: Arc<TetMesh>,
    /// The numbers of its vertices in the whole mesh, ascending.
    numbers: Vec<u32>,
    /// The triangles as faces of the tetrahedra of the whole mesh.
    sides: Vec<Side>,
    /// Complexity ∫ √det M.
    pub complexity: f64,
    /// A name for mesh and metric: others have another one.
    pub name: u64,
}

/// What was found at the tetrahedra of some scans.
#[derive(Default)]
struct Scanned {
    /// The triangles as their faces.
    sides: Vec<[u32; 3]>,
    /// Nodes and reference of the tetrahedron of each side.
    tets: Vec<[u32; 5]>,
    /// Of the complexity.
    terms: Vec<f64>,
    /// Sum of what stands for each face that is no triangle, by exclusive or: 0 where each comes twice, with one reference.
    open: [u64; 2],
    /// For each scan what it is known by.
    names: Vec<u64>,
}

impl Shell {
    /// Reads all of a mesh once, a slice at a time; each rank its share. Errors name its file. Collective.
    ///
    /// # Errors
    /// When a file cannot be read, a tetrahedron is inverted, sizes cannot be computed with, or a triangle is missing on the boundary.
    pub fn read(team: Team<'_>, ranks: &dyn Ranks, files: &Files) -> Result<Self, Error> {
        let told = |error: Error| error.of(files.reader().path());
        let own = Self::skin_of(team, files).and_then(|mesh| {
            let index = TriangleIndex::new(team, &mesh.triangles.nodes, files.size()[0]);
            let scans = files.size()[1].div_ceil(SCAN);
            let own: Vec<usize> = (0..scans).filter(|scan| scan % ranks.count() == ranks.rank()).collect();
            let found = team.chunks(1, own.len(), |at| files.scan(&index, own[at.start]));
            Ok((mesh, own.into_iter().zip(found.into_iter().collect::<Result<Vec<_>, _>>()?).collect::<Vec<_>>()))
        });
        let (mut mesh, own) = agree(ranks, own.map_err(told)).map_err(Error::Told)?;
        let bytes: Vec<u8> = own.iter().flat_map(|(scan, found)| found.encoded(*scan)).collect();
        drop(own);
        let mut scanned = Vec::new();
        for from in ranks.gather(&bytes) {
            let mut from = &from[..];
            while !from.is_empty() {
                scanned.push(Scanned::decoded(&mut from).ok_or(Error::Message)?);
            }
        }
        scanned.sort_by_key(|(scan, _)| *scan);
        let mut all = Scanned::default();
        scanned.into_iter().for_each(|(_, found)| all.add(found));
        if all.open != [0, 0] {
            return Err(Error::Incomplete);
        }
        let sides = all.sides.iter().map(|&[triangle, tet, face]| Side { triangle, tet, face }).collect();
        all.tets.dedup();
        for [a, b, c, d, reference] in all.tets {
            mesh.tets.push([a, b, c, d], reference as i32);
        }
        let complexity = all.terms.into_iter().sum();
        let mut name = DefaultHasher::new();
        all.names.iter().for_each(|part| name.write_u64(*part));
        let numbers = renumber(&mut mesh);
        let vertices = files.vertices(&numbers);
        let Vertices { points, refs, .. } = agree(ranks, vertices.map_err(told)).map_err(Error::Told)?;
        (mesh.vertices, mesh.vertex_refs) = (points, refs);
        Ok(Self { mesh: Arc::new(mesh), numbers, sides, complexity, name: name.finish() })
    }

    /// All but vertices and tetrahedra.
    fn skin_of(team: Team<'_>, files: &Files) -> Result<TetMesh, Error> {
        let file = &files.mesh;
        let counts = file.counts();
        if counts.tets == 0 {
            return Err(adapt::Error::Empty.into());
        }
        Ok(TetMesh {
            edges: file.edges(team, 0..counts.edges)?,
            triangles: file.triangles(team, 0..counts.triangles)?,
            corners: file.corners()?,
            required_vertices: file.required_vertices()?,
            ridges: file.ridges()?,
            required_edges: file.required_edges()?,
            required_triangles: file.required_triangles()?,
            association: file.association()?,
            ..TetMesh::default()
        })
    }

    /// The outer triangles, which look outwards.
    pub fn outer(&self, team: Team<'_>) -> Vec<[u32; 3]> {
        let mut sides = vec![0u8; self.mesh.triangles.len()];
        self.sides.iter().for_each(|side| sides[side.triangle as usize] += 1);
        let outwards = outward_triangles(team, &self.mesh);
        outwards.into_iter().zip(sides).filter(|(_, sides)| *sides == 1).map(|(nodes, _)| nodes).collect()
    }

    /// ln M at its vertices, shape (n,).
    ///
    /// # Errors
    /// When the file of the metric cannot be read.
    pub fn logs(&self, files: &Files) -> Result<Vec<Sym3>, Error> {
        Ok(files.vertices(&self.numbers)?.logs)
    }

    /// As the skin of the mesh, on its model.
    pub fn skin<'a>(&'a self, team: Team<'_>, place: &'a Classification) -> Skin<'a> {
        Skin::new(team, (&self.mesh, place), Some(&self.numbers), self.sides.clone())
    }
}

impl Files {
    /// Looks at a slice of the tetrahedra.
    fn scan(&self, index: &TriangleIndex, scan: usize) -> Result<Scanned, Error> {
        let team = Team::alone();
        let all = self.size()[1];
        let range = scan * SCAN..all.min((scan + 1) * SCAN);
        let mut tets = self.tets(range.clone())?;
        let mut found = Scanned::default();
        let mut has_triangle = vec![0u8; tets.len()];
        for Side { triangle, tet, face } in index.sides(team, &tets.nodes) {
            has_triangle[tet as usize] |= 1 << face;
            found.sides.push([triangle, range.start as u32 + tet, face]);
            let [a, b, c, d] = tets.nodes[tet as usize];
            found.tets.push([a, b, c, d, tets.refs[tet as usize] as u32]);
        }
        for (t, nodes) in tets.nodes.iter().enumerate() {
            for (_, face) in FACES.iter().enumerate().filter(|(i, _)| has_triangle[t] & (1 << i) == 0) {
                let stands = stand_in(sorted3(face.map(|k| nodes[k])), tets.refs[t]);
                found.open = [found.open[0] ^ stands[0], found.open[1] ^ stands[1]];
            }
        }
        let mut name = DefaultHasher::new();
        name.write(bytemuck::cast_slice(&tets.nodes));
        name.write(bytemuck::cast_slice(&tets.refs));
        let numbers = renumbered(&mut [tets.nodes.as_flattened_mut()]);
        let Vertices { points, logs, .. } = self.vertices(&numbers)?;
        name.write(bytemuck::cast_slice(&points));
        logs.iter().for_each(|log| name.write(bytemuck::bytes_of(&log.0)));
        found.names.push(name.finish());
        let corners = |t: usize| tets.nodes[t].map(|v| points[v as usize]);
        let is_wrong = |t: &usize| !is_positive(corners(*t));
        let mut wrong = (0..tets.len()).filter(is_wrong);
        if let Some(t) = wrong.next() {
            let nodes = tets.nodes[t].map(|v| numbers[v as usize] + 1);
            return Err(adapt::Error::Inverted { tet: range.start + t + 1, nodes, others: wrong.count() }.into());
        }
        metric::held::check(team, logs.len(), |v| logs[v]).map_err(|error| match error {
            metric::Error::Sizes { vertex, sizes } => {
                metric::Error::Sizes { vertex: numbers[vertex - 1] as usize + 1, sizes }
            }
            error => error,
        })?;
        found.terms = match &self.metric {
            MetricOf::Analytic(source) => source.complexity_terms(all, tets.len(), corners),
            _ => complexity_terms(team, &points, &tets.nodes, &logs),
        };
        Ok(found)
    }
}

impl Scanned {
    fn add(&mut self, mut later: Self) {
        self.sides.append(&mut later.sides);
        self.tets.append(&mut later.tets);
        self.terms.append(&mut later.terms);
        self.names.append(&mut later.names);
        self.open = [self.open[0] ^ later.open[0], self.open[1] ^ later.open[1]];
    }

    /// As bytes, with the number of the scan.
    fn encoded(&self, scan: usize) -> Vec<u8> {
        let mut bytes = Vec::new();
        put(&mut bytes, &[scan as u64]);
        put(&mut bytes, &self.sides);
        put(&mut bytes, &self.tets);
        put(&mut bytes, &self.terms);
        put(&mut bytes, &self.open);
        put(&mut bytes, &self.names);
        bytes
    }

    /// From the front of some bytes.
    fn decoded(from: &mut &[u8]) -> Option<(u64, Self)> {
        let [scan]: [u64; 1] = take(from)?.try_into().ok()?;
        let (sides, tets, terms) = (take(from)?, take(from)?, take(from)?);
        let found = Self { sides, tets, terms, open: take(from)?.try_into().ok()?, names: take(from)? };
        Some((scan, found))
    }
}

/// Numbers that stand for a face of a tetrahedron with this reference.
fn stand_in([a, b, c]: [u32; 3], reference: i32) -> [u64; 2] {
    let words = [u64::from(a) << 32 | u64::from(b), u64::from(c) << 32 | u64::from(reference as u32)];
    FACTORS.map(|[first, second]| {
        let product = u128::from(words[0] ^ first) * u128::from(words[1] ^ second);
        (product as u64 ^ (product >> 64) as u64).wrapping_mul(first).rotate_left(29) ^ words[1].wrapping_mul(second)
    })
}

/// Odd numbers with well mixed bits.
const FACTORS: [[u64; 2]; 2] =
    [[0x9E37_79B9_7F4A_7C15, 0xC2B2_AE3D_27D4_EB4F], [0xD6E8_FEB8_6659_FD93, 0xA076_1D64_78BD_642F]];

/// Numbers all vertices of a mesh anew, in their order. Returns the numbers that they had, ascending.
fn renumber(mesh: &mut TetMesh) -> Vec<u32> {
    let TetMesh { edges, triangles, tets, corners, required_vertices, association, .. } = mesh;
    let mut lists: Vec<&mut u32> = Vec::new();
    lists.extend(edges.nodes.as_flattened_mut());
    lists.extend(triangles.nodes.as_flattened_mut());
    lists.extend(tets.nodes.as_flattened_mut());
    lists.extend(corners);
    lists.extend(required_vertices);
    lists.extend(association.vertices.iter_mut().map(|on| &mut on.vertex));
    lists.extend(association.edges.iter_mut().map(|on| &mut on.vertex));
    lists.extend(association.faces.iter_mut().map(|on| &mut on.vertex));
    let mut numbers: Vec<u32> = lists.iter().map(|v| **v).collect();
    numbers.sort_unstable();
    numbers.dedup();
    for v in lists {
        *v = numbers.partition_point(|&number| number < *v) as u32;
    }
    numbers
}
