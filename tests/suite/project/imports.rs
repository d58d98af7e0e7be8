//! Which file of the source names which, and the circles in that.
use std::collections::{BTreeMap, BTreeSet, VecDeque};

/// The path of a module: src/a/b.rs is [a, b], src/a/mod.rs is [a].
pub type Module = Vec<String>;

/// Files by their modules, and what each has.
pub struct Graph {
    files: BTreeMap<Module, File>,
}

struct File {
    /// Paths that it names, absolute.
    named: Vec<Module>,
    /// What it hands on under a name of its own: `pub use a::{b as c}` is c → a::b.
    handed_on: BTreeMap<String, Module>,
    /// Modules that it hands on with all that is in them.
    handed_on_whole: Vec<Module>,
}

#[derive(Clone, Debug, PartialEq)]
enum Token {
    Word(String),
    /// `::`
    Path,
    Sign(char),
}

/// Words and signs, without comments, strings and white space.
fn tokens(source: &str) -> Vec<Token> {
    let mut found = Vec::new();
    let mut rest = source;
    let after =
        |rest: &'_ str, end: &str, from: usize| rest[from..].find(end).map_or(rest.len(), |at| from + at + end.len());
    while let Some(c) = rest.chars().next() {
        let length = if rest.starts_with("//") {
            after(rest, "\n", 0)
        } else if rest.starts_with("/*") {
            after(rest, "*/", 2)
        } else if c == '"' {
            string(rest)
        } else if let Some(hashes) = raw_string(rest) {
            after(rest, &format!("\"{}", "#".repeat(hashes)), hashes + 2)
        } else if c == '\'' {
            // A character, or a lifetime.
            let is_escaped = rest[1..].starts_with('\\');
            let closed = rest[1..].char_indices().nth(1).filter(|(_, c)| *c == '\'').map(|(at, _)| at + 2);
            if is_escaped { after(rest, "'", 3) } else { closed.unwrap_or(1) }
        } else if c.is_alphanumeric() || c == '_' {
            let length = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
            found.push(Token::Word(rest[..length].into()));
            length
        } else if rest.starts_with("::") {
            found.push(Token::Path);
            2
        } else {
            if !c.is_whitespace() {
                found.push(Token::Sign(c));
            }
            c.len_utf8()
        };
        rest = &rest[length..];
    }
    found
}

/// The length of a string with its quotes.
fn string(text: &str) -> usize {
    let mut escaped = false;
    for (at, c) in text.char_indices().skip(1) {
        match c {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            '"' => return at + 1,
            _ => {}
        }
    }
    text.len()
}

/// How many # a raw string has, if one begins here.
fn raw_string(text: &str) -> Option<usize> {
    let inside = text.strip_prefix('r')?;
    let hashes = inside.find(|c| c != '#')?;
    inside[hashes..].starts_with('"').then_some(hashes)
}

/// Whether an attribute begins here that is for tests: `#[cfg(test)]`, `#[cfg(all(test, unix))]`.
fn is_for_tests(at: &[Token]) -> bool {
    let end = at.iter().position(|token| *token == Token::Sign(']')).unwrap_or(0);
    let word = |word: &str| at[..end].contains(&Token::Word(word.into()));
    at.starts_with(&[Token::Sign('#'), Token::Sign('['), Token::Word("cfg".into())]) && word("test") && !word("not")
}

/// Without what is for tests alone: each item behind such an attribute.
fn without_tests(all: &[Token]) -> Vec<Token> {
    let (mut kept, mut at) = (Vec::new(), 0);
    while at < all.len() {
        if !is_for_tests(&all[at..]) {
            kept.push(all[at].clone());
            at += 1;
            continue;
        }
        // To the end of its block, or the semicolon before one.
        let mut depth = 0;
        while at < all.len() {
            match &all[at] {
                Token::Sign('{') => depth += 1,
                Token::Sign('}') => depth -= 1,
                _ => {}
            }
            let is_end = depth == 0 && matches!(&all[at], Token::Sign('}' | ';'));
            at += 1;
            if is_end {
                break;
            }
        }
    }
    kept
}

/// A path of a use tree, with the name that it gets.
struct Named {
    path: Vec<String>,
    name: String,
}

/// The paths of what begins at a word, groups taken apart; and where that ends.
fn paths(tokens: &[Token], mut at: usize, before: &[String], found: &mut Vec<Named>) -> usize {
    let mut path = before.to_vec();
    loop {
        match tokens.get(at) {
            Some(Token::Word(word)) => {
                path.push(word.clone());
                at += 1;
            }
            Some(Token::Sign('{')) => {
                at += 1;
                while at < tokens.len() && tokens[at] != Token::Sign('}') {
                    let next = paths(tokens, at, &path, found);
                    at = next.max(at + 1);
                    if tokens.get(at) == Some(&Token::Sign(',')) {
                        at += 1;
                    }
                }
                return at + 1;
            }
            Some(Token::Sign('*')) => {
                found.push(Named { path, name: "*".into() });
                return at + 1;
            }
            _ => return at,
        }
        if tokens.get(at) == Some(&Token::Path) {
            at += 1;
            continue;
        }
        let mut name = path.last().cloned().unwrap_or_default();
        if tokens.get(at) == Some(&Token::Word("as".into()))
            && let Some(Token::Word(other)) = tokens.get(at + 1)
        {
            name.clone_from(other);
            at += 2;
        }
        if name == "self" {
            path.pop();
            name = path.last().cloned().unwrap_or_default();
        }
        found.push(Named { path, name });
        return at;
    }
}

impl Graph {
    /// Of the files of a crate: their modules and sources.
    pub fn new(sources: &BTreeMap<Module, String>) -> Self {
        let modules: BTreeSet<&Module> = sources.keys().collect();
        let files = sources.iter().map(|(module, source)| (module.clone(), File::new(module, source, &modules)));
        Self { files: files.collect() }
    }

    /// The file that a path leads to, behind all that hand it on.
    fn resolve(&self, path: &[String], depth: usize) -> Option<&Module> {
        let length = (1..=path.len()).rev().find(|&length| self.files.contains_key(&path[..length]))?;
        let (module, file) = self.files.get_key_value(&path[..length])?;
        let Some(item) = path.get(length).filter(|_| depth < 8) else { return Some(module) };
        if let Some(target) = file.handed_on.get(item).filter(|target| target.as_slice() != path) {
            let whole: Vec<String> = target.iter().chain(&path[length + 1..]).cloned().collect();
            return self.resolve(&whole, depth + 1).or(Some(module));
        }
        Some(module)
    }

    /// The files that a file names.
    fn imports<'a>(&'a self, module: &'a Module) -> BTreeSet<&'a Module> {
        let file = &self.files[module];
        let whole = file.handed_on_whole.iter();
        let all = file.named.iter().chain(whole).filter_map(|path| self.resolve(path, 0));
        all.filter(|&target| target != module).collect()
    }

    /// How many imports there are within a room.
    pub fn count_within(&self, room: &[&str]) -> usize {
        let within = |module: &&Module| is_within(module, room);
        self.files.keys().filter(within).map(|module| self.imports(module).into_iter().filter(within).count()).sum()
    }

    /// The shortest circle of files of a room that is not within one of its parts; a part is a module of the room with all that is in it.
    pub fn circle(&self, room: &[&str]) -> Option<Vec<String>> {
        let within = |module: &&Module| is_within(module, room);
        let part = |module: &Module| module.get(room.len()).cloned();
        let edges: BTreeMap<&Module, BTreeSet<&Module>> = self
            .files
            .keys()
            .filter(within)
            .map(|module| (module, self.imports(module).into_iter().filter(within).collect()))
            .collect();
        let mut shortest: Option<Vec<&Module>> = None;
        for (&from, targets) in &edges {
            for &to in targets.iter().filter(|to| part(to) != part(from)) {
                let back = way(&edges, to, from);
                if let Some(back) = back.filter(|back| shortest.as_ref().is_none_or(|least| back.len() < least.len())) {
                    shortest = Some(back);
                }
            }
        }
        Some(shortest?.iter().map(|module| module.join("/")).collect())
    }
}

/// The shortest way from a file to another, both included.
fn way<'a>(
    edges: &BTreeMap<&'a Module, BTreeSet<&'a Module>>,
    from: &'a Module,
    to: &'a Module,
) -> Option<Vec<&'a Module>> {
    let (mut before, mut queue) = (BTreeMap::from([(from, from)]), VecDeque::from([from]));
    while let Some(at) = queue.pop_front() {
        if at == to {
            let mut back = vec![to];
            while let Some(&last) = back.last().filter(|last| **last != from) {
                back.push(before[last]);
            }
            back.reverse();
            return Some(back);
        }
        for &next in edges.get(at).into_iter().flatten() {
            if !before.contains_key(next) {
                before.insert(next, at);
                queue.push_back(next);
            }
        }
    }
    None
}

fn is_within(module: &Module, room: &[&str]) -> bool {
    module.len() >= room.len() && module.iter().zip(room).all(|(a, b)| a == b)
}

impl File {
    fn new(module: &Module, source: &str, modules: &BTreeSet<&Module>) -> Self {
        let all = without_tests(&tokens(source));
        let (mut named, mut handed_on, mut handed_on_whole) = (Vec::new(), BTreeMap::new(), Vec::new());
        let mut at = 0;
        while at < all.len() {
            let Token::Word(word) = &all[at] else {
                at += 1;
                continue;
            };
            let is_start = at == 0 || all[at - 1] != Token::Path;
            if word == "use" || !is_start || all.get(at + 1) != Some(&Token::Path) {
                at += 1;
                continue;
            }
            let mut found = Vec::new();
            let is_use = at > 0 && all[at - 1] == Token::Word("use".into());
            let end = paths(&all, at, &[], &mut found);
            let is_public = is_use && is_public(&all[..at - 1]);
            for Named { path, name } in found {
                let Some(path) = absolute(module, &path, modules) else { continue };
                match name.as_str() {
                    "*" if is_public => handed_on_whole.push(path),
                    // What is handed on is no import of this file, but of who asks for it here.
                    _ if is_public => drop(handed_on.insert(name, path)),
                    _ => named.push(path),
                }
            }
            at = end.max(at + 1);
        }
        Self { named, handed_on, handed_on_whole }
    }
}

/// Whether what is before a `use` says `pub`.
fn is_public(before: &[Token]) -> bool {
    match before.last() {
        Some(Token::Word(word)) => word == "pub",
        Some(Token::Sign(')')) => {
            let open = before.iter().rposition(|token| *token == Token::Sign('('));
            open.and_then(|open| before.get(open.checked_sub(1)?)) == Some(&Token::Word("pub".into()))
        }
        _ => false,
    }
}

/// A path from the root of the crate; none where it begins with something that is no module.
fn absolute(module: &Module, path: &[String], modules: &BTreeSet<&Module>) -> Option<Module> {
    let first = path.first()?.as_str();
    let join = |base: &[String], rest: &[String]| -> Module { base.iter().chain(rest).cloned().collect() };
    match first {
        "crate" | "geo_adapt" => Some(path[1..].to_vec()),
        "self" => Some(join(module, &path[1..])),
        "super" => {
            let up = path.iter().take_while(|name| *name == "super").count();
            Some(join(&module[..module.len().checked_sub(up)?], &path[up..]))
        }
        _ => {
            let child = join(module, &path[..1]);
            modules.contains(&child).then(|| join(module, path))
        }
    }
}

/// A crate of so many files.
fn graph(files: &[(&str, &str)]) -> Graph {
    let split = |path: &str| path.split('/').map(str::to_owned).collect::<Module>();
    Graph::new(&files.iter().map(|(path, source)| (split(path), (*source).to_owned())).collect())
}

#[test]
fn a_circle_of_two_files_is_found_and_named() {
    let of = |b: &str| {
        graph(&[("room", "mod a; mod b;"), ("room/a", "use super::b::B;\npub struct A;"), ("room/b", b)])
            .circle(&["room"])
    };
    assert_eq!(of("pub struct B;"), None);
    let circle = Some(vec!["room/a".to_owned(), "room/b".to_owned()]);
    let mut found = of("fn f(_: crate::room::a::A) {}");
    found.as_mut().unwrap().sort();
    assert_eq!(found, circle);
    for harmless in [
        "// use super::a::A;",
        "const B: &str = \"use super::a::A;\"; const C: &str = r#\"super::a::A\"#; const D: char = '\"';",
        "#[cfg(test)]\nmod tests { use super::super::a::A; }",
        "#[cfg(all(test, unix))]\nmod tests { fn f() {} use super::super::a::A; }",
        "use crate::other::a::A;",
    ] {
        assert_eq!(of(harmless), None, "{harmless}");
    }
    for way in [
        "use super::{a::{A}, c};",
        "use crate::{room::a, c};",
        "fn f() { super::a::g(); }",
        "use super::a::{self as x};",
    ] {
        assert!(of(way).is_some(), "{way}");
    }
}

#[test]
fn what_is_handed_on_is_an_import_of_the_file_behind() {
    // By way of the room's own file, which hands on from both.
    let files = [("room", "mod a; mod b;\npub use a::A;\npub(crate) use b::{B as C};"), ("room/a", "use super::C;")];
    let of = |b| graph(&[files[0], files[1], ("room/b", b)]).circle(&["room"]);
    assert_eq!(of("pub struct B;"), None);
    assert!(of("use super::A;").is_some());
}

#[test]
fn what_the_rooms_own_file_defines_is_a_circle_with_what_it_uses() {
    let of = |a| graph(&[("room", "mod a;\npub struct R;\nfn f() { a::g() }"), ("room/a", a)]).circle(&["room"]);
    assert_eq!(of("pub fn g() {}"), None);
    assert_eq!(of("use super::R;\npub fn g() {}").unwrap().len(), 2);
}

#[test]
fn circles_within_a_part_are_its_own() {
    let files = [
        ("room", "mod a; mod b;"),
        ("room/a", "mod x; mod y;\npub struct A;\nuse x::X;"),
        ("room/a/x", "use super::A; use super::y::Y;"),
        ("room/a/y", "use super::x::X;"),
    ];
    let of = |b| graph(&[files[0], files[1], files[2], files[3], ("room/b", b)]).circle(&["room"]);
    assert_eq!(of("use super::a::A;"), None);
    let part = graph(&[
        files[0],
        files[1],
        ("room/a/x", "use crate::room::b::B; use super::A;"),
        ("room/b", "use super::a::A;"),
    ]);
    // a names x, which names b, which names a.
    assert_eq!(part.circle(&["room"]).unwrap().len(), 3);
    assert_eq!(graph(&files).count_within(&["room"]), 4);
}
