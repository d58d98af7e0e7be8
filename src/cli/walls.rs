//! Walls: surfaces of a mesh that an option names, the faces of the model under them, and the layers that a mesh has there.
use super::adapt::parts::{Found, Part};
use super::table::{Table, figure};
use crate::formats::Dataset;
use crate::geometry::classify::Classification;
use crate::geometry::{Model, Names, called, on_mesh};
use crate::mesh::TetMesh;
use crate::mesh::vector::{area2, norm};
use crate::sizing::layer::{Asked, Measured, Walls, distances, from_triangles, measure};
use crate::tasks::Team;
use serde::Serialize;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::Path;

/// Triangles with no more than this share of a face's area are few.
const FEW: f64 = 1e-3;

/// A mesh and what is known of it.
pub struct Places<'a> {
    pub mesh: &'a TetMesh,
    pub place: &'a Classification,
    pub model: &'a Model,
    pub names: &'a Names,
}

impl Places<'_> {
    /// The faces of the model under surfaces of the mesh, ascending. A face is not meant by a few triangles at its border that lie on it as well as on
    /// the face beside it.
    pub fn faces(&self, references: &[i32]) -> Vec<u32> {
        let mut areas: BTreeMap<u32, [f64; 2]> = BTreeMap::new();
        for (&face, (nodes, reference)) in self.place.faces.iter().zip(self.mesh.triangles.iter()) {
            let [a, b, c] = nodes.map(|v| self.mesh.vertices[v as usize]);
            let area = norm(area2(a, b, c));
            let [all, named] = areas.entry(face).or_default();
            *all += area;
            *named += if references.contains(&reference) { area } else { 0.0 };
        }
        areas.into_iter().filter(|(_, [all, named])| *named > FEW * all).map(|(face, _)| face).collect()
    }

    /// The walls of --wall, with their faces.
    ///
    /// # Errors
    /// When the mesh has no such surface.
    pub fn walls(&self, walls: &[Walls]) -> Result<Vec<Asked>, String> {
        let each = walls.iter().flat_map(|walls| &walls.0);
        let asked = each.map(|wall| {
            let references = surfaces_of(&wall.place, self.mesh, self.names)?;
            Ok(Asked { wall: wall.clone(), faces: self.faces(&references) })
        });
        asked.collect()
    }
}

/// The names of a mesh's references: its own, else those of its model.
pub fn names_on<'n>(own: &'n Names, mesh: &TetMesh, place: &Classification, model: &Model) -> Cow<'n, Names> {
    if own.is_empty() { Cow::Owned(on_mesh(mesh, place, model)) } else { Cow::Borrowed(own) }
}

/// The references of the surfaces that are a wall: one, or several as 3+4+tail.
fn surfaces_of(place: &str, mesh: &TetMesh, names: &Names) -> Result<Vec<i32>, String> {
    let is_whole = !called(&names.triangles, place).is_empty();
    let parts: Result<Vec<Part>, String> =
        if is_whole { place.parse().map(|part| vec![part]) } else { place.split('+').map(str::parse).collect() };
    surfaces("--wall", &parts?, mesh, names)
}

/// The references of the surfaces that an option names.
///
/// # Errors
/// When the mesh has no such surface, or it is a region.
pub fn surfaces(by: &str, parts: &[Part], mesh: &TetMesh, names: &Names) -> Result<Vec<i32>, String> {
    let mut references = Vec::new();
    for part in parts {
        for found in part.find(mesh, names).map_err(|error| format!("{by}: {error}"))? {
            match found {
                Found::Surface(reference) => references.push(reference),
                Found::Region(reference) => {
                    return Err(format!("{by}: {reference} is a region; name a surface of the mesh"));
                }
            }
        }
    }
    Ok(references)
}

/// The layers of a mesh along a wall.
#[derive(Serialize)]
pub struct OfWall {
    /// The wall, as the option names it.
    wall: String,
    #[serde(flatten)]
    layers: Measured,
}

/// Measures the layers of a mesh along the walls of --wall, by the exact distance from the model on which it lies, or from its own triangles.
///
/// # Errors
/// When the mesh has no such surface, or no layers are asked for there.
pub fn measured(
    team: Team<'_>,
    (name, data): (&Path, &Dataset),
    lies: Option<(&Model, &Classification)>,
    walls: &[Walls],
) -> Result<Vec<OfWall>, String> {
    let mesh = &data.mesh;
    let names = lies.map_or(Cow::Borrowed(&data.names), |(model, place)| names_on(&data.names, mesh, place, model));
    let each = walls.iter().flat_map(|walls| &walls.0).map(|wall| {
        let Some(growth) = &wall.growth else {
            return Err(format!(
                "--wall: {}: law=spalding alone has no first height: give growth=1.2 with it",
                wall.place
            ));
        };
        let references = surfaces_of(&wall.place, mesh, &names)?;
        let distances = match lies {
            Some((model, place)) => {
                let on = Places { mesh, place, model, names: &names };
                distances(team, mesh, place, model, &on.faces(&references))
            }
            None => from_triangles(team, mesh, &references),
        };
        let is_wall = |triangle: usize| references.contains(&mesh.triangles.refs[triangle]);
        let layers = measure(mesh, &distances, is_wall, growth)
            .ok_or_else(|| format!("--wall: {}: no tetrahedron stands on a triangle of it alone", wall.place))?;
        Ok(OfWall { wall: wall.place.clone(), layers })
    });
    each.collect::<Result<_, String>>().map_err(|error| format!("{}: {error}", name.display()))
}

impl OfWall {
    /// Rows that tell of it.
    pub fn rows(&self, table: &mut Table) {
        let Measured { vertices, asked, mean, least, greatest, deviation, depth, points_asked, points } = self.layers;
        table.row(&format!("wall {}", self.wall), format_args!("{vertices} vertices"));
        let [asked, mean, least, greatest] = [asked, mean, least, greatest].map(figure);
        table.row(
            "  first height",
            format_args!(
                "mean {mean}   least {least}   greatest {greatest}   scatter {:.1} % (asked {asked})",
                100.0 * deviation
            ),
        );
        let depth = figure(depth);
        table.row("  points across", format_args!("{points:.1} up to {depth} (asked {points_asked:.1})"));
    }
}
