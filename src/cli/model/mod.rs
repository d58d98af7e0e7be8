//! `geo-adapt model`.
mod listing;
mod naming;
mod placing;
mod text;

use super::files::{Files, Outputs};
use super::{Outcome, load};
use crate::geometry::names;
use listing::Listing;
use naming::Naming;
use placing::PlaceArguments;
use std::path::PathBuf;
use std::process::ExitCode;
pub use text::{about, counts};

/// Arguments of `geo-adapt model`.
#[derive(clap::Args)]
pub struct Arguments {
    /// The model: .step, .stp, .iges, .igs, .brep or .egads
    pub(super) file: PathBuf,
    /// Print JSON. There too everything counts from 1
    #[arg(long)]
    json: bool,
    /// Gives faces a name, by number or as the one nearest to a point: inlet=3,7 or wall=near:0,0,1. It is kept in MODEL.names.json (as
    /// part.step.names.json), which every command reads; may be given several times
    #[arg(long, value_name = "NAME=FACES", allow_hyphen_values = true)]
    name: Vec<Naming>,
    #[command(flatten)]
    place: PlaceArguments,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    let path = &arguments.file;
    if let Some(output) = &arguments.place.output {
        let model = arguments.place.write(path, output)?;
        let text = if arguments.json { listed(&model, true)? } else { text::written(&model, output) };
        super::print(&text)?;
        return Ok(ExitCode::SUCCESS);
    }
    if arguments.name.is_empty() {
        let model = load::model(path)?;
        super::print(&listed(&model, arguments.json)?)?;
        return Ok(ExitCode::SUCCESS);
    }
    let to = names::of_model(path);
    let target = Files::new().reads([path]).writes(&to, "--name", &["json"])?;
    let mut model = load::model(path)?;
    let found = naming::faces(&model, &arguments.name).map_err(|error| format!("{}: {error}", path.display()))?;
    // Of names that a BREP file shares with a mesh those of the model are taken over.
    let mut kept = names::read_of_model(path)?;
    kept.triangles.retain(|number, _| model.names().triangles.contains_key(number));
    kept.edges.retain(|number, _| model.names().edges.contains_key(number));
    kept.tetrahedra.retain(|number, _| model.names().tetrahedra.contains_key(number));
    naming::name(&mut kept, &found);
    let mut outputs = Outputs::new();
    outputs.names(&target, &kept)?;
    outputs.commit()?;
    load::give_names(&mut model, path)?;
    let text = if arguments.json {
        listed(&model, true)?
    } else {
        naming::describe(&found) + &format!("the names are in {}\n", to.display())
    };
    super::print(&text)?;
    Ok(ExitCode::SUCCESS)
}

fn listed(model: &crate::geometry::Model, json: bool) -> Result<String, serde_json::Error> {
    if json {
        serde_json::to_string_pretty(&Listing::new(model)).map(|text| text + "\n")
    } else {
        Ok(text::describe(model))
    }
}
