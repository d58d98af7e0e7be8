//! `geo-adapt model -o`: a model in other units or at another place, as a file that all commands take.
use crate::cli::files::{Files, Outputs};
use crate::cli::load;
use crate::cli::translation::Translation;
use crate::cli::workplace::Workplace;
use crate::geometry::{Geometry, Model, names};
use std::error::Error;
use std::path::{Path, PathBuf};

/// What is asked for.
#[derive(clap::Args)]
pub struct PlaceArguments {
    /// Write the model as .brep, its names and colours beside it as MODEL.brep.names.json: all commands take that file, with a mesh of the same
    /// unit. Faces, edges and vertices keep their numbers
    #[arg(short, long, value_name = "OUT.brep", conflicts_with = "name")]
    pub output: Option<PathBuf>,
    /// With -o, multiply coordinates, about the origin: 0.001 from millimetres to metres
    #[arg(long, value_name = "F", value_parser = crate::cli::positive, allow_negative_numbers = true, requires = "output")]
    scale: Option<f64>,
    /// With -o, move by this, after --scale
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, requires = "output")]
    translate: Option<Translation>,
}

impl PlaceArguments {
    /// Writes a model, and returns it as it is read back.
    ///
    /// # Errors
    /// When the model cannot be read, transformed or written; when not all of it comes back.
    pub fn write(&self, path: &Path, output: &Path) -> Result<Model, Box<dyn Error>> {
        let mut files = Files::new().reads_models([path]);
        let to = files.writes(output, "-o", &["brep"])?;
        let beside = files.writes(&names::of_model(output), "the names beside -o", &[])?;
        let model = load::model(path)?;
        let named = |what: &str| format!("{}: {what}", path.display());
        let (factor, by) = (self.scale.unwrap_or(1.0), self.translate.unwrap_or_default().0);
        let placed = model.placed(factor, by).map_err(|error| named(&error.to_string()))?;
        let place = Workplace::new().map_err(|error| format!("no folder for temporary files: {error}"))?;
        let file = place.file("placed.brep");
        placed.write_brep(&file)?;
        // OpenCASCADE's own tolerances are lengths: below them small things are lost.
        let lost =
            |error: Box<dyn Error>| if error.is::<crate::geometry::Error>() { named(LOST).into() } else { error };
        let mut back = load::model(&file).map_err(lost)?;
        if counts(&back) != counts(&model) {
            return Err(named(LOST).into());
        }
        back.rename(placed.names().clone());
        let mut outputs = Outputs::new();
        outputs.model(&file, (&to, &beside), back.names())?;
        outputs.commit()?;
        Ok(back)
    }
}

/// Why a model is not written.
const LOST: &str =
    "at that size OpenCASCADE does not keep all faces and edges, which meet within 1e-7; give a scale nearer to 1";

/// Faces, edges, vertices and solids.
fn counts(model: &Model) -> [usize; 4] {
    let topology = model.topology();
    [topology.faces.len(), topology.edges.len(), topology.vertices.len(), topology.solids as usize]
}
