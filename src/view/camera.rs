//! From the model to the picture, without perspective: parallel edges stay parallel.
use crate::mesh::vector::{Vec3, cross, dot, sub};

/// A view: directions are unit vectors in model space.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    /// To the right of the picture.
    pub right: Vec3,
    /// Up in the picture.
    pub up: Vec3,
    /// Out of the picture, towards the viewer.
    pub toward: Vec3,
    /// The point that is shown at `middle`.
    pub target: Vec3,
    /// Where that is, pixels from the left and from the top.
    pub middle: [f64; 2],
    /// Pixels a model unit.
    pub scale: f64,
}

impl Camera {
    /// Seen from azimuth (from x to y) and elevation (from the xy plane up), in degrees; z is up in the picture. The origin is in the
    /// middle, a pixel is a unit.
    pub fn from([azimuth, elevation]: [f64; 2]) -> Self {
        let (sa, ca) = azimuth.to_radians().sin_cos();
        let (se, ce) = elevation.to_radians().sin_cos();
        let (toward, right) = ([ce * ca, ce * sa, se], [-sa, ca, 0.0]);
        Self { right, up: cross(toward, right), toward, target: [0.0; 3], middle: [0.0; 2], scale: 1.0 }
    }

    /// Pixels from the left and from the top, and how near (greater is nearer), in pixels too.
    pub fn place(&self, p: Vec3) -> Vec3 {
        let v = sub(p, self.target);
        [
            self.middle[0] + self.scale * dot(v, self.right),
            self.middle[1] - self.scale * dot(v, self.up),
            self.scale * dot(v, self.toward),
        ]
    }

    /// Puts these points into the middle of a rectangle of the picture: left, top, width and height in pixels; then enlarges.
    pub fn fit(&mut self, points: impl Iterator<Item = Vec3>, [left, top, width, height]: [f64; 4], zoom: f64) {
        let directions = [self.right, self.up, self.toward];
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for p in points {
            for i in 0..3 {
                let x = dot(p, directions[i]);
                (low[i], high[i]) = (low[i].min(x), high[i].max(x));
            }
        }
        if low[0] > high[0] {
            (low, high) = ([0.0; 3], [1.0; 3]);
        }
        let middle: Vec3 = std::array::from_fn(|i| 0.5 * (low[i] + high[i]));
        self.target = std::array::from_fn(|k| (0..3).map(|i| middle[i] * directions[i][k]).sum());
        self.middle = [left + 0.5 * width, top + 0.5 * height];
        let fits = (width / (high[0] - low[0])).min(height / (high[1] - low[1]));
        self.scale = zoom * if fits.is_finite() { fits } else { 1.0 };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn from_the_axes() {
        let close = |a: Vec3, b: Vec3| (0..3).all(|i| (a[i] - b[i]).abs() < 1e-12);
        let camera = Camera::from([-90.0, 0.0]);
        assert!(close(camera.right, [1.0, 0.0, 0.0]) && close(camera.up, [0.0, 0.0, 1.0]));
        let camera = Camera::from([-90.0, 90.0]);
        assert!(close(camera.right, [1.0, 0.0, 0.0]) && close(camera.up, [0.0, 1.0, 0.0]));
        assert!(close(camera.toward, [0.0, 0.0, 1.0]));
    }

    #[test]
    fn what_is_fitted_fills_the_rectangle() {
        let corners = [[0.0, 0.0, 0.0], [4.0, 1.0, 2.0]];
        let mut camera = Camera::from([-90.0, 0.0]);
        camera.fit(corners.into_iter(), [10.0, 20.0, 100.0, 100.0], 1.0);
        let [low, high] = corners.map(|p| camera.place(p));
        assert!((low[0] - 10.0).abs() < 1e-9 && (high[0] - 110.0).abs() < 1e-9);
        assert!((low[1] - 95.0).abs() < 1e-9 && (high[1] - 45.0).abs() < 1e-9);
        assert!(low[2] > high[2], "y = 0 is nearer from −y");
    }
}
