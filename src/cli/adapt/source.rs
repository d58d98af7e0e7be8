//! The metric of a run, on the mesh as it was put on its model: bounded, graded, and of its complexity.
use super::chords::told;
use super::drafts::Draft;
use super::input::{Error, InputArguments};
use super::local;
use crate::adapt;
use crate::adapt::beside::Beside;
use crate::adapt::forecast::GREATEST_COMPLEXITY;
use crate::cli::files::reading::Carrier;
use crate::cli::metric::fields::Made;
use crate::cli::metric::goal;
use crate::cli::walls::Places;
use crate::formats::NamedField;
use crate::geometry::classify::Classification;
use crate::geometry::{Model, Names};
use crate::mesh::TetMesh;
use crate::mesh::adjacency::MatchedFaces;
use crate::metric::frozen::Fitted;
use crate::metric::goal::NORM;
use crate::metric::held::GREATEST_RATIO;
use crate::metric::multiscale::{Bounds, Cut, Measure, Options, SizeBound, bounded, diameter};
use crate::metric::{self, Limits, Source, Sym3, field, grade};
use crate::sizing;
use crate::sizing::chords::{self, Limited};
use crate::tasks::{Team, stage};
use std::sync::Arc;

/// The sizes of the geometry take at most this share of the complexity, so that some is left for the field.
const GEOMETRY_SHARE: f64 = 0.5;

/// What the metric is made of, besides the files of --field.
#[derive(Clone, Default)]
pub struct Raw {
    /// ln M at the vertices, of the file of --metric.
    pub logs: Option<Vec<Sym3>>,
    /// The origins of the last vertices, where the mesh was taken apart.
    pub copies: Vec<u32>,
    /// The fields of the mesh's file.
    pub fields: Vec<NamedField>,
}

/// How a metric was made.
#[derive(Clone, Default)]
pub struct How {
    /// From a field,
    pub made: Option<Made>,
    /// or from the terms of a goal.
    pub goal: Option<goal::Made>,
    /// What was cut along curved walls.
    pub chords: Option<Limited>,
    /// How it was fitted to a stack.
    pub fitted: Option<Fitted>,
    /// The drafts that were made before.
    pub drafts: Vec<Draft>,
}

/// Where the mesh lies.
#[derive(Clone, Copy)]
pub(super) struct On<'a> {
    pub place: &'a Classification,
    pub model: &'a Model,
    pub names: &'a Names,
    /// The stack that the mesh lies beside.
    pub beside: Option<&'a Beside>,
}

impl On<'_> {
    /// The places of --local and --wall on a mesh.
    pub(super) fn places<'a>(&'a self, mesh: &'a TetMesh) -> Places<'a> {
        Places { mesh, place: self.place, model: self.model, names: self.names }
    }
}

/// What a metric is made of, and for what.
#[derive(Clone, Copy)]
pub(super) struct Making<'a> {
    pub mesh: &'a Arc<TetMesh>,
    pub raw: &'a Raw,
    pub on: On<'a>,
    /// The share of √(8 h R) that sizes along curved walls are cut to; none where they are left.
    pub share: Option<f64>,
    /// The complexity that is wanted.
    pub complexity: Option<f64>,
}

impl InputArguments {
    /// The metric of the complexity that is wanted, and how it was made, with sizes along walls that edges can have. Notices are added.
    pub(super) fn source(
        &self,
        team: Team<'_>,
        (mesh, faces): (&Arc<TetMesh>, MatchedFaces),
        raw: &Raw,
        on: On<'_>,
        (complexity, notices): (Option<f64>, &mut Vec<String>),
    ) -> Result<(Source, How), Error> {
        let making = Making { mesh, raw, on, share: self.chord_limit().share(), complexity };
        let mut made = self.scaled(team, making, faces, notices)?;
        if let Source::Background(background) = &made.0
            && let Some(dive) = self.dive(team, on.place, on.model, background.logs())
        {
            let cut = dive.is_deep().then(|| {
                let faces = MatchedFaces::of(team, &mesh.tets.nodes);
                let making = Making { share: Some(chords::SHARE), ..making };
                self.scaled(team, making, faces, &mut Vec::new())
            });
            // Other bounds may leave no such metric.
            let cut = cut.and_then(Result::ok);
            notices.push(told(&dive, cut.is_some()));
            made = cut.unwrap_or(made);
        }
        Ok(self.beside_stack(team, mesh, on, made))
    }

    /// The metric, of its complexity, and how it was made.
    pub(super) fn scaled(
        &self,
        team: Team<'_>,
        making: Making<'_>,
        faces: MatchedFaces,
        notices: &mut Vec<String>,
    ) -> Result<(Source, How), Error> {
        let (mut source, how) = self.unscaled(team, making, faces, notices)?;
        stage("metric ready");
        if source.cut() > 0 {
            notices.push(format!(
                "sizes of more than {GREATEST_RATIO:.0e} times the least at the same vertex were cut to that at {} vertices: a tensor of \
                 doubles does not hold them",
                source.cut()
            ));
        }
        let is_scaled = self.is_bounded() || making.share.is_some() || how.made.is_some() || how.goal.is_some();
        self.scale(team, making.mesh, &mut source, making.complexity, is_scaled)?;
        stage("complexity");
        Ok((source, how))
    }

    /// The metric, fitted to the stack that the mesh lies beside.
    pub(super) fn beside_stack(
        &self,
        team: Team<'_>,
        mesh: &Arc<TetMesh>,
        on: On<'_>,
        (source, mut how): (Source, How),
    ) -> (Source, How) {
        let Some(beside) = on.beside else { return (source, how) };
        let (source, fitted) = self.fitted(team, (mesh, on), beside, &source);
        how.fitted = Some(fitted);
        (source, how)
    }

    /// The analytic field, or the mesh as background with sizes that are given, or with the metric made from a field; and how it was made. Of its
    /// complexity already, where it is bounded or made.
    pub(super) fn unscaled(
        &self,
        team: Team<'_>,
        making: Making<'_>,
        faces: MatchedFaces,
        notices: &mut Vec<String>,
    ) -> Result<(Source, How), Error> {
        let Making { mesh, raw, on, share, complexity } = making;
        if let Some(field) = self.field.analytic {
            return Ok((Source::Analytic { field, log_scale: 0.0 }, How::default()));
        }
        let named = |error: String| format!("{}: {error}", self.mesh.display());
        if mesh.tets.is_empty() {
            return Err(named(adapt::Error::Empty.to_string()).into());
        }
        let uniform = self.field.size.map(|h| vec![of_size(h); mesh.vertices.len()]);
        let by_others = share.map(|share| chords::Chords::new(on.place, on.model, share));
        let by_others = by_others.as_ref().map(|chords| chords as &dyn SizeBound);
        let mut how = How::default();
        let (logs, cut) = match raw.logs.clone().or(uniform) {
            Some(logs) if !self.is_bounded() && share.is_none() => (logs, None),
            Some(logs) => self.bounded(team, mesh, on, (logs, by_others), (complexity, notices)).map_err(named)?,
            None => {
                let complexity = complexity.ok_or("--field and --goal need a --complexity or --vertices")?;
                let fixed = self.fixed(team, mesh, on, complexity, notices).map_err(named)?;
                let wanted = (complexity, Measure::Between);
                let vertices = &mesh.vertices[..mesh.vertices.len() - raw.copies.len()];
                let carrier = Carrier { path: &self.mesh, vertices, fields: &raw.fields };
                let (mesh, fixed) = ((&**mesh, &raw.copies[..]), (fixed.as_deref(), by_others));
                if let Some(terms) = self.field.terms()? {
                    let (logs, made) = self.of_goal(team, mesh, (&terms, carrier), wanted, fixed, notices)?;
                    let cut = made.cut();
                    how.goal = Some(made);
                    (logs, cut)
                } else {
                    let asked = (&self.field.field[..], carrier);
                    let (logs, made) = self.multiscale.make(team, mesh, asked, wanted, fixed, notices)?;
                    let cut = made.cut();
                    how.made = Some(made);
                    (logs, cut)
                }
            }
        };
        how.chords = share.zip(cut).map(|(share, cut)| Limited { share, cut });
        let background = sizing::background(team, (mesh, faces), (on.place, on.model), logs);
        Ok((Source::Background(background), how))
    }

    /// ln M of a goal, as [`goal::make`] has it; the rest as [`fields::MultiscaleArguments::make`].
    ///
    /// [`fields::MultiscaleArguments::make`]: crate::cli::metric::fields::MultiscaleArguments::make
    fn of_goal(
        &self,
        team: Team<'_>,
        mesh: (&TetMesh, &[u32]),
        asked: (&goal::Asked, Carrier<'_>),
        (complexity, measure): (f64, Measure),
        (fixed, by_others): (Option<&[Sym3]>, Option<&dyn SizeBound>),
        notices: &mut Vec<String>,
    ) -> Result<(Vec<Sym3>, goal::Made), Error> {
        let ((norm, recovery), gradation) = (self.multiscale.how(), self.multiscale.growth());
        let bounds = Bounds { complexity, measure, gradation, limits: self.multiscale.limits()?, fixed, by_others };
        let options = Options { recovery, norm: norm.unwrap_or(NORM), bounds };
        goal::make(team, mesh, asked, (&options, None), notices)
    }

    /// Whether sizes that are given are to be changed by more than a scale.
    pub(super) fn is_bounded(&self) -> bool {
        self.is_graded() || self.chord_limit().share().is_some() || !self.walls.is_empty()
    }

    /// Whether sizes that are given are to be graded.
    fn is_graded(&self) -> bool {
        !self.local.is_empty() || self.multiscale.bounds_are_given()
    }

    /// ln of the metric that is given within the bounds that are given, graded, and of the complexity that is asked for; and what the bound of
    /// sizes by each other has cut.
    fn bounded(
        &self,
        team: Team<'_>,
        mesh: &TetMesh,
        on: On<'_>,
        (mut logs, by_others): (Vec<Sym3>, Option<&dyn SizeBound>),
        (wanted, notices): (Option<f64>, &mut Vec<String>),
    ) -> Result<(Vec<Sym3>, Option<Cut>), String> {
        // The metric of a field is graded and has the sizes of the geometry in it on a draft, too.
        let is_made = self.field.is_of_fields();
        let growth = self.multiscale.growth().filter(|_| is_made || self.is_graded());
        let (limits, gradation) = (self.multiscale.limits()?, growth);
        let fixed = match wanted {
            Some(complexity) if is_made => self.fixed(team, mesh, on, complexity, notices)?,
            _ => {
                let others = self.local_sizes(team, mesh, on)?;
                self.with_walls(team, mesh, on, others, (wanted, gradation), notices)?
            }
        };
        let measure = Measure::Between;
        let complexity = wanted.unwrap_or(1.0);
        let bounds = Bounds { complexity, measure, gradation, limits, fixed: fixed.as_deref(), by_others };
        if wanted.is_some() {
            let found = bounded(team, mesh, &logs, &bounds).map_err(|error| error.to_string())?;
            return Ok((found.0, found.1.cut));
        }
        let (_, cut) = bounds.apply(team, &mut logs);
        if let Some(ratio) = gradation {
            grade(team, mesh, &mut logs, ratio);
            by_others.map(|bound| bound.apply(team, &mut logs));
        }
        Ok((logs, cut))
    }

    /// ln of the metric that the local sizes ask for, with very large sizes elsewhere; none without local sizes.
    fn local_sizes(&self, team: Team<'_>, mesh: &TetMesh, on: On<'_>) -> Result<Option<Vec<Sym3>>, String> {
        if self.local.is_empty() {
            return Ok(None);
        }
        let mut logs = vec![of_size(diameter(team, mesh)); mesh.vertices.len()];
        local::apply(team, &self.local, &on.places(mesh), &mut logs)?;
        Ok(Some(logs))
    }

    /// ln of the metric that holds whatever the field says: that of the geometry, on a CAD model, of the local sizes and of walls.
    fn fixed(
        &self,
        team: Team<'_>,
        mesh: &TetMesh,
        on: On<'_>,
        complexity: f64,
        notices: &mut Vec<String>,
    ) -> Result<Option<Vec<Sym3>>, String> {
        let others = self.geometry_and_local(team, mesh, on, complexity, notices)?;
        self.with_walls(team, mesh, on, others, (Some(complexity), self.multiscale.growth()), notices)
    }

    /// That of the geometry and of the local sizes.
    fn geometry_and_local(
        &self,
        team: Team<'_>,
        mesh: &TetMesh,
        on: On<'_>,
        complexity: f64,
        notices: &mut Vec<String>,
    ) -> Result<Option<Vec<Sym3>>, String> {
        if !self.has_geometry() {
            return self.local_sizes(team, mesh, on);
        }
        let gradation = self.multiscale.growth();
        let options = self.geometry.options(on.model, self.multiscale.limits()?, None);
        let (raw, _) = sizing::geometry_metric(team, mesh, on.place, on.model, &options);
        let mut logs = raw.clone();
        if let Some(ratio) = gradation {
            grade(team, mesh, &mut logs, ratio);
        }
        let own = field::complexity_between(team, mesh, &logs);
        let most = GEOMETRY_SHARE * complexity;
        if own > most {
            let (limits, measure) = (Limits::default(), Measure::Between);
            let bounds = Bounds { complexity: most, measure, gradation, limits, fixed: None, by_others: None };
            logs = bounded(team, mesh, &raw, &bounds).map_err(|error| format!("the geometry's metric: {error}"))?.0;
            let asked = self.amount.name();
            notices.push(format!(
                "the geometry alone asks for a complexity of {own:.0}: its sizes are enlarged, to leave half of {complexity} to \
                 the field (a greater {asked} keeps them, --no-geometry leaves them out)"
            ));
        }
        local::apply(team, &self.local, &on.places(mesh), &mut logs)?;
        stage("geometry");
        Ok(Some(logs))
    }

    /// Scales the source to the complexity asked for, unless it has that already. Refuses a complexity that no mesh can have.
    fn scale(
        &self,
        team: Team<'_>,
        mesh: &TetMesh,
        source: &mut Source,
        wanted: Option<f64>,
        is_scaled: bool,
    ) -> Result<(), String> {
        let named = |error: metric::Error| format!("{}: {error}", self.mesh.display());
        source.check(team, mesh).map_err(named)?;
        if wanted.is_none() && source.complexity_bound(team, mesh) <= GREATEST_COMPLEXITY {
            return Ok(());
        }
        let own = source.complexity(team, mesh);
        let complexity = self.checked_complexity(own, wanted)?;
        if wanted.is_some() && !is_scaled {
            source.scale(team, field::complexity_factor(own, complexity).ln());
        }
        Ok(())
    }

    /// The complexity that is wanted, or else the metric's own. Refuses what no mesh can have.
    pub(super) fn checked_complexity(&self, own: f64, wanted: Option<f64>) -> Result<f64, String> {
        if !(own > 0.0 && own.is_finite()) {
            return Err(format!(
                "{}: the metric's complexity on this mesh is {own}; are mesh and metric in the same units?",
                self.mesh.display()
            ));
        }
        let complexity = wanted.unwrap_or(own);
        if complexity <= GREATEST_COMPLEXITY {
            return Ok(complexity);
        }
        let remedy = match (wanted, self.field.size) {
            (Some(_), _) => format!("give a smaller {}", self.amount.name()),
            (None, Some(_)) => "give a larger --size".into(),
            (None, None) => "are mesh and metric in the same units? else give a --complexity".into(),
        };
        let [vertices, most] = [2.0 * complexity, 2.0 * GREATEST_COMPLEXITY];
        Err(format!(
            "{}: the metric asks for about {vertices:.0e} vertices, more than the {most:.0e} of the largest mesh; {remedy}",
            self.mesh.display()
        ))
    }
}

/// ln M of the size h in all directions.
pub(super) fn of_size(h: f64) -> Sym3 {
    Sym3::ZERO.plus_identity(-2.0 * h.ln())
}
