//! The file of --terms, and the fields that it names.
use crate::cli::files::reading::{self, Carrier, Fields};
use crate::cli::metric::common::Failure;
use crate::cli::transfer::rows;
use crate::mesh::io::Solution;
use crate::mesh::split_nonmanifold::copy_values;
use crate::metric::goal::terms::{Flow, Medium, Terms, Values};
use crate::metric::goal::{Boundary, Goal, Weight};
use crate::tasks::Team;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Terms, and where their relative paths begin.
pub struct Asked {
    /// What errors name.
    pub path: PathBuf,
    base: PathBuf,
    terms: Terms,
}

impl Asked {
    /// Of a file.
    ///
    /// # Errors
    /// When it cannot be read, or says what cannot be: file, line and remedy.
    pub fn read(path: &Path) -> Result<Self, String> {
        let named = |error: String| format!("{}: {error}", path.display());
        let text = std::fs::read_to_string(path).map_err(|error| named(error.to_string()))?;
        let terms: Terms = toml::from_str(&text).map_err(|error| {
            let before = error.span().map_or(text.as_str(), |span| &text[..span.start.min(text.len())]);
            let line = before.matches('\n').count() + 1;
            named(format!("line {line}: {}; `geo-adapt metric goal --help` shows a file", error.message().trim()))
        })?;
        if terms.terms.is_empty() && terms.flow.is_none() {
            return Err(named("no terms: give a [[terms]] with a field and its weight, or a [flow]".into()));
        }
        let base = path.parent().map_or_else(PathBuf::new, Path::to_path_buf);
        Ok(Self { path: path.to_owned(), base, terms })
    }

    /// Of a flow that the command line names.
    pub fn flow(flow: Flow) -> Self {
        let path = flow.primal.clone();
        Self { path, base: PathBuf::new(), terms: Terms { flow: Some(flow), ..Terms::default() } }
    }

    /// What vertices on the boundary get, where the file says.
    pub fn boundary(&self) -> Option<Boundary> {
        self.terms.boundary
    }

    /// The files that it names, where they are there; else they are names of fields.
    pub fn files(&self) -> Vec<PathBuf> {
        self.terms.files().map(|file| self.at(file)).collect()
    }

    /// The paths as they are written.
    #[cfg(feature = "serve")]
    pub fn names(&self) -> impl Iterator<Item = &Path> {
        self.terms.files()
    }

    /// A path of the file; as it is where nothing is there, since it may be the name of a field.
    fn at(&self, file: &Path) -> PathBuf {
        let joined = self.base.join(file);
        if joined.exists() { joined } else { file.to_owned() }
    }

    /// Adds all terms to a goal. The last vertices of its mesh are `copies`, on which the files have nothing.
    ///
    /// # Errors
    /// What is wrong with a file or its values.
    pub fn add_to(
        &self,
        goal: &mut Goal<'_>,
        (team, of, copies): (Team<'_>, Carrier<'_>, &[u32]),
        notices: &mut Vec<String>,
    ) -> Result<(), Failure> {
        let named = |number: usize, error: String| format!("{}: term {}: {error}", self.path.display(), number + 1);
        let mut reader = Reader { asked: self, team, of, copies, read: BTreeMap::new(), notices };
        for (number, term) in self.terms.terms.iter().enumerate() {
            let coefficients = term.coefficients().map_err(|error| named(number, error))?;
            let field = reader.values(&term.field)?;
            let (from, weights) = match (&term.weight, &term.adjoint) {
                (Some(from), _) | (None, Some(from)) => (from, reader.values(from)?),
                (None, None) => return Err(named(number, "no weight".into()).into()),
            };
            let weight =
                if term.weight.is_some() { Weight::Given(&weights) } else { Weight::Adjoint(&weights, &coefficients) };
            let at = from.file().display();
            goal.add(weight, &field).map_err(|error| named(number, format!("{at}: {error}")))?;
        }
        if let Some(flow) = &self.terms.flow {
            let named = |error: String| format!("{}: {error}", flow.primal.display());
            let medium = flow.medium().map_err(|error| format!("{}: {error}", self.path.display()))?;
            let added = match medium {
                Medium::Gas(gas) => {
                    let what = "a gas has five equations: give density, three of momentum or velocity, and energy or pressure, or their adjoints";
                    let [primal, adjoint] = reader.both(flow, what)?;
                    goal.add_flow(&gas, flow.variables, &primal, &adjoint)
                }
                Medium::Fluid(fluid) => {
                    let what =
                        "an incompressible flow has four: give three of velocity, and pressure, or their adjoints";
                    let [primal, adjoint] = reader.both(flow, what)?;
                    goal.add_incompressible(fluid, &primal, &adjoint)
                }
            };
            added.map_err(|error| named(error.to_string()))?;
        }
        Ok(())
    }
}

/// Reads each file once.
struct Reader<'a> {
    asked: &'a Asked,
    team: Team<'a>,
    of: Carrier<'a>,
    copies: &'a [u32],
    read: BTreeMap<PathBuf, Solution>,
    notices: &'a mut Vec<String>,
}

impl Reader<'_> {
    /// The fields of a file, one of the mesh's vertices, all finite.
    fn solution(&mut self, file: &Path) -> Result<&Solution, Failure> {
        let path = self.asked.at(file);
        if !self.read.contains_key(&path) {
            let read = reading::fields(self.team, &path, self.of)?;
            self.notices.extend(read.notices);
            let Fields { solution, .. } = read.content;
            let (name, vertices, found) = (path.display(), self.of.vertices.len(), solution.vertices);
            if found != vertices {
                let mesh = self.of.path.display();
                return Err(format!(
                    "{name}: values at {found} vertices, but {mesh} has {vertices}: give fields of this mesh"
                )
                .into());
            }
            for field in &solution.fields {
                if let Some(at) = field.values.iter().position(|value| !value.is_finite()) {
                    let (vertex, value) = (at / field.kind.values() + 1, field.values[at]);
                    return Err(
                        format!("{name}: the value of vertex {vertex} is {value}: did the solver diverge?").into()
                    );
                }
            }
            self.read.insert(path.clone(), solution);
        }
        Ok(&self.read[&path])
    }

    /// One value a vertex, shape (n,).
    fn values(&mut self, values: &Values) -> Result<Vec<f64>, Failure> {
        let (copies, name) = (self.copies, values.file().display());
        let solution = self.solution(values.file())?;
        let count: usize = solution.fields.iter().map(|field| field.kind.values()).sum();
        let index = match values.component() {
            None if count == 1 => 0,
            Some(component) if (1..=count).contains(&component) => component - 1,
            _ => {
                return Err(format!(
                    "{name}: {count} values a vertex; give the one that is meant, {{ file = \"{name}\", component = 1 }} to {count}"
                )
                .into());
            }
        };
        let mut found = solution.component(index).unwrap_or_default();
        copy_values(&mut found, copies);
        Ok(found)
    }

    /// State and adjoint of a flow, a row a vertex; an error says `what` it has.
    fn both<const N: usize>(&mut self, flow: &Flow, what: &str) -> Result<[Vec<[f64; N]>; 2], Failure> {
        Ok([self.states(&flow.primal, what)?, self.states(&flow.adjoint, what)?])
    }

    /// The values of a file, so many a vertex.
    fn states<const N: usize>(&mut self, file: &Path, what: &str) -> Result<Vec<[f64; N]>, Failure> {
        let (copies, team) = (self.copies, self.team);
        let solution = self.solution(file)?;
        let count: usize = solution.fields.iter().map(|field| field.kind.values()).sum();
        if count != N {
            let name = file.display();
            return Err(format!(
                "{name}: {count} values a vertex, but {what}; `geo-adapt field pick` takes them out of others"
            )
            .into());
        }
        let mut found = rows(team, solution, count).as_chunks::<N>().0.to_vec();
        copy_values(&mut found, copies);
        Ok(found)
    }
}
