//! `--heal`: the model without what is too small to mesh, made by a child process, since OpenCASCADE can crash on a faulty shape.
use super::solids::check_solids;
use crate::cli::child::{self, Answer, Task};
use crate::cli::workplace::Workplace;
use crate::cli::{load, table};
use crate::geometry::{Geometry, Healed, Model, Remedy, names};
use std::error::Error;
use std::ffi::OsString;
use std::path::Path;
use std::process::ExitCode;
use std::str::FromStr;

/// First argument of the child; then the model, the healed model's file, and the length or `-`.
const CHILD: &str = "heal-model-and-exit";

/// The length where none is given, of the diagonal.
const SHARE: f64 = 1e-4;

/// Below which length something is healed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Length {
    /// A ten-thousandth of the model's diagonal.
    Default,
    /// Model units.
    Given(f64),
}

impl FromStr for Length {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "-" { Ok(Self::Default) } else { crate::cli::positive(text).map(Self::Given) }
    }
}

/// Heals a model, writes it to `file` with its names beside, and tells what was done, a line each.
///
/// # Errors
/// When nothing valid comes of it, or what comes has no solid.
pub fn build(model: &Path, length: Length, file: &Path) -> Result<Vec<String>, Box<dyn Error>> {
    let place = Workplace::new().map_err(|error| format!("no folder for temporary files: {error}"))?;
    let length = match length {
        Length::Default => "-".to_owned(),
        Length::Given(length) => length.to_string(),
    };
    let told = place.file("healed.txt");
    let task = Task {
        name: CHILD,
        arguments: &[model.as_os_str(), file.as_os_str(), length.as_ref(), told.as_os_str()],
        file: model,
        doing: "healing it",
        crash: "OpenCASCADE crashes when it heals the model; repair it in the CAD program",
    };
    match task.run(&place)? {
        Answer::Done => Ok(std::fs::read_to_string(&told)?.lines().map(str::to_owned).collect()),
        Answer::Refused(told) => Err(told.into()),
        Answer::NotStarted => Err("geo-adapt cannot start itself".into()),
    }
}

/// If this process is the child of [`build`]: heals the model and tells the exit code.
pub fn child() -> Option<ExitCode> {
    child::answer(CHILD, |arguments| {
        let [model, file, length, told] = arguments else {
            return Err("a model, a file, a length and a file for what was done are wanted".into());
        };
        write([model, file, told], &length.to_string_lossy()).map_err(|error| error.to_string())
    })
}

fn write([path, file, told]: [&OsString; 3], length: &str) -> Result<(), Box<dyn Error>> {
    let path = Path::new(path);
    let mut model = Model::read(path)?;
    load::give_names(&mut model, path)?;
    let length = match length.parse()? {
        Length::Default => SHARE * model.topology().diagonal(),
        Length::Given(length) => length,
    };
    let (healed, done) = model
        .healed(length)
        .map_err(|error| format!("{}: with --heal {}: {error}", path.display(), table::figure(length)))?;
    check_solids(path, &healed)?;
    healed.write_brep(Path::new(file))?;
    names::write(Path::new(file), healed.names(), &[])?;
    Ok(std::fs::write(told, list(&model, &healed, length, &done))?)
}

/// What was done.
fn list(before: &Model, after: &Model, length: f64, done: &[Healed]) -> String {
    let faces = [before, after].map(|model| model.topology().faces.len());
    let mut text =
        format!("healed what is smaller than {}: {} faces are {} now\n", table::figure(length), faces[0], faces[1]);
    for remedy in [Remedy::CollapsedEdge, Remedy::CollapsedFace, Remedy::SewnEdge] {
        let all: Vec<&Healed> = done.iter().filter(|done| done.remedy == remedy).collect();
        let Some(largest) = all.iter().max_by(|a, b| a.size.total_cmp(&b.size)) else { continue };
        let (what, size) = match remedy {
            Remedy::CollapsedEdge => ("edges were collapsed", "length"),
            Remedy::CollapsedFace => ("faces were merged into their neighbours", "area"),
            Remedy::SewnEdge => ("open edges were sewn", "length"),
        };
        text += &format!(
            "{} {what}, the largest ({size} {}) at {}\n",
            all.len(),
            table::figure(largest.size),
            table::place(largest.at)
        );
    }
    text
}
