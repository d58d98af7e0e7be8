//! What is refined, and where: faces of the surfaces first, then tetrahedra.
//!
//! A face is on a surface where its dual edge, between the circumcentres of the two tetrahedra beside it, crosses from one region to another.
//! The crossing is the centre of its surface ball, the empty ball through its vertices. There the face is refined.
use super::circumsphere::{circle_centre, shortest_edge};
use super::domain::Domain;
use super::store::{NONE, Role, Store};
use crate::mesh::adjacency::FACES;
use crate::mesh::vector::{Vec3, distance};
use serde::Serialize;

/// The least angle of a surface triangle is 30°: its circumscribed circle has the radius of its shortest edge.
const CIRCLE_EDGE: f64 = 1.0;

/// No two vertices come nearer than this share of the least of surface distance, size and voxel spacing. So refinement ends.
const NEAREST: f64 = 0.25;

/// An item that has been put off so often is given up.
const PATIENCE: u8 = 30;

/// The least size and surface distance, in distances between voxels.
const FINEST: f64 = 0.01;

/// Most tetrahedra in a mesh: ids have 32 bits, and so have the corners of the output.
const MOST_TETS: f64 = 2e8;

/// Why there is no mesh.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum Error {
    #[error(
        "the surface is known to a ten-thousandth of a voxel only; give a --surface-distance and a --size of at least {0:.1e}"
    )]
    TooFine(f64),
    #[error(
        "tetrahedra of size {0} would be about {1:.0e}, more than the {MOST_TETS:.0e} of the largest mesh; give a greater --size"
    )]
    TooMany(f64, f64),
    #[error("needs more tetrahedra than ids have room for; give a greater --size or --surface-distance")]
    Full,
}

/// What the user asks for. Where a value is none, one is chosen by the image.
#[derive(Clone, Copy, Debug, Default)]
pub struct Wish {
    /// Greatest circumradius.
    pub size: Option<f64>,
    /// Greatest distance of a surface triangle from the surface.
    pub surface_distance: Option<f64>,
    /// Greatest ratio of circumradius to shortest edge.
    pub radius_edge: Option<f64>,
}

/// The limits for every tetrahedron and surface triangle, in units of the image.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Limits {
    /// Greatest radius of a circumsphere, or of a surface ball.
    pub size: f64,
    /// Greatest distance from the surface of the centre of a surface triangle's circumscribed circle.
    pub surface_distance: f64,
    /// Greatest ratio of circumradius to shortest edge.
    pub radius_edge: f64,
    /// Least distance between vertices.
    pub nearest: f64,
}

impl Limits {
    /// The limits for an image.
    ///
    /// # Errors
    /// When the mesh would be too large, or finer than the surface is known.
    pub fn new(wish: Wish, domain: &Domain) -> Result<Self, Error> {
        let size = wish.size.unwrap_or(4.0 * domain.mean_spacing());
        let surface_distance = wish.surface_distance.unwrap_or(0.5 * domain.mean_spacing());
        let nearest = NEAREST * surface_distance.min(size).min(domain.least_spacing());
        let radius_edge = wish.radius_edge.unwrap_or(2.0);
        Self { size, surface_distance, radius_edge, nearest }.foreseen(domain)
    }

    /// Refuses what would be too large, before the work. A Delaunay tetrahedron of circumradius R has a volume of about R³/6.
    fn foreseen(self, domain: &Domain) -> Result<Self, Error> {
        let finest = FINEST * domain.least_spacing();
        if self.surface_distance.min(self.size) < finest {
            return Err(Error::TooFine(finest));
        }
        let voxels = domain.padded().iter().product::<usize>();
        let inside = (0..voxels).filter(|&voxel| domain.voxel_region(voxel) != 0).count();
        let volume = inside as f64 * domain.frame().volume();
        let tets = 6.0 * volume / self.size.powi(3);
        if tets > MOST_TETS { Err(Error::TooMany(self.size, tets)) } else { Ok(self) }
    }
}

/// What is to be refined.
#[derive(Clone, Copy, Debug)]
pub struct Item {
    pub tet: u32,
    pub nodes: [u32; 4],
    pub part: Part,
    /// Where the new vertex goes.
    pub at: Vec3,
    /// How often it may still be put off.
    pub patience: u8,
}

/// Which part of a tetrahedron.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// The face opposite a local vertex, and the vertex beyond it.
    Face(u8, u32),
    /// All of it.
    Whole,
}

/// The ball about a crossing through the vertices of a face.
pub struct SurfaceBall {
    pub centre: Vec3,
    pub radius: f64,
}

/// What decides.
pub struct Rules<'a> {
    pub store: &'a Store,
    pub domain: &'a Domain,
    pub limits: &'a Limits,
}

impl Rules<'_> {
    /// The surface ball of a face, if it is on a surface. Both tetrahedra hold still.
    pub fn surface_ball(&self, t: u32, i: usize, n: u32) -> Option<SurfaceBall> {
        let store = self.store;
        let regions = [store.region(t), store.region(n)];
        if regions[0] == regions[1] {
            return None;
        }
        let centre = self.domain.crossing((store.centre(t), regions[0]), (store.centre(n), regions[1]));
        let v = store.nodes(t)[FACES[i][0]];
        Some(SurfaceBall { centre, radius: distance(store.at(v), centre) })
    }

    /// The face as an item, if it is on a surface and to be refined.
    pub fn face(&self, t: u32, i: usize, n: u32) -> Option<Item> {
        if n == NONE {
            return None;
        }
        let ball = self.surface_ball(t, i, n)?;
        let (store, limits) = (self.store, self.limits);
        if ball.radius <= limits.nearest {
            return None;
        }
        let nodes = store.nodes(t);
        let face = FACES[i].map(|k| nodes[k]);
        let bad = || {
            if ball.radius > limits.size || face.iter().any(|&v| store.role(v) != Role::Surface) {
                return true;
            }
            let points = face.map(|v| store.at(v));
            let circle = circle_centre(points);
            distance(circle, ball.centre) > limits.surface_distance
                || distance(circle, points[0]) > CIRCLE_EDGE * shortest_edge(&points)
        };
        bad().then(|| self.face_item(t, nodes, i, n, ball.centre))
    }

    /// A face as an item.
    pub fn face_item(&self, t: u32, nodes: [u32; 4], i: usize, n: u32, at: Vec3) -> Item {
        let beyond = self.store.nodes(n).into_iter().find(|v| !nodes.contains(v)).unwrap_or(NONE);
        Item { tet: t, nodes, part: Part::Face(i as u8, beyond), at, patience: PATIENCE }
    }

    /// The tetrahedron as an item, if it is inside and to be refined.
    pub fn tet(&self, t: u32) -> Option<Item> {
        let (store, limits) = (self.store, self.limits);
        if store.region(t) == 0 {
            return None;
        }
        let nodes = store.nodes(t);
        let (points, centre) = (store.corners(nodes), store.centre(t));
        let radius = distance(points[0], centre);
        let bad = radius > limits.size
            || radius > limits.radius_edge * shortest_edge(&points)
            || nodes.iter().any(|&v| store.role(v) == Role::Corner);
        (bad && radius > limits.nearest).then_some(Item {
            tet: t,
            nodes,
            part: Part::Whole,
            at: centre,
            patience: PATIENCE,
        })
    }
}
