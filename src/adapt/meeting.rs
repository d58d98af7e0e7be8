//! Meeting a number of vertices: the mesh is counted, and made again with another complexity where it has too many or too few.

/// Vertices of a mesh for a unit of the complexity of its metric, where the boundary is little of it.
pub const VERTICES_PER_COMPLEXITY: f64 = 2.0;

/// A number of vertices is met if it is off by no more than this share.
const NEAR: f64 = 0.1;

/// Meshes made at most. The number of vertices is nearly proportional to the complexity: two meet it as a rule.
const TRIES: u32 = 4;

/// The complexity is changed by no more than this factor at a time.
const GREATEST_CHANGE: f64 = 10.0;

/// The mesh that came nearest.
pub struct Met<T> {
    /// The mesh.
    pub best: T,
    /// Of its metric.
    pub complexity: f64,
    /// Meshes that were made.
    pub meshes: u32,
    /// Whether it has as many vertices as are wanted, within 10 %.
    pub is_met: bool,
    /// Whether it is the last one that was made.
    pub is_last: bool,
}

/// Makes meshes until one has about `wanted` vertices, no more is gained, or `is_stopped` says so; `count` counts them. The first one was made with
/// `complexity`. `make` makes one with another complexity, and is told the vertices of the one before; none where there is no such metric.
///
/// # Errors
/// Those of `make`.
pub fn meet<T, E>(
    wanted: f64,
    (first, complexity): (T, f64),
    count: impl Fn(&T) -> usize,
    mut make: impl FnMut(f64, usize) -> Result<Option<T>, E>,
    is_stopped: impl Fn() -> bool,
) -> Result<Met<T>, E> {
    let share = |mesh: &T| count(mesh) as f64 / wanted;
    let is_near = |mesh: &T| (share(mesh) - 1.0).abs() <= NEAR;
    let off = |mesh: &T| share(mesh).ln().abs();
    let mut met = Met { is_met: is_near(&first), best: first, complexity, meshes: 1, is_last: true };
    while met.meshes < TRIES && !met.is_met && !is_stopped() {
        let next = met.complexity * (wanted / count(&met.best) as f64).clamp(1.0 / GREATEST_CHANGE, GREATEST_CHANGE);
        let Some(again) = make(next, count(&met.best))? else { break };
        met.meshes += 1;
        if off(&again) >= off(&met.best) || is_stopped() {
            met.is_last = false;
            break;
        }
        met = Met { is_met: is_near(&again), best: again, complexity: next, ..met };
    }
    Ok(met)
}
