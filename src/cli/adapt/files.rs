//! The files of a run: checked before it, written after it.
use super::report::Report;
use crate::cli::figures::FigureArguments;
use crate::cli::files::{Files, Outputs, Target};
use crate::geometry::Names;
use crate::mesh::TetMesh;
use crate::metric::Field;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Where a run writes: the mesh with its names, its metric beside it, and the report, where it is asked for.
pub struct Targets {
    mesh: Target,
    metric: Target,
    report: Option<Target>,
    /// A model that was made by the run, and where it goes.
    model: Option<(PathBuf, Target)>,
}

impl Targets {
    /// Refuses before the work what would fail after it; `endings` of the report.
    pub fn of(files: &mut Files, output: &Path, figures: &FigureArguments, endings: &[&str]) -> Result<Self, String> {
        let mesh = files.writes_mesh(output, "-o")?;
        let metric = files.writes(&super::report::metric_path(output), "the metric beside -o", &[])?;
        let report = figures.target(files, endings)?;
        Ok(Self { mesh, metric, report, model: None })
    }

    /// The model that was made on the way belongs to the result too.
    pub fn with_model(&mut self, made: PathBuf, to: Target) {
        self.model = Some((made, to));
    }

    /// Writes a mesh without a metric.
    pub fn write_mesh(&self, mesh: &TetMesh, names: &Names) -> Result<(), Box<dyn std::error::Error>> {
        let mut outputs = self.outputs()?;
        outputs.mesh(&self.mesh, mesh, names)?;
        outputs.commit()
    }

    fn outputs(&self) -> Result<Outputs, Box<dyn std::error::Error>> {
        let mut outputs = Outputs::new();
        if let Some((made, to)) = &self.model {
            outputs.copy(made, to)?;
        }
        Ok(outputs)
    }

    /// Writes mesh, metric and report together; `times` since the start: when the work began, when it ended, now.
    pub fn write(&self, mut report: Report, times: [Duration; 3]) -> Result<Report, Box<dyn std::error::Error>> {
        let mut outputs = self.outputs()?;
        outputs.mesh(&self.mesh, &report.mesh, &report.names)?;
        let field = Field { metrics: std::mem::take(&mut report.metrics) };
        outputs.metric(&self.metric, &field)?;
        report.metrics = field.metrics;
        let [prepared, finished, measured] = times.map(|time| time.as_secs_f64());
        report.seconds.read_and_classify = prepared;
        report.seconds.adapt = finished - prepared;
        report.seconds.total = measured;
        outputs.json(self.report.as_ref(), &report)?;
        outputs.commit()?;
        Ok(report)
    }
}
