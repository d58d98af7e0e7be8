//! The command of an adaptation.
use super::config::{Config, FIRST, Loaded, option};
use super::data::{Begun, Call, text};
use super::error::Error;
use super::launch;
use super::layout::Layout;
use std::path::Path;

/// What boundaries lie on: a model, which `bootstrap` may make beside the first mesh, or a surface.
pub fn begun(loaded: &Loaded, first: &Path) -> Begun {
    let mesh = &loaded.config.mesh;
    let at = |path: &Path| if path == Path::new(FIRST) { first.to_owned() } else { loaded.at(path) };
    let domain = first.with_extension("brep");
    let bootstrapped =
        mesh.bootstrap.as_deref().map(|model| if mesh.far_field.is_some() { domain } else { loaded.at(model) });
    let cad = bootstrapped.or_else(|| mesh.cad.as_deref().map(|cad| loaded.at(cad)));
    Begun { cad, surface: mesh.surface.as_deref().map(at) }
}

/// The file of the terms of a goal, in the folder of the metric.
pub const TERMS: &str = "terms.toml";

/// The option of `adapt` that says what the metric is made of, and its file in the folder of the metric.
pub fn made_of(config: &Config) -> (&'static str, &'static str) {
    if config.goal.is_some() { ("--goal", TERMS) } else { ("--field", "sensors.solb") }
}

/// The command that makes the next mesh after a cycle; `threads` there are for it.
///
/// # Errors
/// When this program does not know its own file.
pub fn call(loaded: &Loaded, layout: &Layout, threads: usize, cycle: u32, begun: &Begun) -> Result<Call, Error> {
    let (config, folder) = (&loaded.config, layout.step(cycle, "adapt"));
    let processes = config.adapt.processes();
    let mut words = launch::words(processes);
    words.extend([launch::own()?, "adapt".into(), text(&layout.mesh(cycle))]);
    words.extend(["-o".into(), text(&folder.join("mesh.meshb"))]);
    let (option_of, file) = made_of(config);
    words.extend([option_of.into(), text(&layout.step(cycle, "metric").join(file))]);
    words.extend(["--report".into(), text(&folder.join("report.json"))]);
    option(&mut words, "--cad", begun.cad.as_deref().map(text).as_ref());
    option(&mut words, "--surface", begun.surface.as_deref().map(text).as_ref());
    option(&mut words, "--scratch", config.adapt.scratch.as_deref().map(|scratch| text(&loaded.at(scratch))).as_ref());
    let has_model = begun.cad.is_some() || begun.surface.is_some();
    words.extend(config.adapt_words(config.schedule.of_cycle(cycle), has_model));
    let shared = (processes > 1).then(|| (threads / processes as usize).max(1));
    let own = config.adapt.threads.or(config.threads.filter(|_| processes == 1)).map(usize::from);
    if let Some(threads) = own.or(shared) {
        words.extend(["--threads".into(), threads.to_string()]);
    }
    let mut env = launch::environment(processes);
    if processes > 1 {
        // OpenMPI gives two processes a core each, with all their threads.
        env.push(("OMPI_MCA_hwloc_base_binding_policy".into(), "none".into()));
    }
    Ok(Call { words, env, folder })
}
