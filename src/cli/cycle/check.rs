//! Options of a configuration that go to other commands: refused before the loop if those would refuse them.
use crate::cli::Command;
use crate::cycle::{Loaded, made_of};
use clap::Parser;

/// Refuses options that `adapt` and `bootstrap` do not take.
pub fn words(loaded: &Loaded) -> Result<(), String> {
    let config = &loaded.config;
    let fixed = |words: &[&str]| words.iter().map(|&word| word.to_owned()).collect::<Vec<String>>();
    let mesh = &config.mesh;
    let has_model = mesh.cad.is_some() || mesh.surface.is_some() || mesh.bootstrap.is_some();
    let (option, file) = made_of(config);
    let mut adapt = fixed(&["adapt", "mesh.meshb", "-o", "next.meshb", option, file]);
    if has_model {
        adapt.push("--cad=model.step".into());
    }
    adapt.extend(config.adapt_words(config.schedule.complexity, has_model));
    if config.threads.is_some() || config.adapt.threads.is_some() || config.adapt.processes() > 1 {
        adapt.push("--threads=1".into());
    }
    let mut all = vec![("[metric] and [adapt] options", adapt)];
    if mesh.bootstrap.is_some() {
        let bootstrap = fixed(&["bootstrap", "model.step", "-o", "mesh.meshb"]);
        all.push(("[mesh] options", bootstrap.into_iter().chain(config.bootstrap_words()).collect()));
    }
    for (place, words) in all {
        let command = words[0].clone();
        let path = loaded.path.display();
        let parsed = crate::cli::Arguments::try_parse_from(std::iter::once("geo-adapt".to_owned()).chain(words));
        let parsed = parsed.map_err(|said| {
            let said = said.to_string();
            let why = said.lines().next().unwrap_or_default().trim_start_matches("error: ").to_owned();
            format!("{path}: {place}: {why}; `geo-adapt {command} --help` lists what can be there")
        })?;
        if let Command::Adapt(adapt) = parsed.command {
            let remedy = "leave it out of the options, or give neither processes nor memory";
            let fits = adapt.fits_processes(config.adapt.processes());
            fits.map_err(|error| format!("{path}: [adapt]: {error}; {remedy}"))?;
        }
    }
    Ok(())
}
