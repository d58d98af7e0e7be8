//! Examples in the help of each command. A test holds that each is understood.
use clap::Command;

/// Commands, by the words that are typed for them, each with its examples.
const EXAMPLES: [(&str, &[&str]); 39] = [
    (
        "",
        &[
            "geo-adapt bootstrap part.step -o part.meshb",
            "geo-adapt view part.meshb -o part.html",
            "geo-adapt adapt part.meshb --cad part.step --field u.solb --complexity 50000 -o part-2.meshb",
            "geo-adapt mmg3d -in a.mesh -sol m.sol -out b.mesh",
            "geo-adapt ref adapt a.meshb -g part.step -m m.solb -x b.meshb",
        ],
    ),
    (
        "adapt",
        &[
            "geo-adapt adapt a.meshb --cad wing.step --field mach.solb --complexity 50000 -o b.meshb",
            "geo-adapt adapt a.meshb --cad wing.step --metric sizes.solb -o b.meshb --report b.json",
            "geo-adapt adapt flow.vtu --field Mach --vertices 100000 -o b.vtu",
            "geo-adapt adapt a.meshb --metric sizes.solb --freeze inlet,region:2 -o b.meshb",
            "geo-adapt adapt a.meshb --cad wing.step --goal terms.toml --complexity 50000 -o b.meshb",
        ],
    ),
    (
        "bootstrap",
        &[
            "geo-adapt bootstrap wing.step -o wing.meshb",
            "geo-adapt bootstrap wing.step -o flow.meshb --far-field box:10 --symmetry y",
            "geo-adapt bootstrap scan.stl -o scan.meshb",
        ],
    ),
    ("classify", &["geo-adapt classify a.meshb --cad wing.step -o b.meshb"]),
    (
        "completions",
        &[
            "geo-adapt completions bash > ~/.local/share/bash-completion/completions/geo-adapt",
            "geo-adapt completions zsh > ~/.zfunc/_geo-adapt",
            "geo-adapt completions fish > ~/.config/fish/completions/geo-adapt.fish",
        ],
    ),
    (
        "convert",
        &["geo-adapt convert flow.vtu flow.meshb", "geo-adapt convert wing.su2 wing.vtu --fields restart_flow.dat"],
    ),
    (
        "cycle",
        &[
            "geo-adapt cycle --example command > loop.toml",
            "geo-adapt cycle loop.toml --dry-run",
            "geo-adapt cycle loop.toml",
        ],
    ),
    ("field", &["geo-adapt field evaluate a.meshb --function tanh3 -o u.solb"]),
    (
        "field distance",
        &[
            "geo-adapt field distance a.meshb --cad wing.step --faces wing -o d.solb",
            "geo-adapt field distance a.meshb --cad wing.step --faces wing --spalding --re 6e6 -o uplus.solb",
        ],
    ),
    ("field error", &["geo-adapt field error coarse.meshb coarse.solb --truth fine.meshb fine.solb"]),
    ("field evaluate", &["geo-adapt field evaluate a.meshb --function tanh3 -o u.solb"]),
    ("field pick", &["geo-adapt field pick flow.solb --take 5,norm:2-4 -o u.solb"]),
    (
        "image-mesh",
        &[
            "geo-adapt image-mesh scan.nrrd -o scan.meshb --size 1.5",
            "geo-adapt image-mesh grey.nrrd -o a.meshb --size 2 --isovalue 90",
        ],
    ),
    (
        "inspect",
        &[
            "geo-adapt inspect a.meshb",
            "geo-adapt inspect a.meshb --metric a.solb --cad wing.step",
            "geo-adapt inspect a.meshb --cad wing.step --wall wing:h=1e-5,growth=1.2",
            "geo-adapt inspect large.meshb --metric large.solb --memory 2GiB",
        ],
    ),
    ("man", &["geo-adapt man ~/.local/share/man/man1"]),
    ("metric", &["geo-adapt metric multiscale a.meshb mach.solb --complexity 50000 -o m.solb"]),
    ("metric from-image", &["geo-adapt metric from-image scan.nrrd --mesh a.meshb --complexity 20000 -o m.solb"]),
    ("metric from-points", &["geo-adapt metric from-points a.meshb cloud.csv --neighbours 12 -o m.solb"]),
    ("metric geometry", &["geo-adapt metric geometry a.meshb --cad wing.step -o m.solb"]),
    (
        "metric goal",
        &[
            "geo-adapt metric goal a.meshb --terms terms.toml --complexity 50000 -o m.solb",
            "geo-adapt metric goal a.meshb --euler flow.solb --adjoint adjoint.solb --complexity 50000 -o m.solb",
            "geo-adapt metric goal a.meshb --navier-stokes flow.solb --adjoint adjoint.solb --reynolds 4000 --complexity 50000 -o m.solb",
            "geo-adapt metric goal a.meshb --incompressible flow.solb --adjoint adjoint.solb --reynolds 4000 --complexity 50000 -o m.solb",
        ],
    ),
    ("metric grade", &["geo-adapt metric grade a.meshb m.solb --ratio 1.5 -o graded.solb"]),
    ("metric implied", &["geo-adapt metric implied a.meshb -o own.solb"]),
    ("metric interpolate", &["geo-adapt metric interpolate old.meshb old.solb new.meshb -o new.solb"]),
    ("metric intersect", &["geo-adapt metric intersect m.solb g.solb -o both.solb"]),
    ("metric isotropic", &["geo-adapt metric isotropic a.meshb sizes.sol -o m.solb"]),
    ("metric limit", &["geo-adapt metric limit m.solb --hmin 1e-4 --hmax 1 -o limited.solb"]),
    ("metric multiscale", &["geo-adapt metric multiscale a.meshb mach.solb --complexity 50000 -o m.solb"]),
    ("metric scale", &["geo-adapt metric scale a.meshb m.solb --complexity 50000 -o scaled.solb"]),
    ("metric show", &["geo-adapt metric show a.meshb m.solb"]),
    (
        "metric wall",
        &[
            "geo-adapt metric wall a.meshb --cad wing.step --wall wing:h=1e-5,growth=1.2 -o m.solb",
            "geo-adapt metric wall a.meshb --cad wing.step --wall wing:yplus=1,re=6e6,length=1 -o m.solb",
            "geo-adapt metric wall a.meshb --cad wing.step --wall wing:re=6e6,law=spalding --complexity 20000 -o m.solb",
        ],
    ),
    (
        "model",
        &[
            "geo-adapt model wing.step",
            "geo-adapt model wing.step --name inlet=3,7 --name wall=near:0,0,1",
            "geo-adapt model part.step --scale 0.001 -o part-m.brep",
        ],
    ),
    (
        "serve",
        &[
            "geo-adapt serve",
            "geo-adapt serve --listen 0.0.0.0:7878 --tls-certificate chain.pem --tls-key key.pem --data /srv/geo-adapt",
        ],
    ),
    ("serve token", &["geo-adapt serve token add ann --label notebook"]),
    ("serve token add", &["geo-adapt serve token add ann --scopes read --days 30"]),
    ("serve token list", &["geo-adapt serve token list"]),
    ("serve token revoke", &["geo-adapt serve token revoke 01a21877eb959270"]),
    ("transfer", &["geo-adapt transfer old.meshb old.solb new.meshb -o new.solb --conservative"]),
    ("tune", &["geo-adapt tune a.meshb --cad wing.step --metric m.solb"]),
    (
        "view",
        &[
            "geo-adapt view a.meshb -o a.html",
            "geo-adapt view wing.step --png wing.png",
            "geo-adapt view a.meshb --cut x=0.5 --color quality --png a.png",
        ],
    ),
];

/// Adds the examples to the help of a command and of all below it.
pub fn add(command: Command) -> Command {
    added(command, "")
}

fn added(command: Command, words: &str) -> Command {
    let examples = EXAMPLES.iter().find(|(of, _)| *of == words).map_or(&[][..], |(_, examples)| examples);
    let command = if examples.is_empty() {
        command
    } else {
        let before = command.get_after_help().map_or_else(String::new, |text| format!("{text}\n\n"));
        command.after_help(format!("{before}Examples:\n  {}", examples.join("\n  ")))
    };
    let names: Vec<String> = command.get_subcommands().map(|below| below.get_name().to_owned()).collect();
    names.into_iter().fold(command, |command, name| {
        let words = if words.is_empty() { name.clone() } else { format!("{words} {name}") };
        command.mut_subcommand(name, |below| added(below, &words))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::{Arguments, habits};
    use clap::CommandFactory;
    use std::ffi::OsString;

    /// All commands that are shown, by the words that are typed.
    fn commands(command: &Command, words: &str, all: &mut Vec<String>) {
        all.push(words.to_owned());
        for below in command.get_subcommands().filter(|below| !below.is_hide_set()) {
            let words =
                if words.is_empty() { below.get_name().to_owned() } else { format!("{words} {}", below.get_name()) };
            commands(below, &words, all);
        }
    }

    #[test]
    fn each_command_has_an_example_that_is_understood() {
        let mut all = Vec::new();
        commands(&Arguments::command(), "", &mut all);
        for words in all {
            let found = EXAMPLES.iter().find(|(of, _)| *of == words);
            let (_, examples) = found.unwrap_or_else(|| panic!("`{words}` has no example"));
            assert!(!examples.is_empty(), "`{words}` has no example");
            for example in *examples {
                let mut typed: Vec<OsString> =
                    example.split_whitespace().take_while(|word| *word != ">").map(OsString::from).collect();
                assert!(example.starts_with(&format!("geo-adapt {words}")), "{example}");
                if let Some(translated) = habits::translated(&typed[1..]) {
                    typed.truncate(1);
                    typed.extend(translated.unwrap_or_else(|error| panic!("{example}: {error}")).words);
                }
                add(Arguments::command())
                    .try_get_matches_from(typed)
                    .unwrap_or_else(|error| panic!("{example}: {error}"));
            }
        }
    }
}
