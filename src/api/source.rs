//! The metric that the mesh is adapted to: of the complexity that is wanted, with sizes along curved walls that straight edges can have.
use super::error::Error;
use super::view::{self, MeshView};
use super::{Classification, Model, Settings, Sym3};
use crate::adapt::forecast::GREATEST_COMPLEXITY;
use crate::mesh::TetMesh;
use crate::mesh::adjacency::MatchedFaces;
use crate::metric::multiscale::{Bounds, Measure, bounded};
use crate::metric::{Field, Limits, Source, field};
use crate::sizing::background;
use crate::sizing::chords::{ChordLimit, Chords, Limited, SHARE, dive};
use crate::tasks::Team;
use std::sync::Arc;

/// A mesh's place, and the model.
type On<'a> = (&'a Classification, &'a Model);

/// ln M of a metric that fits the mesh and is positive definite.
pub(super) fn logs<M: Copy + Into<Sym3>>(
    team: Team<'_>,
    view: &MeshView<'_>,
    metric: &[M],
) -> Result<Vec<Sym3>, Error> {
    view::fits("metrics", metric.len(), view.vertices.len())?;
    let metrics: Vec<Sym3> = metric.iter().map(|&tensor| tensor.into()).collect();
    if let Some(vertex) = metrics.iter().position(|metric| !metric.is_spd()) {
        return Err(Error::Metric { vertex });
    }
    Ok(Field::logs_of(team, &metrics))
}

/// The metric with these ln M at the vertices, as the settings say, and what was cut along walls.
pub(super) fn of(
    team: Team<'_>,
    (mesh, faces): (&Arc<TetMesh>, MatchedFaces),
    on: On<'_>,
    logs: Vec<Sym3>,
    settings: &Settings,
) -> Result<(Source, Option<Limited>), Error> {
    let wanted = settings.complexity;
    if let Some(complexity) = wanted.filter(|wanted| !(*wanted > 0.0 && *wanted <= GREATEST_COMPLEXITY)) {
        return Err(Error::Complexity { complexity, most: GREATEST_COMPLEXITY });
    }
    if let Some(share) = settings.chords.share() {
        if !(share > 0.0 && share <= 1.0) {
            return Err(Error::Share { share });
        }
        return cut(team, (mesh, faces), on, logs, (share, wanted));
    }
    let may_be_cut = settings.chords == ChordLimit::Auto && !matches!(on.1, Model::Discrete(_));
    let given = may_be_cut.then(|| logs.clone());
    let mut source = Source::Background(background(team, (mesh, faces), on, logs));
    scale(team, mesh, &mut source, wanted)?;
    if let (Some(given), Source::Background(background)) = (given, &source)
        && dive(team, on.0, on.1, background.logs()).is_deep()
    {
        let faces = MatchedFaces::of(team, &mesh.tets.nodes);
        // There may be no metric of this complexity that is cut.
        if let Ok(made) = cut(team, (mesh, faces), on, given, (SHARE, wanted)) {
            return Ok(made);
        }
    }
    Ok((source, None))
}

/// The metric cut along walls to a share of √(8 h R), and of a complexity.
fn cut(
    team: Team<'_>,
    (mesh, faces): (&Arc<TetMesh>, MatchedFaces),
    on: On<'_>,
    mut logs: Vec<Sym3>,
    (share, wanted): (f64, Option<f64>),
) -> Result<(Source, Option<Limited>), Error> {
    let chords = Chords::new(on.0, on.1, share);
    let (measure, limits) = (Measure::Between, Limits::default());
    let complexity = wanted.unwrap_or(1.0);
    let bounds = Bounds { complexity, measure, gradation: None, limits, fixed: None, by_others: Some(&chords) };
    let cut = if wanted.is_some() {
        let unreachable = Error::Complexity { complexity, most: GREATEST_COMPLEXITY };
        let (found, summary) = bounded(team, mesh, &logs, &bounds).map_err(|_| unreachable)?;
        logs = found;
        summary.cut
    } else {
        bounds.apply(team, &mut logs).1
    };
    let mut source = Source::Background(background(team, (mesh, faces), on, logs));
    scale(team, mesh, &mut source, None)?;
    Ok((source, cut.map(|cut| Limited { share, cut })))
}

/// Scales the source to the complexity that is asked for, which is one that a mesh can have; refuses another if none is asked for.
fn scale(team: Team<'_>, mesh: &TetMesh, source: &mut Source, wanted: Option<f64>) -> Result<(), Error> {
    if let Some(target) = wanted {
        let own = source.complexity(team, mesh);
        source.scale(team, field::complexity_factor(own, target).ln());
        return Ok(());
    }
    if source.complexity_bound(team, mesh) <= GREATEST_COMPLEXITY {
        return Ok(());
    }
    let complexity = source.complexity(team, mesh);
    // NaN is refused, too.
    if complexity <= GREATEST_COMPLEXITY {
        Ok(())
    } else {
        Err(Error::Complexity { complexity, most: GREATEST_COMPLEXITY })
    }
}
