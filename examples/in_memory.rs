//! A solver's loop about the adapter, in memory: `cargo run --release --example in_memory [mesh.meshb model.step]`.
//!
//! The "solver" puts a steep front through the domain that moves a little each step; the metric asks for fine elements across it. A field of
//! the solver's own is brought along by the parents of the new vertices.
use geo_adapt::api::{Adapter, MeshView, Settings};
use geo_adapt::mesh::{TetMesh, io, samples};
use std::error::Error;
use std::path::Path;

/// Steps of the solver.
const STEPS: usize = 3;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let settings = Settings { complexity: Some(2000.0), ..Settings::default() };
    let (start, mut adapter): (TetMesh, Adapter) = match &arguments[..] {
        [_, mesh, model] => (io::read_mesh(Path::new(mesh))?.content, Adapter::on_cad(Path::new(model), settings)?),
        _ => (samples::cube(6), Adapter::discrete(settings)?),
    };
    let mut field: Vec<f64> = start.vertices.iter().map(|p| p[0]).collect();
    let mut adapted = adapter.adapt(&MeshView::of(&start), &metric(&start.vertices, 0))?;
    field = adapted.parents.interpolate(&start.tets.nodes, 1, &field);
    for step in 1..STEPS {
        tell(step, &adapted.mesh, &field);
        // With its place on the model, so that nothing is looked for anew.
        let next = adapter.adapt(&adapted.view(), &metric(&adapted.mesh.vertices, step))?;
        field = next.parents.interpolate(&adapted.mesh.tets.nodes, 1, &field);
        adapted = next;
    }
    tell(STEPS, &adapted.mesh, &field);
    Ok(())
}

/// Sizes at the vertices: small across a front x = const that moves, 11 12 22 13 23 33 in 1/length².
fn metric(vertices: &[[f64; 3]], step: usize) -> Vec<[f64; 6]> {
    let front = 0.3 + 0.2 * step as f64;
    let across = |x: f64| 0.01 + 0.2 * (x - front).abs();
    vertices.iter().map(|p| [across(p[0]).powi(-2), 0.0, 25.0, 0.0, 0.0, 25.0]).collect()
}

fn tell(step: usize, mesh: &TetMesh, field: &[f64]) {
    let (vertices, tets) = (mesh.vertices.len(), mesh.tets.len());
    let off = mesh.vertices.iter().zip(field).map(|(p, u)| (p[0] - u).abs()).fold(0.0, f64::max);
    println!("step {step}: {vertices} vertices, {tets} tetrahedra; the field is off by {off:.1e} at most");
}
