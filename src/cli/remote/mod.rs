//! A command on a service instead of here (`--server`): its files go up, it runs there, and its results come down to where they would be.
mod cycle;

use super::files::{Files, Outputs, Target};
use super::metric::goal::Asked;
use super::waiting::Waiting;
use super::workplace::Workplace;
use super::{Outcome, interrupt, note, print, tell};
use crate::formats;
use crate::geometry::names;
use crate::remote::Server;
use crate::remote::words::{DECIDED, WRITTEN};
use clap::parser::ValueSource;
use clap::{Arg, ArgMatches, Command};
use serde_json::{Value, json};
use std::any::TypeId;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::Ordering::SeqCst;

/// Where commands run.
#[derive(clap::Args)]
pub struct Where {
    /// Run the command on a service (`geo-adapt serve`): its files are sent there, and its results come back. A token is taken from
    /// GEO_ADAPT_TOKEN
    #[arg(long, value_name = "URL", global = true, env = "GEO_ADAPT_SERVER")]
    pub server: Option<String>,
}

/// The environment variable with the token.
const TOKEN: &str = "GEO_ADAPT_TOKEN";

/// Arguments that are for the terminal here.
const OURS: [&str; 2] = ["server", "verbose"];

/// Arguments that name a file of the terms of a goal.
const TERMS: [&str; 2] = ["terms", "goal"];

/// What the service gives of its own.
const LOG: &str = "log.txt";
const PRINTED: &str = "printed.txt";

/// A command that is to run on a service.
struct Sent {
    words: Vec<String>,
    /// What is read, by the name that the service knows it by.
    read: BTreeMap<String, PathBuf>,
    /// What is written, by the same.
    written: BTreeMap<String, PathBuf>,
    /// Where all results of a loop go.
    folder: Option<PathBuf>,
}

/// Runs the command that was parsed on a service.
pub fn run(server: &str, all: &Command, matches: &ArgMatches) -> Outcome {
    let (mut command, mut leaf, mut name) = (all, matches, Vec::new());
    while let Some((word, below)) = leaf.subcommand() {
        name.push(word.to_owned());
        leaf = below;
        command = command.find_subcommand(word).ok_or("no such command")?;
    }
    let mut sent = Sent { words: Vec::new(), read: BTreeMap::new(), written: BTreeMap::new(), folder: None };
    let place = Workplace::new()?;
    let mut positional = Vec::new();
    for argument in command.get_arguments() {
        let id = argument.get_id().as_str();
        if leaf.value_source(id) != Some(ValueSource::CommandLine) || OURS.contains(&id) {
            continue;
        }
        if DECIDED.contains(&id) {
            note(format_args!("--{id}: the service decides it"));
            continue;
        }
        sent.add(argument, leaf, &mut positional)?;
    }
    positional.sort_by_key(|(at, _)| *at);
    sent.words.push("--".into());
    sent.words.extend(positional.into_iter().map(|(_, word)| word));
    if name == ["cycle"] {
        cycle::pack(&mut sent, &place)?;
    }
    let mut files = Files::new().reads(sent.read.values());
    let server = Server::new(server, std::env::var(TOKEN).ok().filter(|token| !token.is_empty()));
    let mut ids = BTreeMap::new();
    for (name, path) in &sent.read {
        let _line = Waiting::for_what(&format!("sending {}", path.display()));
        ids.insert(name, server.upload(path, name)?);
    }
    let request = json!({ "command": name.join(" "), "arguments": sent.words, "files": ids });
    let job = server.ask(&request)?;
    let ended = followed(&server, &job)?;
    let code = taken(&server, &job, &sent, &mut files)?;
    let exit = ended["exit_code"].as_i64().and_then(|code| u8::try_from(code).ok());
    match (ended["state"].as_str(), exit) {
        (Some("cancelled"), _) => Ok(interrupt::exit_code()),
        (_, Some(_)) if code => Ok(ExitCode::from(exit.unwrap_or_default())),
        _ => Err(ended["reason"].as_str().unwrap_or("the job did not end well").into()),
    }
}

impl Sent {
    fn add(&mut self, argument: &Arg, leaf: &ArgMatches, positional: &mut Vec<(usize, String)>) -> Result<(), String> {
        let id = argument.get_id().as_str();
        let is_path = argument.get_value_parser().type_id() == TypeId::of::<PathBuf>();
        let long = argument.get_long();
        if !argument.get_action().takes_values() {
            let times = if leaf.get_flag(id) { 1 } else { 0 };
            self.words.extend(long.into_iter().map(|long| format!("--{long}")).cycle().take(times));
            return Ok(());
        }
        let places = leaf.indices_of(id).into_iter().flatten();
        for (value, at) in leaf.get_raw(id).into_iter().flatten().zip(places) {
            if TERMS.contains(&id) {
                self.terms(Path::new(value))?;
            }
            let value = if is_path {
                self.name(Path::new(value), WRITTEN.contains(&id))?
            } else {
                value.to_str().ok_or_else(|| format!("{}: this is no text", value.display()))?.to_owned()
            };
            match long {
                Some(long) => self.words.push(format!("--{long}={value}")),
                None => positional.push((at, value)),
            }
        }
        Ok(())
    }

    /// What the service knows a file by.
    fn name(&mut self, path: &Path, is_written: bool) -> Result<String, String> {
        let known = if is_written { &self.written } else { &self.read };
        if let Some((name, _)) = known.iter().find(|(_, other)| *other == path) {
            return Ok(name.clone());
        }
        let Some(base) = path.file_name().and_then(|name| name.to_str()) else {
            return Err(format!("{}: this is no name of a file", path.display()));
        };
        if is_written {
            let name = self.free(base);
            self.written.insert(name.clone(), path.to_owned());
            return Ok(name);
        }
        if path.is_dir() {
            return Err(format!(
                "{}: a folder cannot be sent; make one file of it with `geo-adapt convert`",
                path.display()
            ));
        }
        if !path.exists() {
            // The name of a field, say. Else the service tells what is missing.
            return Ok(base.to_owned());
        }
        let name = self.free(base);
        self.read.insert(name.clone(), path.to_owned());
        let beside = [names::beside(path), names::beside_model(path)];
        for other in formats::read_files(path).into_iter().chain(beside) {
            let own = other.file_name().and_then(|name| name.to_str());
            let is_new = !self.read.values().any(|known| *known == other);
            if let Some(own) = own.filter(|_| is_new && other.is_file()) {
                // What lies beside a file is found by its name.
                self.read.insert(renamed(own, base, &name), other);
            }
        }
        Ok(name)
    }

    /// The files that a file of terms names. There they are called as it says.
    fn terms(&mut self, path: &Path) -> Result<(), String> {
        for name in Asked::read(path)?.names() {
            if name.components().count() != 1 {
                let (path, name) = (path.display(), name.display());
                return Err(format!("{path}: {name}: for a service the files of terms must lie beside it"));
            }
            let file = path.with_file_name(name);
            if file.is_file() {
                self.read.insert(name.to_string_lossy().into_owned(), file);
            }
        }
        Ok(())
    }

    /// A name that is not taken yet.
    fn free(&self, base: &str) -> String {
        let (stem, ending) =
            base.split_once('.').map_or((base, String::new()), |(stem, ending)| (stem, format!(".{ending}")));
        let names = std::iter::once(base.to_owned()).chain((2..).map(|i| format!("{stem}-{i}{ending}")));
        let is_free = |name: &String| !self.read.contains_key(name) && !self.written.contains_key(name);
        names.into_iter().find(is_free).unwrap_or_default()
    }

    /// Where a result goes: beside the output whose name it begins with.
    fn target(&self, result: &str) -> PathBuf {
        if let Some(folder) = &self.folder {
            return folder.join(result);
        }
        if let Some(path) = self.written.get(result) {
            return path.clone();
        }
        let of = self.written.iter().chain(&self.read).find(|(name, _)| stem(name) == stem(result));
        let Some((name, path)) = of.or_else(|| self.written.iter().next()) else { return result.into() };
        let own = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        path.with_file_name(renamed(result, name, own))
    }
}

/// What comes before the first dot of a name.
fn stem(name: &str) -> &str {
    name.split('.').next().unwrap_or_default()
}

/// The name of what lies beside a file, where that is called otherwise.
fn renamed(beside: &str, from: &str, to: &str) -> String {
    let rest = beside.strip_prefix(stem(from));
    rest.map_or_else(|| beside.to_owned(), |rest| format!("{}{rest}", stem(to)))
}

/// Follows a job to its end. An interrupt asks it to end with its last valid mesh.
fn followed(server: &Server, job: &str) -> Result<Value, Box<dyn std::error::Error>> {
    let stop = interrupt::finish_on(
        "the job ends as soon as it can, and its mesh is fetched (again: ends at once, and the job goes on)",
    );
    let line = Waiting::for_what("the job waits");
    let is_over = std::sync::atomic::AtomicBool::new(false);
    let ended = std::thread::scope(|scope| {
        scope.spawn(|| {
            while !is_over.load(SeqCst) {
                if stop.load(SeqCst) {
                    let _ = server.cancel(job);
                    return;
                }
                std::thread::sleep(std::time::Duration::from_millis(50));
            }
        });
        let mut last = None;
        let ended = server.follow(job, &mut |job| last = Some(Waiting::for_what(&progress(job))));
        drop(last);
        is_over.store(true, SeqCst);
        ended
    });
    drop(line);
    Ok(ended?)
}

/// What is shown of a job.
fn progress(job: &Value) -> String {
    let said = &job["progress"];
    let number = |name: &str| said[name].as_f64().unwrap_or(0.0);
    match said["kind"].as_str() {
        Some("pass") => {
            let (vertices, expected, left) = (number("vertices"), number("expected"), number("left"));
            format!("{vertices:.0} of ~{expected:.0} vertices, about {left:.0} s left")
        }
        Some("forecast") => format!("about {:.0} vertices, {:.0} s", number("vertices"), number("seconds")),
        Some("stage") => said["what"].as_str().unwrap_or_default().to_owned(),
        _ => job["state"].as_str().unwrap_or_default().to_owned(),
    }
}

/// Fetches what a job has made, and says what it has said. Whether there was anything of it.
fn taken(server: &Server, job: &str, sent: &Sent, files: &mut Files) -> Result<bool, Box<dyn std::error::Error>> {
    let results = server.results(job)?;
    let mut outputs = Outputs::new();
    let mut targets: Vec<(usize, Target)> = Vec::new();
    if let Some(folder) = sent.folder.as_ref().filter(|_| !results.is_empty()) {
        std::fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    }
    for (at, result) in results.iter().enumerate() {
        let mut text = Vec::new();
        match result.name.as_str() {
            LOG => {
                server.download(job, result, &mut text)?;
                String::from_utf8_lossy(&text).lines().for_each(tell);
            }
            PRINTED => {
                server.download(job, result, &mut text)?;
                print(&String::from_utf8_lossy(&text))?;
            }
            name => targets.push((at, files.writes(&sent.target(name), name, &[])?)),
        }
    }
    for (at, target) in &targets {
        let result = &results[*at];
        let _line = Waiting::for_what(&format!("fetching {}", result.name));
        outputs.fetched(target, |file| server.download(job, result, file).map_err(std::io::Error::other))?;
    }
    outputs.commit()?;
    Ok(!results.is_empty())
}
