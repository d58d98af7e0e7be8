//! What a client may ask the program to do. The words of a request are read by the program's own command line; no word of it leads out of the
//! folder of its job.
use super::catalogue::Kind;
use super::ids::{is_digest, is_file_name};
use super::work::protocol::SOLVERS;
use crate::remote::words::{DECIDED, WRITTEN};
use clap::{Arg, ArgAction, ArgMatches, Command};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};
use std::any::TypeId;
use std::collections::BTreeMap;
use std::path::PathBuf;
use utoipa::ToSchema;

/// What may be asked for.
const SERVED: [&str; 12] = [
    "adapt",
    "bootstrap",
    "classify",
    "convert",
    "cycle",
    "field",
    "image-mesh",
    "inspect",
    "metric",
    "model",
    "transfer",
    "view",
];

/// Options that mean a terminal, or another service.
const OF_A_CLIENT: [&str; 2] = ["server", "verbose"];

/// Most words of a request.
const MOST_WORDS: usize = 400;

/// A job as a client asks for it.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Request {
    /// The command: `adapt`, `metric multiscale`, …
    #[schema(example = "adapt")]
    pub command: String,
    /// Its arguments: as words (`["in.meshb", "-o", "out.meshb", "--size", "0.1"]`), or by their names (`{"mesh": "in.meshb", "output": "out.meshb",
    /// "size": 0.1}`). Files are called by the names that `files` gives them, or that the outputs shall have.
    #[schema(value_type = Object)]
    pub arguments: Value,
    /// The files that it reads: what each is called, and the id of its contents (an upload, or a result).
    #[serde(default)]
    pub files: BTreeMap<String, String>,
    /// What the client calls it.
    #[serde(default)]
    pub label: String,
}

/// A request that may be run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Checked {
    /// The words behind the name of the program.
    pub words: Vec<String>,
    /// How many of them name the command.
    pub command_words: usize,
    /// The CAD model that it reads, if it does.
    pub model: Option<String>,
    /// Whether `--threads` is an option of it.
    pub has_threads: bool,
    /// Whether `--max-vertices` is one, and not given.
    pub has_max_vertices: bool,
    /// Whether `--deterministic` is one, and no scheduler is given: a job has the same result on any number of threads.
    pub has_scheduler: bool,
    /// Whether it is a loop, which may use what the operator has set up.
    pub is_loop: bool,
}

impl Checked {
    /// The words, with what the service decides.
    pub fn words_with(&self, threads: usize, most_vertices: u64) -> Vec<String> {
        let mut words = self.words.clone();
        let at = self.command_words;
        if self.has_threads {
            words.insert(at, format!("--threads={threads}"));
        }
        if self.has_max_vertices {
            words.insert(at, format!("--max-vertices={most_vertices}"));
        }
        if self.has_scheduler {
            words.insert(at, "--deterministic".into());
        }
        if self.is_loop {
            words.insert(at, format!("--confined=../{SOLVERS}"));
        }
        words
    }
}

/// All commands of the program.
pub struct Commands {
    root: Command,
}

/// Why a request is refused.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct Refused(String);

fn refused<T>(text: impl Into<String>) -> Result<T, Refused> {
    Err(Refused(text.into()))
}

impl Commands {
    /// Of the program.
    pub fn new(mut root: Command) -> Self {
        root.build();
        Self { root }
    }

    /// The command of such a name.
    fn find(&self, name: &str) -> Option<&Command> {
        let mut words = name.split(' ');
        words.clone().next().filter(|first| SERVED.contains(first))?;
        let found = words.try_fold(&self.root, |command, word| command.find_subcommand(word))?;
        // `metric help scale` is for a terminal.
        let is_help = name.split(' ').any(|word| word == "help");
        (!found.is_hide_set() && !found.has_subcommands() && !is_help).then_some(found)
    }

    /// Checks a request: the words that may be run.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn check(&self, request: &Request) -> Result<Checked, Refused> {
        let Request { command: name, arguments, files, label } = request;
        if label.len() > 200 {
            return refused("label: 200 bytes at most");
        }
        let Some(command) = self.find(name) else {
            return refused(format!("{name:?}: there is no such command here; GET /v1/commands lists them"));
        };
        for (file, id) in files {
            if !is_file_name(file) {
                return refused(format!("files: {file:?}: give a plain name, of letters, digits and . _ - + ( ) = ,"));
            }
            if !is_digest(id) {
                return refused(format!("files: {file}: {id:?} is no id, which has 64 hexadecimal digits"));
            }
        }
        let words = words_of(command, arguments)?;
        if words.len() > MOST_WORDS {
            return refused(format!("{} words: {MOST_WORDS} at most", words.len()));
        }
        let all = ["geo-adapt"].into_iter().chain(name.split(' ')).chain(words.iter().map(String::as_str));
        let matches = self.root.clone().try_get_matches_from(all).map_err(|error| Refused(plain(&error)))?;
        let mut leaf = &matches;
        while let Some((_, below)) = leaf.subcommand() {
            leaf = below;
        }
        let mut model = None;
        for argument in command.get_arguments() {
            check_argument(argument, leaf, files, &mut model)?;
        }
        let has = |name: &str| command.get_arguments().any(|argument| argument.get_long() == Some(name));
        let is_given = |name: &str| words.iter().any(|word| word == name || word.starts_with(&format!("{name}=")));
        let command_words = name.split(' ').count();
        let has_max_vertices = has("max-vertices") && !is_given("--max-vertices") && !is_given("--memory");
        let has_scheduler = has("deterministic") && !is_given("--scheduler") && !is_given("--deterministic");
        let words = name.split(' ').map(str::to_owned).chain(words).collect();
        let (has_threads, is_loop) = (has("threads"), has("confined"));
        Ok(Checked { words, command_words, model, has_threads, has_max_vertices, has_scheduler, is_loop })
    }

    /// All that may be asked for, with the arguments of each: for those who make requests.
    pub fn described(&self) -> Value {
        let mut leaves = Vec::new();
        collect(&self.root, "", &mut leaves);
        let served = leaves.into_iter().filter(|(name, _)| self.find(name).is_some());
        served.map(|(name, command)| described(&name, command)).collect()
    }
}

/// The commands that do something, by their names.
fn collect<'a>(command: &'a Command, before: &str, leaves: &mut Vec<(String, &'a Command)>) {
    for below in command.get_subcommands() {
        let name = format!("{before}{}", below.get_name());
        if below.has_subcommands() {
            collect(below, &format!("{name} "), leaves);
        } else {
            leaves.push((name, below));
        }
    }
}

fn is_ours(name: &str) -> bool {
    OF_A_CLIENT.contains(&name) || DECIDED.contains(&name)
}

fn is_served(argument: &Arg) -> bool {
    let name = argument.get_id().as_str();
    !argument.is_hide_set() && !is_ours(name) && !["help", "version"].contains(&name)
}

fn is_path(argument: &Arg) -> bool {
    argument.get_value_parser().type_id() == TypeId::of::<PathBuf>()
}

fn described(name: &str, command: &Command) -> Value {
    let about = |text: Option<&clap::builder::StyledStr>| text.map(ToString::to_string).unwrap_or_default();
    let argument = |argument: &Arg| {
        let is_flag = !argument.get_action().takes_values();
        let values = argument.get_value_parser().possible_values();
        let values: Option<Vec<String>> = values.map(|all| all.map(|value| value.get_name().to_owned()).collect());
        let word = argument.get_value_names().and_then(|names| names.first()).map(ToString::to_string);
        json!({
            "name": argument.get_long().unwrap_or(argument.get_id().as_str()),
            "positional": argument.is_positional(),
            "required": argument.is_required_set(),
            "flag": is_flag,
            "several": matches!(argument.get_action(), ArgAction::Append),
            "file": is_path(argument),
            "values": values.filter(|_| !is_flag),
            "value": word.filter(|_| !is_flag),
            "about": about(argument.get_help()),
        })
    };
    let arguments: Vec<Value> = command.get_arguments().filter(|argument| is_served(argument)).map(argument).collect();
    json!({ "command": name, "about": about(command.get_about()), "arguments": arguments })
}

/// What is wrong with the words, without what is for a terminal.
fn plain(error: &clap::Error) -> String {
    let text = error.render().to_string();
    let text = text.strip_prefix("error: ").unwrap_or(&text);
    text.split("\n\nUsage:")
        .next()
        .unwrap_or_default()
        .split("\n\nFor more information")
        .next()
        .unwrap_or_default()
        .trim()
        .to_owned()
}

/// Arguments by their names, or as words, as words.
fn words_of(command: &Command, arguments: &Value) -> Result<Vec<String>, Refused> {
    match arguments {
        Value::Array(words) => {
            let word = |word: &Value| match word {
                Value::String(text) => Ok(text.clone()),
                Value::Number(number) => Ok(number.to_string()),
                other => refused(format!("arguments: {other} is no word")),
            };
            words.iter().map(word).collect()
        }
        Value::Object(named) => words_of_named(command, named),
        Value::Null => Ok(Vec::new()),
        _ => refused("arguments: a list of words is wanted, or an object with the arguments by their names"),
    }
}

fn words_of_named(command: &Command, named: &Map<String, Value>) -> Result<Vec<String>, Refused> {
    let (mut options, mut positional) = (Vec::new(), Vec::new());
    for (name, value) in named {
        let is_it = |argument: &&Arg| {
            argument.get_long() == Some(name)
                || argument.get_id().as_str() == name.replace('-', "_")
                || argument.get_id().as_str() == name
        };
        let Some(argument) = command.get_arguments().find(is_it) else {
            return refused(format!("arguments: {name:?}: `{}` has no such argument", command.get_name()));
        };
        let single = std::slice::from_ref(value);
        for value in value.as_array().map_or(single, Vec::as_slice) {
            let text = match value {
                Value::Null | Value::Bool(false) => continue,
                Value::Bool(true) => None,
                Value::String(text) => Some(text.clone()),
                Value::Number(number) => Some(number.to_string()),
                other => return refused(format!("arguments: {name}: {other} is neither text nor number")),
            };
            match (argument.get_long(), text) {
                (Some(long), None) => options.push(format!("--{long}")),
                (Some(long), Some(text)) => options.push(format!("--{long}={text}")),
                (None, Some(text)) => positional.push((argument.get_index().unwrap_or(usize::MAX), text)),
                (None, None) => return refused(format!("arguments: {name}: a value is wanted")),
            }
        }
    }
    positional.sort_by_key(|(at, _)| *at);
    let behind = positional.into_iter().map(|(_, text)| text);
    Ok(options.into_iter().chain(["--".to_owned()]).chain(behind).collect())
}

/// Refuses a value that could lead out of the folder of the job.
fn check_argument(
    argument: &Arg,
    matches: &ArgMatches,
    files: &BTreeMap<String, String>,
    model: &mut Option<String>,
) -> Result<(), Refused> {
    let id = argument.get_id().as_str();
    let is_given = matches.value_source(id) == Some(clap::parser::ValueSource::CommandLine);
    if !is_given {
        return Ok(());
    }
    if is_ours(id) {
        return refused(format!("--{}: this is the service's to decide", argument.get_long().unwrap_or(id)));
    }
    for value in matches.get_raw(id).into_iter().flatten() {
        let Some(value) = value.to_str() else { return refused(format!("{id}: this is no text")) };
        if is_path(argument) {
            if !is_file_name(value) {
                return refused(format!("{value:?}: give the plain name of a file, with no folder"));
            }
            if WRITTEN.contains(&id) && files.contains_key(value) {
                return refused(format!("{value:?}: is an input and would be overwritten; give another output"));
            }
            let is_model = Kind::of_file(value) == Kind::Model;
            if is_model && files.contains_key(value) && model.is_none() {
                *model = Some(value.to_owned());
            }
        } else if value.contains(['/', '\\', '\0']) || value.contains("..") {
            return refused(format!("{value:?}: no folders here"));
        }
    }
    Ok(())
}
