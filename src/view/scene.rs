//! All there is to show of a mesh.
use super::colour::{self, Rgb};
use super::streamlines::Velocity;
use super::surface::{self, Surface};
use super::values::{self, ScalarField};
use crate::geometry::{Label, Names};
use crate::mesh::vector::{Vec3, add, distance, scale};
use crate::mesh::{Elements, TetMesh};
use crate::metric::Sym3;
use crate::metric::statistics::by_reference;
use crate::tasks::{GRAIN, Team};
use serde::Serialize;
use std::collections::BTreeMap;

/// Classes of the histogram of the qualities, of equal width.
pub const CLASSES: usize = 25;

/// What comes with a mesh.
#[derive(Default)]
pub struct Given {
    /// What the picture is called.
    pub title: String,
    /// ln M at the vertices.
    pub logs: Option<Vec<Sym3>>,
    /// What to colour by, besides.
    pub fields: Vec<ScalarField>,
    /// What streamlines follow.
    pub velocity: Option<Velocity>,
    /// Names of references.
    pub names: Names,
    /// The file that names typed on the page belong into.
    pub names_file: NamesFile,
    /// What is told of a model where one is shown, not a mesh.
    pub model: Option<OfModel>,
    /// Edges of the model as polygons.
    pub model_edges: Vec<Vec<Vec3>>,
    /// What is told beside the picture: name and value.
    pub figures: Vec<[String; 2]>,
}

/// A names file as it is so far.
#[derive(Default, Serialize)]
pub struct NamesFile {
    /// What it is called, without its folder.
    pub file: String,
    /// What is in it.
    pub names: Names,
    /// Names of fields that are in it.
    pub fields: Vec<String>,
}

/// What is told of a model that is shown: its triangles have the numbers of its faces as references.
pub struct OfModel {
    /// How many entities it has.
    pub counts: String,
    /// A line on each face, by its number.
    pub about: BTreeMap<i32, String>,
}

/// Shapes of the elements.
pub struct Quality {
    /// How they were measured.
    pub name: String,
    /// Mean ratio of each tetrahedron, or of each triangle of a mesh without tetrahedra.
    pub values: Vec<f32>,
    /// How many there are in each class.
    pub histogram: Vec<usize>,
}

/// A reference: how many elements have it, its name and its colour.
pub struct Reference {
    /// The reference.
    pub reference: i32,
    /// Elements that have it.
    pub count: usize,
    /// Its name, if it has one.
    pub name: Option<String>,
    /// Its colour.
    pub colour: Rgb,
}

/// A mesh as it is shown.
pub struct Scene<'m> {
    /// The mesh.
    pub mesh: &'m TetMesh,
    /// What comes with it; its ln M is used up.
    pub given: Given,
    /// Least and greatest corner of the box around it.
    pub bounds: [Vec3; 2],
    /// The triangles.
    pub surface: Surface,
    /// Edges of the model, as edges of the mesh.
    pub ridges: Elements<2>,
    /// Shapes.
    pub quality: Quality,
    /// References of the triangles, ascending.
    pub surfaces: Vec<Reference>,
    /// References of the tetrahedra, ascending.
    pub regions: Vec<Reference>,
}

impl<'m> Scene<'m> {
    /// Of a mesh.
    pub fn new(team: Team<'_>, mesh: &'m TetMesh, mut given: Given) -> Self {
        let logs = given.logs.take();
        let surface = Surface::of(team, mesh);
        let ridges = surface::ridges(team, mesh, &surface.triangles);
        let quality = Quality::of(team, mesh, &surface, logs.as_deref());
        if let Some(logs) = &logs {
            given.fields.extend(ScalarField::of_metric(team, logs));
        }
        let surfaces = references(team, &surface.triangles, &given.names.triangles, colour::of_surface);
        let regions = references(team, &mesh.tets, &given.names.tetrahedra, colour::of_region);
        Self { mesh, given, bounds: bounds(team, mesh), surface, ridges, quality, surfaces, regions }
    }

    /// Middle of the box.
    pub fn centre(&self) -> Vec3 {
        scale(add(self.bounds[0], self.bounds[1]), 0.5)
    }

    /// Half the diagonal of the box.
    pub fn radius(&self) -> f64 {
        0.5 * distance(self.bounds[0], self.bounds[1])
    }

    /// The quality that a triangle is coloured by: its own, or that of the tetrahedron behind it; NaN without one.
    pub fn quality_of_triangle(&self, triangle: u32) -> f32 {
        let element = if self.mesh.tets.is_empty() { triangle } else { self.surface.sides[triangle as usize][0] };
        self.quality.values.get(element as usize).copied().unwrap_or(f32::NAN)
    }
}

impl Quality {
    fn of(team: Team<'_>, mesh: &TetMesh, surface: &Surface, logs: Option<&[Sym3]>) -> Self {
        let (values, what) = if mesh.tets.is_empty() {
            (values::of_triangles(team, mesh, &surface.triangles, logs), "triangles")
        } else {
            (values::of_tets(team, mesh, logs), "tetrahedra")
        };
        let parts = team.chunks(GRAIN, values.len(), |range| {
            let mut counts = [0usize; CLASSES];
            values[range].iter().for_each(|&q| counts[((q * CLASSES as f32) as usize).min(CLASSES - 1)] += 1);
            counts
        });
        let mut histogram = vec![0; CLASSES];
        parts.iter().for_each(|part| histogram.iter_mut().zip(part).for_each(|(all, count)| *all += count));
        let place = if logs.is_some() { "in the metric" } else { "in space" };
        Self { name: format!("mean ratio of {what}, {place}"), values, histogram }
    }
}

fn bounds(team: Team<'_>, mesh: &TetMesh) -> [Vec3; 2] {
    let empty = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    let join = |[low, high]: [Vec3; 2], [l, h]: [Vec3; 2]| {
        [std::array::from_fn(|i| low[i].min(l[i])), std::array::from_fn(|i| high[i].max(h[i]))]
    };
    let parts = team.chunks(GRAIN, mesh.vertices.len(), |range| {
        mesh.vertices[range].iter().fold(empty, |all, &p| join(all, [p, p]))
    });
    let all = parts.into_iter().fold(empty, join);
    if all[0][0] <= all[1][0] { all } else { [[0.0; 3]; 2] }
}

fn references<const N: usize>(
    team: Team<'_>,
    elements: &Elements<N>,
    names: &BTreeMap<i32, Label>,
    usual: fn(usize) -> Rgb,
) -> Vec<Reference> {
    let counts = by_reference(team, elements);
    let reference = |(index, (reference, count)): (usize, (i32, usize))| {
        let Label { name, colour } = names.get(&reference).cloned().unwrap_or_default();
        Reference {
            reference,
            count,
            name,
            colour: colour.as_deref().and_then(colour::parse).unwrap_or_else(|| usual(index)),
        }
    };
    counts.into_iter().enumerate().map(reference).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::samples::cube;

    #[test]
    fn a_scene_of_a_cube() {
        let mesh = cube(3);
        let mut given = Given { logs: Some(vec![Sym3::ZERO; mesh.vertices.len()]), ..Given::default() };
        given.names.triangles.insert(2, Label { name: Some("east".into()), colour: Some("#ff0000".into()) });
        let scene = Scene::new(Team::alone(), &mesh, given);
        assert_eq!((scene.centre(), scene.bounds[1]), ([0.5; 3], [1.0; 3]));
        assert_eq!(scene.quality.histogram.iter().sum::<usize>(), mesh.tets.len());
        assert_eq!(scene.surfaces.len(), 6);
        assert_eq!((scene.surfaces[1].name.as_deref(), scene.surfaces[1].colour), (Some("east"), [1.0, 0.0, 0.0]));
        assert_eq!(scene.given.fields.len(), 2);
        assert!(scene.quality_of_triangle(0) > 0.5);
    }

    #[test]
    fn nothing_is_a_scene_too() {
        let mesh = TetMesh::default();
        let scene = Scene::new(Team::alone(), &mesh, Given::default());
        assert_eq!((scene.radius(), scene.surfaces.len()), (0.0, 0));
    }
}
