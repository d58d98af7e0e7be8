//! The files of a run: checked before it, written after it.
use super::report::Report;
use super::slices;
use crate::cli::figures::FigureArguments;
use crate::cli::files::reading::METRIC;
use crate::cli::files::{Files, Outputs, Target};
use crate::decomposition::Adapted;
use crate::formats::{Dataset, NamedField};
use crate::geometry::Model;
use crate::mesh::io::{FieldKind, MeshCounts};
use crate::metric::Field;
use crate::ranks::Ranks;
use crate::tasks::{Team, stage};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

type Failure = Box<dyn std::error::Error>;

/// Where a run writes: the mesh with its names, its metric in the same file or beside it, and the report, where it is asked for.
pub struct Targets {
    mesh: Target,
    /// None where the mesh's format holds the metric too.
    metric: Option<Target>,
    report: Option<Target>,
    /// A model that was made by the run, and where it goes.
    model: Option<(PathBuf, Target)>,
}

impl Targets {
    /// Refuses before the work what would fail after it; `endings` of the report.
    pub fn of(files: &mut Files, output: &Path, figures: &FigureArguments, endings: &[&str]) -> Result<Self, String> {
        let mesh = files.writes_mesh(output, "-o")?;
        let metric = super::report::metric_path(output)
            .map(|path| files.writes(&path, "the metric beside -o", &[]))
            .transpose()?;
        let report = figures.target(files, endings)?;
        Ok(Self { mesh, metric, report, model: None })
    }

    /// The model that was made on the way belongs to the result too.
    pub fn with_model(&mut self, made: PathBuf, to: Target) {
        self.model = Some((made, to));
    }

    /// Writes a mesh without a metric. Returns what its format cannot carry.
    pub fn mesh_alone(&self, team: Team<'_>, data: &Dataset) -> Result<Vec<String>, Failure> {
        let mut outputs = self.outputs()?;
        let lost = outputs.mesh(team, &self.mesh, data)?;
        outputs.commit()?;
        Ok(lost)
    }

    fn outputs(&self) -> Result<Outputs, Failure> {
        let mut outputs = Outputs::new();
        if let Some((made, to)) = &self.model {
            outputs.copy(made, to)?;
        }
        Ok(outputs)
    }

    /// Writes mesh, metric and report together. The mesh is measured while the disk takes its files. `times` are the start, and those since when
    /// the work began and when it ended. Returns with the report what the mesh's format cannot carry.
    pub fn write(
        &self,
        (team, model): (Team<'_>, &Model),
        mut report: Report,
        (start, [prepared, finished]): (Instant, [Duration; 2]),
    ) -> Result<(Report, Vec<String>), Failure> {
        let mut outputs = self.outputs()?;
        let field = Field { metrics: std::mem::take(&mut report.metrics) };
        let (mesh, stack) = (std::mem::take(&mut report.mesh), std::mem::take(&mut report.stack));
        let mut data = Dataset { mesh, stack, names: report.names.clone(), fields: vec![] };
        match &self.metric {
            Some(target) => outputs.metric(team, target, &field)?,
            None => {
                let values = field.solution(team, self.mesh.path())?.fields.into_iter().flat_map(|field| field.values);
                let (name, kind) = (METRIC.into(), FieldKind::SymmetricTensor);
                data.fields.push(NamedField { name, kind, values: values.collect() });
            }
        }
        let lost = outputs.mesh(team, &self.mesh, &data)?;
        (report.mesh, report.stack) = (data.mesh, data.stack);
        report.metrics = field.metrics;
        stage("files made");
        report.measure(team, model);
        stage("report");
        self.finish(outputs, &mut report, [prepared, finished, start.elapsed()])?;
        Ok((report, lost))
    }

    /// The same of a mesh that is not in memory: the report has its boundary, whose vertices come first, and the rest comes by slices, also those
    /// of the other ranks ([`slices::help`]). `times` are the start, and those since when the work began and when it ended.
    pub fn by_slices(
        &self,
        (team, ranks): (Team<'_>, &dyn Ranks),
        mut report: Report,
        adapted: &Adapted<'_>,
        (start, [prepared, finished]): (Instant, [Duration; 2]),
    ) -> Result<Report, Failure> {
        let mut outputs = Outputs::new();
        let [vertices, tets] = adapted.size();
        let counts = MeshCounts { vertices, tets, ..MeshCounts::of(&report.mesh) };
        let mut begin = || {
            let metric = self.metric.as_ref().ok_or("a mesh by slices has its metric beside it")?;
            outputs = self.outputs()?;
            Ok(outputs.slices(&self.mesh, metric, &counts, &report.names)?)
        };
        let (statistics, near_cuts) = slices::write(ranks, team, adapted, begin(), (&report.mesh, &report.metrics))?;
        report.statistics = statistics;
        report.parts.iter_mut().for_each(|parts| parts.near_cuts = near_cuts);
        self.finish(outputs, &mut report, [prepared, finished, start.elapsed()])?;
        Ok(report)
    }

    /// Adds the report, and gives all files their names.
    fn finish(&self, mut outputs: Outputs, report: &mut Report, times: [Duration; 3]) -> Result<(), Failure> {
        let [prepared, finished, measured] = times.map(|time| time.as_secs_f64());
        report.seconds.read_and_classify = prepared;
        report.seconds.adapt = finished - prepared;
        report.seconds.total = measured;
        outputs.json(self.report.as_ref(), &*report)?;
        outputs.commit()
    }
}
