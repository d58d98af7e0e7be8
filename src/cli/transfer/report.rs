//! The figures of a transfer.
use crate::cli::table::{Table, figure};
use crate::transfer::Component;
use serde::Serialize;

/// What was done.
#[derive(Serialize)]
pub(super) struct Report {
    pub method: &'static str,
    pub vertices: [usize; 2],
    pub tets: [usize; 2],
    /// New vertices outside the old mesh.
    pub outside: usize,
    pub farthest: f64,
    /// Volumes of the old and the new mesh.
    pub volumes: [f64; 2],
    #[serde(skip_serializing_if = "Option::is_none")]
    pub overlap: Option<Overlap>,
    pub values: Vec<Value>,
    pub seconds: Seconds,
}

/// How far the meshes cover each other, of a conservative transfer.
#[derive(Serialize)]
pub(super) struct Overlap {
    pub common_volume: f64,
    /// New tetrahedra of which a part lies outside the old mesh.
    pub partly_outside: usize,
    /// New tetrahedra outside the old mesh.
    pub outside: usize,
}

/// One value of each vertex: a component of a field.
#[derive(Serialize)]
pub(super) struct Value {
    /// Of the field, from 1.
    pub field: usize,
    /// In the field, from 1.
    pub component: usize,
    pub before: Component,
    pub after: Component,
    /// By how much the last correction of a conservative transfer changed the integral.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub corrected: Option<f64>,
}

/// Wall times, s.
#[derive(Default, Serialize)]
pub(super) struct Seconds {
    pub read: f64,
    pub transfer: f64,
    pub total: f64,
}

impl Report {
    /// The components of fields on the old and the new mesh, with what a conservative transfer changed last.
    pub fn values(
        components: impl Iterator<Item = (usize, usize)>,
        [before, after]: [&[Component]; 2],
        corrected: Option<&[f64]>,
    ) -> Vec<Value> {
        let value = |(c, (field, component)): (usize, (usize, usize))| Value {
            field,
            component,
            before: before[c],
            after: after[c],
            corrected: corrected.map(|corrected| corrected[c]),
        };
        components.enumerate().map(value).collect()
    }

    /// The table for the terminal.
    pub fn text(&self) -> String {
        let mut table = Table::new();
        let ([v, w], [t, u]) = (self.vertices, self.tets);
        table.row("method", self.method);
        table.row("vertices", format_args!("{v} -> {w}"));
        table.row("tetrahedra", format_args!("{t} -> {u}"));
        table.row("outside the old mesh", format_args!("{} vertices, which have its nearest values", self.outside));
        table.row("farthest from it", figure(self.farthest));
        let [v, w] = self.volumes;
        table.row("volume", format_args!("{v:.12e} -> {w:.12e} ({:+.1e})", w / v - 1.0));
        if let Some(Overlap { common_volume, partly_outside, outside }) = &self.overlap {
            table.row("volume in common", format_args!("{common_volume:.12e}"));
            table.row("tetrahedra outside", format_args!("{outside}, partly {partly_outside}"));
        }
        for value in &self.values {
            let Value { field, component, before, after, .. } = value;
            let name = |what: &str| format!("{field}.{component} {what}");
            let change = (after.mass - before.mass) / before.mass;
            let change = if change.is_finite() { format!(" ({change:+.1e})") } else { String::new() };
            table.row(&name("integral"), format_args!("{:.12e} -> {:.12e}{change}", before.mass, after.mass));
            let range = |found: &Component| format!("{} to {}", figure(found.least), figure(found.greatest));
            table.row(&name("values"), format_args!("{} -> {}", range(before), range(after)));
        }
        let Seconds { read, transfer, total } = self.seconds;
        table.row("seconds", format_args!("{total:.2} (read {read:.2}, transfer {transfer:.2})"));
        table.text().into()
    }
}
