//! The command line of mmg3d 5 (and of what has taken over its spellings): `-in a.mesh -sol m.sol -out b.mesh -hmin 0.01`.
use super::{Translated, Words};
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};

/// Options that a command line may begin with, to be known as one of mmg3d.
const KNOWN: [&str; 20] = [
    "-in",
    "-out",
    "-sol",
    "-met",
    "-hmin",
    "-hmax",
    "-hsiz",
    "-hgrad",
    "-hgradreq",
    "-hausd",
    "-ar",
    "-nr",
    "-nosurf",
    "-optim",
    "-ls",
    "-lag",
    "-noinsert",
    "-noswap",
    "-nomove",
    "-nreg",
];

/// Endings of the files with sizes.
const SIZES: [&str; 2] = ["sol", "solb"];

/// Whether a word is an option of mmg3d.
pub fn is_option(word: &str) -> bool {
    KNOWN.contains(&word)
}

/// Whether the words are a line for mmg3d: one of them is its option, and none begins with two dashes, as ours do.
pub fn is_line(words: &[OsString]) -> bool {
    let mut words = words.iter().map(|word| word.to_str().unwrap_or_default());
    words.clone().any(|word| word.len() > 2 && is_option(word)) && !words.any(|word| word.starts_with("--"))
}

/// What was asked of mmg3d.
#[derive(Default)]
struct Asked<'a> {
    mesh: Option<&'a OsStr>,
    output: Option<&'a OsStr>,
    metric: Option<&'a OsStr>,
    size: Option<&'a OsStr>,
    /// Options of ours with their values.
    options: Vec<(&'static str, OsString)>,
    is_quiet: bool,
    is_optimised: bool,
    notices: Vec<String>,
}

/// Our command.
///
/// # Errors
/// When it asks for what has no counterpart: what to type instead.
pub fn translated(words: &[OsString]) -> Result<Translated, String> {
    let mut asked = Asked::default();
    let mut words = Words::new(words);
    while let Some(word) = words.next() {
        asked.take(word, &mut words)?;
    }
    asked.command()
}

impl<'a> Asked<'a> {
    fn take(&mut self, word: &'a OsStr, words: &mut Words<'a>) -> Result<(), String> {
        let option = word.to_str().unwrap_or_default();
        match option {
            "-in" => self.mesh = Some(words.value(option)?),
            "-out" => self.output = Some(words.value(option)?),
            "-sol" | "-met" => self.metric = Some(words.value(option)?),
            "-hsiz" => self.size = Some(words.number(option)?.0),
            "-hmin" => self.add("--hmin", words.number(option)?.0),
            "-hmax" => self.add("--hmax", words.number(option)?.0),
            "-hausd" => self.add("--hausdorff", words.number(option)?.0),
            "-ar" => self.add("--ridge-angle", words.number(option)?.0),
            "-nr" => self.add("--ridge-angle", "none"),
            "-hgrad" => {
                let (text, ratio) = words.number(option)?;
                self.add("--gradation", gradation(text, ratio));
            }
            "-v" => self.is_quiet = words.number(option)?.1 <= 0.0,
            "-optim" => self.is_optimised = true,
            "-m" | "-rn" | "-hgradreq" => drop(words.number(option)?),
            "-A" | "-d" | "-nofem" | "-nreg" | "-opnbdy" | "-default" | "-val" => {
                self.notices.push(format!("{option} has no counterpart here and was left out"));
            }
            _ if option.starts_with('-') && option.len() > 1 => return Err(refusal(option)),
            _ if self.mesh.is_none() => self.mesh = Some(word),
            _ if self.output.is_none() => self.output = Some(word),
            _ => return Err(format!("{}: a third file; geo-adapt mmg3d takes IN and OUT", word.to_string_lossy())),
        }
        Ok(())
    }

    fn add(&mut self, option: &'static str, value: impl Into<OsString>) {
        self.options.push((option, value.into()));
    }

    fn command(self) -> Result<Translated, String> {
        let mesh = self.mesh.ok_or("no mesh: give -in MESH")?;
        let mut command = Translated { notices: self.notices, ..Translated::of(&["adapt"]) };
        command.words.push(mesh.into());
        let beside = SIZES.map(|ending| Path::new(mesh).with_extension(ending)).into_iter().find(|file| file.is_file());
        match (self.metric, self.size) {
            (Some(metric), _) => command.add("--metric", metric),
            (None, Some(size)) => command.add("--size", size),
            (None, None) if self.is_optimised => return Err(implied(Path::new(mesh))),
            (None, None) => match beside {
                Some(file) => command.add("--metric", file),
                None => {
                    return Err(format!(
                        "no sizes: give -sol FILE, or -hsiz H for edges of one length; there is no {} either",
                        Path::new(mesh).with_extension("sol").display()
                    ));
                }
            },
        }
        for (option, value) in &self.options {
            command.add(option, value);
        }
        command.add("-o", self.output.map_or_else(|| default_output(Path::new(mesh)), PathBuf::from));
        if self.is_quiet {
            command.words.push("--quiet".into());
        }
        Ok(command)
    }
}

/// A negative ratio switches gradation off.
pub fn gradation(text: &OsStr, ratio: f64) -> &OsStr {
    if ratio > 0.0 { text } else { "off".as_ref() }
}

/// Where mmg3d writes without -out: a.mesh becomes a.o.mesh.
fn default_output(mesh: &Path) -> PathBuf {
    let ending = mesh.extension().unwrap_or("meshb".as_ref()).to_string_lossy().into_owned();
    mesh.with_extension(format!("o.{ending}"))
}

/// What to type for -optim.
fn implied(mesh: &Path) -> String {
    let (mesh, sizes) = (mesh.display(), mesh.with_extension("own.solb"));
    let sizes = sizes.display();
    format!(
        "-optim: type `geo-adapt metric implied {mesh} -o {sizes}` for the sizes that the mesh has, then adapt to these: `geo-adapt adapt {mesh} \
         --metric {sizes} -o OUT`"
    )
}

/// What to do in the place of an option without counterpart.
fn refusal(option: &str) -> String {
    let remedy = match option {
        "-nosurf" => {
            "`geo-adapt adapt` holds surfaces with --freeze 1,2,…: their references, which `geo-adapt inspect` lists"
        }
        "-noinsert" | "-noswap" | "-nomove" => "all operations are used here",
        "-ls" => "a level set is not meshed here; `geo-adapt image-mesh --isovalue V` meshes one on a 3D image",
        "-lag" => "a mesh is not moved here",
        "-h" => "type `geo-adapt adapt --help`",
        _ => "it is no option of mmg3d that is known here; type `geo-adapt adapt --help`",
    };
    format!("{option}: {remedy}")
}
