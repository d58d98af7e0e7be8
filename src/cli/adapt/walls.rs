//! The layers along the walls of --wall, among the sizes of a run that hold whatever its metric says.
use super::input::InputArguments;
use super::source::On;
use crate::geometry::Model;
use crate::mesh::TetMesh;
use crate::metric::multiscale::{Bounds, Measure, Norm, bounded, diameter};
use crate::metric::{Limits, Sym3, field, grade};
use crate::sizing::layer::{self, Options, Outside, wall_metric};
use crate::tasks::{Team, stage};

/// The layers, the geometry and the local sizes together take at most this share of the complexity, so that some is left for the field.
const SHARE: f64 = 0.75;
/// Spalding's law has this share of the complexity.
const OF_LAW: f64 = 0.5;
/// Segments for a radian of a wall's curvature, as those of the geometry by default.
const SEGMENTS: f64 = 2.0;

impl InputArguments {
    /// What sizes are outside the layers: there a wall asks for nothing that is not asked for anyway.
    pub(super) fn outside_layers(&self, team: Team<'_>, mesh: &TetMesh, model: &Model) -> Result<Outside, String> {
        let limits = self.multiscale.limits()?;
        let greatest = if self.has_geometry() {
            self.geometry.options(model, limits, None).greatest
        } else {
            limits.hmax.unwrap_or_else(|| diameter(team, mesh))
        };
        Ok(Outside { greatest, segments: SEGMENTS })
    }

    /// ln of a metric that holds whatever the field says, with that of the walls intersected. Where the complexity is given and all that asks for more
    /// than most of it, the layers are enlarged.
    pub(super) fn with_walls(
        &self,
        team: Team<'_>,
        mesh: &TetMesh,
        on: On<'_>,
        others: Option<Vec<Sym3>>,
        (wanted, gradation): (Option<f64>, Option<f64>),
        notices: &mut Vec<String>,
    ) -> Result<Option<Vec<Sym3>>, String> {
        if self.walls.is_empty() {
            return Ok(others);
        }
        let asked = on.places(mesh).walls(&self.walls)?;
        let is_law = asked.iter().any(|asked| asked.wall.spalding.is_some());
        let options = Options {
            outside: self.outside_layers(team, mesh, on.model)?,
            complexity: wanted.filter(|_| is_law).map(|wanted| OF_LAW * wanted),
            norm: Norm::default(),
            exact: false,
        };
        let (logs, _) =
            wall_metric(team, (mesh, on.place, on.model), &asked, &options).map_err(|error| match error {
                layer::Error::NoComplexity => format!("--wall: {error}, by --complexity or --vertices"),
                layer::Error::Multiscale(error) => format!("--wall: {error}"),
            })?;
        stage("walls");
        let measure = Measure::Between;
        let most = SHARE * wanted.unwrap_or(f64::INFINITY);
        let limits = Limits::default();
        let bounds = Bounds { complexity: most, measure, gradation, limits, fixed: others.as_deref(), by_others: None };
        let mut all = logs.clone();
        bounds.apply(team, &mut all);
        let Some(wanted) = wanted else { return Ok(Some(all)) };
        // As it will be once it is graded.
        let mut graded = all.clone();
        if let Some(ratio) = gradation {
            grade(team, mesh, &mut graded, ratio);
        }
        let own = field::complexity_between(team, mesh, &graded);
        if own <= most {
            return Ok(Some(all));
        }
        let asked = self.amount.name();
        notices.push(format!(
            "the layers of --wall and the geometry ask for a complexity of {own:.0}: sizes in the layers are enlarged, across them too, to leave a \
             quarter of {wanted} to the field (a greater {asked} keeps them)"
        ));
        let enlarged = bounded(team, mesh, &logs, &bounds).map_err(|error| format!("--wall: {error}"))?;
        Ok(Some(enlarged.0))
    }
}
