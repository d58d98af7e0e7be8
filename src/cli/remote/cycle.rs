//! A loop on a service: its configuration names files that lie beside it there.
use super::Sent;
use crate::cli::files::{Files, Outputs};
use crate::cli::workplace::Workplace;
use crate::cycle::{FIRST, Loaded};
use std::path::Path;

/// Where the results of a loop lie in its folder.
const RESULT: &str = "result";

/// Has the configuration that is sent name the files that are sent with it.
///
/// # Errors
/// What is wrong with the configuration.
pub fn pack(sent: &mut Sent, place: &Workplace) -> Result<(), Box<dyn std::error::Error>> {
    // `--example` reads none.
    let Some((name, path)) = sent.read.iter().next() else { return Ok(()) };
    let (name, mut loaded) = (name.clone(), Loaded::read(path)?);
    sent.folder = Some(loaded.output().join(RESULT));
    let base = loaded.base.clone();
    let mesh = &mut loaded.config.mesh;
    for file in [&mut mesh.file, &mut mesh.bootstrap, &mut mesh.cad, &mut mesh.surface] {
        if let Some(path) = file.as_mut().filter(|path| path.as_path() != Path::new(FIRST)) {
            *path = sent.name(&base.join(&*path), false)?.into();
        }
    }
    loaded.config.output.folder = None;
    loaded.config.adapt.scratch = None;
    let packed = place.file(&name);
    let (mut files, mut outputs) = (Files::new(), Outputs::new());
    let target = files.writes(&packed, "the configuration that is sent", &[])?;
    outputs.text(&target, toml::to_string(&loaded.config)?.as_bytes())?;
    outputs.commit()?;
    sent.read.insert(name, packed);
    Ok(())
}
