//! The command line of refine: `ref adapt a.meshb -g model.egads -m m.solb -x b.meshb`.
use super::mmg::gradation;
use super::{Translated, Words};
use std::ffi::{OsStr, OsString};
use std::path::Path;

/// Our command.
///
/// # Errors
/// When it asks for what has no counterpart: what to type instead.
pub fn translated(words: &[OsString]) -> Result<Translated, String> {
    let (command, rest) = words
        .split_first()
        .ok_or("ref wants a command: adapt, bootstrap, multiscale, translate, interpolate, examine")?;
    let mut words = Words::new(rest);
    match command.to_string_lossy().as_ref() {
        "adapt" => adapt(&mut words),
        "bootstrap" => bootstrap(&mut words),
        "multiscale" => multiscale(&mut words),
        "translate" => plain(&["convert"], ["MESH", "OUT"], &mut words),
        "examine" => plain(&["inspect"], ["MESH"], &mut words),
        "interpolate" => interpolate(&mut words),
        "loop" => Err("ref loop: `geo-adapt cycle` runs solver, metric and adaptation in turn; type `geo-adapt cycle --example command`".into()),
        "visualize" => Err("ref visualize: type `geo-adapt convert MESH OUT.vtu --fields FIELD.solb`, or `geo-adapt view MESH -o OUT.html`".into()),
        "distance" => Err("ref distance has no counterpart here".into()),
        other => Err(format!("ref {other} is not known here; type `geo-adapt --help`")),
    }
}

/// The words that a command must have, in their order; the options in between are handed to `option`.
fn taken<'a, const N: usize>(
    names: [&str; N],
    words: &mut Words<'a>,
    mut option: impl FnMut(&str, &mut Words<'a>) -> Result<(), String>,
) -> Result<[&'a OsStr; N], String> {
    let mut found: Vec<&OsStr> = Vec::with_capacity(N);
    while let Some(word) = words.next() {
        match word.to_str().filter(|text| text.starts_with('-') && text.len() > 1) {
            Some(text) => option(text, words)?,
            None => found.push(word),
        }
    }
    let count = found.len();
    found.try_into().map_err(|_| format!("it takes {}, and there are {count} words", names.join(" ")))
}

/// A command whose words stay as they are, without options.
fn plain<const N: usize>(command: &[&str], names: [&str; N], words: &mut Words) -> Result<Translated, String> {
    let found = taken(names, words, |option, _| Err(unknown(option)))?;
    let mut command = Translated::of(command);
    command.words.extend(found.map(OsString::from));
    Ok(command)
}

fn unknown(option: &str) -> String {
    format!("{option} has no counterpart here; leave it out")
}

fn adapt(words: &mut Words) -> Result<Translated, String> {
    let (mut command, mut has_metric, mut output) = (Translated::of(&["adapt"]), false, None);
    let mut options = Translated::default();
    let [mesh] = taken(["MESH"], words, |option, words| {
        match option {
            "-g" | "--egads" => options.add("--cad", words.value(option)?),
            "-m" | "--metric" => {
                options.add("--metric", words.value(option)?);
                has_metric = true;
            }
            "-x" | "-o" => output = Some(words.value(option)?),
            "-s" => {
                words.number(option)?;
                options.notices.push("-s: sweeps end by themselves here; it was left out".into());
            }
            "-t" | "-q" => options.notices.push(format!("{option} was left out")),
            "--spalding" | "--implied-complexity" | "--facelift" => return Err(unknown(option)),
            _ => return Err(unknown(option)),
        }
        Ok(())
    })?;
    let output = output.ok_or("ref adapt: no output; give -x OUT.meshb")?;
    if !has_metric {
        let (mesh, own) = (Path::new(mesh).display(), Path::new(mesh).with_extension("own.solb"));
        let own = own.display();
        return Err(format!(
            "ref adapt without -m adapts to the metric of the mesh itself: type `geo-adapt metric implied {mesh} -o {own}`, then give -m {own}"
        ));
    }
    command.words.push(mesh.into());
    command.words.append(&mut options.words);
    command.notices = options.notices;
    command.add("-o", output);
    Ok(command)
}

fn bootstrap(words: &mut Words) -> Result<Translated, String> {
    let mut output = None;
    let mut notices = Vec::new();
    let [model] = taken(["MODEL"], words, |option, words| {
        match option {
            "-x" | "-o" => output = Some(OsString::from(words.value(option)?)),
            // Which mesher: ours needs none.
            "--mesher" | "--fill" => {
                let mesher = words.value(option)?.to_string_lossy();
                notices.push(format!("{option} {mesher} was left out: the first mesh is our own"));
            }
            "-t" | "-q" => {}
            _ => return Err(unknown(option)),
        }
        Ok(())
    })?;
    let mut command = Translated { notices, ..Translated::of(&["bootstrap"]) };
    command.words.push(model.into());
    let project = Path::new(model).file_stem().unwrap_or(model).to_string_lossy();
    command.add("-o", output.unwrap_or_else(|| format!("{project}-vol.meshb").into()));
    Ok(command)
}

fn multiscale(words: &mut Words) -> Result<Translated, String> {
    let mut options = Translated::default();
    let [mesh, field, complexity, metric] =
        taken(["MESH", "FIELD", "COMPLEXITY", "METRIC"], words, |option, words| {
            match option {
                "--norm-power" => options.add("--norm", words.value(option)?),
                "--gradation" => {
                    let (text, ratio) = words.number(option)?;
                    options.add("--gradation", gradation(text, ratio));
                }
                "--aspect-ratio" => options.add("--aspect-ratio", words.number(option)?.0),
                "--hessian" => {
                    return Err("--hessian: the file is to hold the field itself here, not its Hessian".into());
                }
                _ => return Err(unknown(option)),
            }
            Ok(())
        })?;
    let mut command = Translated::of(&["metric", "multiscale"]);
    command.words.extend([mesh, field].map(OsString::from));
    command.add("--complexity", complexity);
    command.add("-o", metric);
    command.words.append(&mut options.words);
    Ok(command)
}

fn interpolate(words: &mut Words) -> Result<Translated, String> {
    let [from, field, to, output] =
        taken(["OLD_MESH", "OLD_FIELD", "NEW_MESH", "NEW_FIELD"], words, |option, _| Err(unknown(option)))?;
    let mut command = Translated::of(&["transfer"]);
    command.words.extend([from, field, to].map(OsString::from));
    command.add("-o", output);
    Ok(command)
}
