//! The files of a run: checked before it, written after it.
use super::Arguments;
use super::report::{Asked, Report};
use crate::cli::metric::common::{check_output, check_place};
use crate::geometry::names;
use crate::mesh::io;
use crate::metric::Field;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Refuses before the work what would fail after it: outputs that cannot be written, or that are inputs.
pub fn check(arguments: &Arguments) -> Result<(), String> {
    let output = &arguments.output;
    let metric = arguments.asked(0).metric_path();
    if let Some(report) = arguments.report.as_ref().filter(|&report| report == output || *report == metric) {
        return Err(format!("{}: is also the mesh's or its metric's file; give another --report", report.display()));
    }
    let given = &arguments.input;
    let inputs = [Some(&given.mesh), given.cad.as_ref(), given.field.metric.as_ref()];
    let inputs: Vec<&Path> = inputs.into_iter().flatten().chain(&given.field.field).map(PathBuf::as_path).collect();
    check_output(output, &["mesh", "meshb"], &inputs)?;
    check_output(&metric, &["solb"], &inputs)?;
    arguments.report.as_ref().map_or(Ok(()), |report| check_place(report, &inputs))
}

/// Writes mesh, metric and, where it is asked for, the report; `times` since the start: when the work began, when it ended, now.
pub fn write(
    asked: &Asked,
    json: Option<&Path>,
    mut report: Report,
    times: [Duration; 3],
) -> Result<Report, Box<dyn std::error::Error>> {
    io::write_mesh(&asked.output, &report.mesh)?;
    names::write(&asked.output, &report.names, &[])?;
    let field = Field { metrics: std::mem::take(&mut report.metrics) };
    field.write(&asked.metric_path())?;
    report.metrics = field.metrics;
    let [prepared, finished, measured] = times.map(|time| time.as_secs_f64());
    report.seconds.read_and_classify = prepared;
    report.seconds.adapt = finished - prepared;
    report.seconds.total = measured;
    if let Some(path) = json {
        let text = serde_json::to_vec_pretty(&report)?;
        io::write_beside(path, |file| file.write_all(&text).and_then(|()| file.write_all(b"\n")))?;
    }
    Ok(report)
}
