//! Options for what has no CAD model: a surface given as triangles, and how triangles become a model.
use super::load;
use crate::formats::read_surface;
use crate::geometry::classify::{self, Classification};
use crate::geometry::discrete::{DEFAULT_RIDGE_ANGLE, DiscreteOptions};
use crate::geometry::{Discrete, Model};
use crate::mesh::TetMesh;
use crate::tasks::Team;
use std::path::{Path, PathBuf};

/// What the boundary lies on where there is no CAD model.
#[derive(Clone, clap::Args)]
#[group(skip)]
pub struct SurfaceArguments {
    /// Instead of --cad, the surface that the boundary lies on: .stl, .obj, .ply, or the boundary of a mesh of any format. In a
    /// loop: the first mesh, so that nothing drifts
    #[arg(long, value_name = "FILE", conflicts_with = "cad")]
    pub surface: Option<PathBuf>,
    /// Without --cad: angle in degrees between triangles beyond which their edge is a ridge; or `none`, then only listed edges and those
    /// between references are [default: 45]
    #[arg(long, value_name = "DEG", value_parser = ridge_angle, conflicts_with = "cad", allow_negative_numbers = true)]
    ridge_angle: Option<f64>,
    /// Without --cad: triangles and ridges are taken as they are, flat and straight; else smooth patches and curves go through their vertices
    #[arg(long, conflicts_with = "cad")]
    flat_surface: bool,
}

/// An angle, or none: nothing turns by more than 180°.
pub fn ridge_angle(text: &str) -> Result<f64, String> {
    if text == "none" {
        return Ok(180.0);
    }
    let angle: f64 = text.parse().map_err(|_| "give an angle in degrees, or none")?;
    if angle > 0.0 && angle <= 180.0 {
        Ok(angle)
    } else {
        Err("give an angle above 0 and up to 180 degrees, or none".into())
    }
}

impl SurfaceArguments {
    /// How triangles become a model.
    pub fn options(&self) -> DiscreteOptions {
        let ridge_angle_deg = self.ridge_angle.unwrap_or(DEFAULT_RIDGE_ANGLE);
        DiscreteOptions { ridge_angle_deg, smooth: !self.flat_surface }
    }

    /// The model of --surface, if there is one. What the user should know is added to `notices`.
    ///
    /// # Errors
    /// When it cannot be read or has no triangles, by the file's name.
    pub fn model(&self, team: Team<'_>, notices: &mut Vec<String>) -> Result<Option<Model>, String> {
        let Some(path) = &self.surface else { return Ok(None) };
        let read = read_surface(team, path).map_err(|error| error.to_string())?;
        notices.extend(read.notices);
        let (surface, _) = Discrete::new(team, &read.content.mesh, &self.options())
            .map_err(|error| format!("{}: {error}", path.display()))?;
        Ok(Some(Model::Discrete(surface)))
    }

    /// The model of --cad or of --surface, if there is one; notices are printed.
    ///
    /// # Errors
    /// When the file is no such model.
    pub fn model_or(&self, team: Team<'_>, cad: Option<&Path>) -> Result<Option<Model>, Box<dyn std::error::Error>> {
        if let Some(path) = cad {
            return load::model(path).map(Some);
        }
        let mut notices = Vec::new();
        let model = self.model(team, &mut notices)?;
        notices.iter().for_each(crate::cli::note);
        Ok(model)
    }

    /// The model of --cad or of --surface, else the mesh's own surface, and where the mesh of a file lies on it; notices are printed.
    ///
    /// # Errors
    /// When a file is no such model, or the mesh does not lie on it.
    pub fn lies(
        &self,
        team: Team<'_>,
        (name, mesh): (&Path, &TetMesh),
        cad: Option<&Path>,
        tolerance: Option<f64>,
    ) -> Result<(Model, Classification), Box<dyn std::error::Error>> {
        let name = name.display();
        let (Some(path), Some(model)) = (cad.or(self.surface.as_deref()), self.model_or(team, cad)?) else {
            let own = self.own(team, mesh).map_err(|error| format!("{name}: {error}"))?;
            crate::cli::note(
                "without --cad the curvature is an estimate from the mesh's triangles; it can be no better than they are",
            );
            return Ok(own);
        };
        let options = classify::Options { tolerance, ..classify::Options::default() };
        let (place, report) = classify::classify(team, mesh, &model, &options)
            .map_err(|error| format!("{name} on {}: {error}", path.display()))?;
        report.notices.iter().for_each(crate::cli::note);
        Ok((model, place))
    }

    /// The mesh's own surface as its model, and where it lies on that.
    ///
    /// # Errors
    /// When it has none.
    pub fn own(&self, team: Team<'_>, mesh: &TetMesh) -> Result<(Model, Classification), crate::geometry::Error> {
        let (surface, place) = Discrete::new(team, mesh, &self.options())?;
        Ok((Model::Discrete(surface), place))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Geometry;
    use std::fmt::Write;

    #[test]
    fn an_angle_or_none() {
        assert_eq!((ridge_angle("none"), ridge_angle("30"), ridge_angle("180")), (Ok(180.0), Ok(30.0), Ok(180.0)));
        for wrong in ["0", "-3", "181", "nan", "inf", "", "sharp"] {
            assert!(ridge_angle(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_surface_is_read_and_has_the_ridges_of_the_angle() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("roof.obj");
        // Two slopes of 20° each.
        let mut text = String::new();
        for (x, z) in [(-1.0, 0.0), (0.0, 0.364), (1.0, 0.0)] {
            let _ = writeln!(text, "v {x} 0 {z}\nv {x} 1 {z}");
        }
        text.push_str("f 1 3 4 2\nf 3 5 6 4\n");
        std::fs::write(&path, text).unwrap();
        let faces = |ridge_angle| {
            let arguments = SurfaceArguments { surface: Some(path.clone()), ridge_angle, flat_surface: false };
            let model = arguments.model(Team::alone(), &mut Vec::new()).unwrap().unwrap();
            model.topology().faces.len()
        };
        assert_eq!([None, Some(30.0), Some(180.0)].map(faces), [1, 2, 1]);
        let arguments = |name: &str| {
            let surface = Some(folder.path().join(name));
            SurfaceArguments { surface, ridge_angle: None, flat_surface: false }
        };
        std::fs::write(folder.path().join("none.ply"), "ply\nformat ascii 1.0\nend_header\n").unwrap();
        for name in ["none.ply", "nothing.stl", "nothing.xyz"] {
            let error = arguments(name).model(Team::alone(), &mut Vec::new()).err().unwrap();
            assert!(error.contains(name), "{error}");
        }
    }
}
