//! Tetrahedra of a closed surface: Delaunay tetrahedra of its points, in which its edges and triangles are recovered by flips,
//! and by points added on it where these do not do; then the regions that it separates. At the end added points are taken off
//! the surface again where that can be done.
mod complex;
mod edges;
mod facets;
mod fill;
mod flips;
mod improve;
mod insert;
mod loosen;
mod order;
mod pipe;
mod predicates;
mod recovery;
mod regions;
mod shells;
mod suppress;
#[cfg(test)]
mod tests;
mod triangles;
mod twofold;
mod unused;

use crate::mesh::vector::Vec3;
pub use complex::Triangulation;
pub use insert::PointError;
use recovery::Recovery;
use triangles::Triangles;

/// Where points that have to be added to the surface lie: the caller's choice, for instance on the CAD model.
pub trait Placement {
    /// The place of vertex `vertex`, which splits the edge `ends` of the surface, all triangles at it, and is that share `at` of
    /// the way from the first to the second end; `straight` is the place on the straight edge.
    fn on_edge(&mut self, vertex: u32, ends: [u32; 2], at: f64, straight: Vec3) -> Vec3;

    /// Whether to go on; asked before each edge and triangle that takes some work.
    fn go_on(&mut self) -> bool {
        true
    }

    /// The place of vertex `vertex`, which splits the triangle in three, at barycentric coordinates `at`; `straight` is the
    /// place in the plane triangle.
    fn in_triangle(&mut self, vertex: u32, corners: [u32; 3], at: [f64; 3], straight: Vec3) -> Vec3;
}

/// Added points lie on the flat triangles of the input.
#[derive(Clone, Copy, Debug, Default)]
pub struct Flat;

impl Placement for Flat {
    fn on_edge(&mut self, _: u32, _: [u32; 2], _: f64, straight: Vec3) -> Vec3 {
        straight
    }

    fn in_triangle(&mut self, _: u32, _: [u32; 3], _: [f64; 3], straight: Vec3) -> Vec3 {
        straight
    }
}

/// The same, as long as this says to go on.
pub struct FlatWhile<'a>(pub &'a dyn Fn() -> bool);

impl Placement for FlatWhile<'_> {
    fn on_edge(&mut self, vertex: u32, ends: [u32; 2], at: f64, straight: Vec3) -> Vec3 {
        Flat.on_edge(vertex, ends, at, straight)
    }

    fn in_triangle(&mut self, vertex: u32, corners: [u32; 3], at: [f64; 3], straight: Vec3) -> Vec3 {
        Flat.in_triangle(vertex, corners, at, straight)
    }

    fn go_on(&mut self) -> bool {
        self.0()
    }
}

/// Where an added point comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Origin {
    /// An edge of the surface, as it was then (its ends may be added points).
    Edge([u32; 2]),
    /// A triangle of the surface, as it was then.
    Triangle([u32; 3]),
    /// None: it lies inside a region.
    Inside,
}

/// A point that is not one of the input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Added {
    /// Its place, as the caller gave it.
    pub point: Vec3,
    /// What it splits.
    pub origin: Origin,
}

/// Bounds.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Points that may be added per point of the input (and a thousand more).
    pub most_added: f64,
    /// Take added points off the surface again where that can be done; points inside may take their places.
    pub suppress: bool,
    /// Flip flat tetrahedra away where better ones take their places.
    pub improve: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self { most_added: 2.0, suppress: true, improve: true }
    }
}

/// Why a surface has no tetrahedra. Triangles and points are those of the input; numbers of points beyond it are added ones.
#[derive(Clone, Debug, PartialEq)]
pub enum Error {
    /// The points have no Delaunay tetrahedra.
    Points(PointError),
    /// A vertex of the triangle is not one of the points, or two are the same.
    Corners {
        /// The triangle.
        triangle: u32,
    },
    /// Two triangles have the same vertices.
    Repeated {
        /// The two.
        triangles: [u32; 2],
    },
    /// Two triangles cross, or one crosses an edge of the other.
    Crossing {
        /// The two.
        triangles: [u32; 2],
        /// Near here.
        at: Vec3,
    },
    /// A point lies on a triangle or its border, but is no corner of it; or the triangle is no more than a line.
    Touching {
        /// The triangle.
        triangle: u32,
        /// The point.
        point: u32,
        /// Here.
        at: Vec3,
    },
    /// The caller did not want to go on.
    Stopped,
    /// The triangle could not be recovered with the points that may be added.
    Unrecovered {
        /// The triangle.
        triangle: u32,
        /// Its centre, or that of the part of it that is missing.
        at: Vec3,
    },
}

/// Tetrahedra that have each triangle of a surface, or its parts, as a face.
#[derive(Clone, Debug, Default)]
pub struct Tetrahedra {
    /// The points of the input, then the added ones.
    pub points: Vec<Vec3>,
    /// What the added ones split.
    pub added: Vec<Added>,
    /// Positive tetrahedra, none outside.
    pub tets: Vec<[u32; 4]>,
    /// Region of each tetrahedron, from 1.
    pub regions: Vec<u32>,
    /// Number of regions, counting 0, the outside.
    pub region_count: u32,
    /// The triangles of the input, in its orientation, split at added points.
    pub triangles: Vec<[u32; 3]>,
    /// Input triangle of each.
    pub source: Vec<u32>,
    /// Region of each on the side that its right-hand normal points to, and on the other.
    pub sides: Vec<[u32; 2]>,
}

/// Fills a closed surface. Its triangles may have any orientation and more than two may meet at an edge; parts that close
/// nothing have the same region on both sides. Points that no triangle has become inner vertices.
///
/// # Errors
/// See [`Error`].
pub fn tetrahedralise(
    points: &[Vec3],
    triangles: &[[u32; 3]],
    placement: &mut dyn Placement,
    options: Options,
) -> Result<Tetrahedra, Error> {
    for (i, t) in triangles.iter().enumerate() {
        if t.iter().any(|&v| v as usize >= points.len()) || t[0] == t[1] || t[1] == t[2] || t[2] == t[0] {
            return Err(Error::Corners { triangle: i as u32 });
        }
    }
    let surface = Triangles::new(points.len(), triangles);
    if let Some(triangles) = surface.first_repeated() {
        return Err(Error::Repeated { triangles });
    }
    // Scaled by a power of two, which is exact, so that no determinant over- or underflows.
    let most = points.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
    let scale = if most.is_finite() && most > 1e-290 { (-most.log2().floor()).exp2() } else { 1.0 };
    let scaled: Vec<Vec3> = points.iter().map(|p| p.map(|x| x * scale)).collect();
    let mesh = Triangulation::new(&scaled).map_err(Error::Points)?;
    drop(scaled);
    let mut recovery = Recovery {
        mesh,
        surface,
        journal: flips::Journal::default(),
        insertion: insert::Scratch::default(),
        tets: Vec::new(),
        made: Vec::new(),
        placement,
        added: Vec::new(),
        scale,
        most_added: 1000 + (options.most_added.max(0.0) * points.len() as f64) as usize,
        budget: 0,
    };
    recovery.run()?;
    let mut regions = recovery.regions().map_err(|t| recovery.unrecovered(t))?;
    if options.improve {
        recovery.improve(&mut regions);
    }
    let Recovery { mesh, surface, added, .. } = recovery;
    let mut result = Tetrahedra {
        points: points.iter().copied().chain(added.iter().map(|a| a.point)).collect(),
        added,
        region_count: regions.count,
        triangles: surface.nodes,
        source: surface.source,
        sides: regions.sides,
        ..Tetrahedra::default()
    };
    for (t, &n) in mesh.nodes.iter().enumerate() {
        if n[0] != complex::GHOST && regions.of[t] != 0 {
            result.tets.push(n);
            result.regions.push(regions.of[t]);
        }
    }
    if options.suppress {
        suppress::suppress(&mut result, points.len(), scale);
        result.points[..points.len()].copy_from_slice(points);
    }
    unused::drop_unused(&mut result, points.len());
    Ok(result)
}
