//! Into how many parts a mesh is cut, and by how much it grows at once.

/// From a stage to the next the mesh grows by this factor at most.
const GROWTH: f64 = 8.0;

/// Vertices for a unit of complexity.
const VERTICES_PER_COMPLEXITY: f64 = 1.9;

/// From a zone to the next there are fewer parts by this factor at least, so that none is left to cut;
const FEWER: usize = 3;

/// but where a zone has less than this share of what there was before, it is thin: a cut across it is small, and what is around that much less.
const THIN: f64 = 0.5;

/// How large parts are.
#[derive(Clone, Copy, Debug)]
pub struct Sizes {
    /// Vertices of a part of a large mesh.
    pub part: f64,
    /// Smaller meshes have up to so many parts, which serve as many threads,
    pub few: f64,
    /// unless these had fewer vertices than this.
    pub least: f64,
    /// Vertices of a part of a thin zone.
    pub zone: f64,
}

impl Default for Sizes {
    fn default() -> Self {
        Self { part: 300_000.0, few: 16.0, least: 40_000.0, zone: 100_000.0 }
    }
}

impl Sizes {
    /// Parts of so many vertices.
    pub fn of(vertices: f64) -> Self {
        Self { part: vertices, few: 1.0, least: vertices, zone: vertices / 3.0 }
    }

    /// Into how many parts a mesh of so many vertices is cut.
    pub fn parts(&self, vertices: f64) -> usize {
        (vertices / self.part).max((vertices / self.least).min(self.few)).ceil().max(1.0) as usize
    }

    /// Into how many parts the surroundings of the cuts of a round are cut, of so many vertices. The round had `parts`, of `all` vertices.
    pub fn zone_parts(&self, vertices: f64, (parts, all): (usize, f64)) -> usize {
        let fewer = self.parts(vertices).min(parts.div_ceil(FEWER));
        if vertices < THIN * all { fewer.max((vertices / self.zone).ceil() as usize) } else { fewer }
    }
}

/// Vertices of a mesh of this complexity, about.
pub fn wanted_vertices(complexity: f64) -> f64 {
    VERTICES_PER_COMPLEXITY * complexity
}

/// The shares of the complexity of the stages, ascending to 1.
pub fn growth(wanted: f64, given: f64, sizes: &Sizes) -> Vec<f64> {
    let mut shares = vec![1.0];
    while shares[0] * wanted > GROWTH * given && sizes.parts(shares[0] * wanted) > 1 {
        shares.insert(0, shares[0] / GROWTH);
    }
    shares
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_few_and_then_large() {
        let sizes = Sizes::default();
        let parts = [1e3, 40_000.0, 41_000.0, 640_000.0, 4.8e6, 1e7].map(|vertices| sizes.parts(vertices));
        assert_eq!(parts, [1, 1, 2, 16, 16, 34]);
    }

    #[test]
    fn zones_have_fewer_parts_unless_they_are_thin() {
        let sizes = Sizes::default();
        assert_eq!(sizes.zone_parts(450_000.0, (16, 760_000.0)), 6);
        assert_eq!(sizes.zone_parts(4e6, (33, 1e7)), 40);
        assert_eq!(sizes.zone_parts(30_000.0, (2, 170_000.0)), 1);
        // With small parts zones are all of the mesh, and still they come to an end.
        let small = Sizes::of(600.0);
        assert_eq!([81, 27, 9, 3, 2].map(|parts| small.zone_parts(40_000.0, (parts, 50_000.0))), [27, 9, 3, 1, 1]);
    }

    #[test]
    fn a_mesh_grows_by_no_more_than_a_factor_at_once() {
        let sizes = Sizes::default();
        assert_eq!(growth(1e7, 8e3, &sizes), [1.0 / 512.0, 1.0 / 64.0, 0.125, 1.0]);
        // In one part it may grow as it likes, and a large mesh is cut at once.
        assert_eq!(growth(3e4, 10.0, &sizes), [1.0]);
        assert_eq!(growth(1e7, 5e6, &sizes), [1.0]);
    }
}
