//! An image smoothed, with its second derivatives at any point.
use super::frame::Frame;
use super::nrrd::Image;
use crate::mesh::vector::Vec3;
use crate::tasks::Team;
use nalgebra::Matrix3;

/// The Gauss filter is cut off at so many standard deviations.
const REACH: f64 = 3.0;

/// Voxels a task.
const FEW: usize = 1 << 14;

/// The values of an image convolved with a Gaussian. Beyond the border the values of the border go on.
pub struct Smoothed {
    frame: Frame,
    sizes: [usize; 3],
    values: Vec<f32>,
}

impl Smoothed {
    /// With a standard deviation in voxels, along each axis of the image; 0 leaves the values as they are. None when a value is no
    /// finite number: then its voxel, in the order of memory.
    pub fn new(team: Team<'_>, image: &Image, deviation: f64) -> Result<Self, usize> {
        let mut values = team.map(FEW, image.len(), |voxel| image.value(voxel) as f32);
        let odd = team.chunks(FEW, values.len(), |mut range| range.find(|&voxel| !values[voxel].is_finite()));
        if let Some(voxel) = odd.into_iter().flatten().next() {
            return Err(voxel);
        }
        let radius = (REACH * deviation).ceil() as usize;
        let weights: Vec<f64> = (0..=radius).map(|i| (-0.5 * (i as f64 / deviation.max(1e-9)).powi(2)).exp()).collect();
        let sum = weights[0] + 2.0 * weights[1..].iter().sum::<f64>();
        let mut stride = 1;
        for size in image.sizes {
            if radius > 0 && size > 1 {
                values = team.map(FEW, values.len(), |voxel| {
                    let at = voxel / stride % size;
                    let value = |to: usize| f64::from(values[voxel - at * stride + to.min(size - 1) * stride]);
                    let pair = |i: usize| value(at.saturating_sub(i)) + value(at + i);
                    let around: f64 = (1..=radius).map(|i| weights[i] * pair(i)).sum();
                    ((weights[0] * value(at) + around) / sum) as f32
                });
            }
            stride *= size;
        }
        Ok(Self { frame: image.frame, sizes: image.sizes, values })
    }

    /// Second derivatives up to this are rounding of the values, which are kept in single precision.
    pub fn rounding(&self) -> f64 {
        let greatest = self.values.iter().fold(0.0f32, |a, x| a.max(x.abs()));
        let least = self.frame.spacings().into_iter().fold(f64::INFINITY, f64::min);
        2.0 * f64::from(f32::EPSILON) * f64::from(greatest) / (least * least)
    }

    /// The value at an index, trilinear between voxels; beyond the border that at the border.
    pub fn value_at(&self, index: Vec3) -> f64 {
        let (mut first, mut part) = ([0; 3], [0.0; 3]);
        for i in 0..3 {
            let at = index[i].clamp(0.0, (self.sizes[i] - 1) as f64);
            first[i] = (at as usize).min(self.sizes[i].saturating_sub(2));
            part[i] = at - first[i] as f64;
        }
        let [x, y, _] = self.sizes;
        let mut sum = 0.0;
        for corner in 0..8 {
            let bit = |i: usize| corner >> i & 1;
            let weight: f64 = (0..3).map(|i| if bit(i) == 1 { part[i] } else { 1.0 - part[i] }).product();
            if weight > 0.0 {
                let [i, j, k] = [0, 1, 2].map(|axis| first[axis] + bit(axis));
                sum += weight * f64::from(self.values[(k * y + j) * x + i]);
            }
        }
        sum
    }

    /// The second derivatives at a point in space, 11 12 22 13 23 33, value/length²: central differences over a voxel to each side.
    pub fn hessian(&self, point: Vec3) -> [f64; 6] {
        let at = self.frame.index(point);
        let shifted = |shifts: [f64; 3]| self.value_at(std::array::from_fn(|i| at[i] + shifts[i]));
        let centre = shifted([0.0; 3]);
        let mut of_index = Matrix3::zeros();
        for i in 0..3 {
            let along = |s: f64| std::array::from_fn(|k| if k == i { s } else { 0.0 });
            of_index[(i, i)] = shifted(along(1.0)) - 2.0 * centre + shifted(along(-1.0));
            for j in 0..i {
                let to = |s: f64, t: f64| {
                    shifted(std::array::from_fn(|k| {
                        if k == i {
                            s
                        } else if k == j {
                            t
                        } else {
                            0.0
                        }
                    }))
                };
                of_index[(i, j)] = 0.25 * (to(1.0, 1.0) - to(1.0, -1.0) - to(-1.0, 1.0) + to(-1.0, -1.0));
                of_index[(j, i)] = of_index[(i, j)];
            }
        }
        let h = self.frame.hessian(&of_index);
        [h[(0, 0)], h[(0, 1)], h[(1, 1)], h[(0, 2)], h[(1, 2)], h[(2, 2)]]
    }
}

/// The centres of the faces between voxels of different values, and of those on the border of the image whose voxel is not 0.
pub fn borders(team: Team<'_>, image: &Image) -> Vec<Vec3> {
    let [x, y, _] = image.sizes;
    let strides = [1, x, x * y];
    team.collect(FEW, image.len(), |range, found| {
        for voxel in range {
            let value = image.value(voxel);
            let at: [usize; 3] = std::array::from_fn(|i| voxel / strides[i] % image.sizes[i]);
            let centre = |axis: usize, side: f64| {
                image.frame.point(std::array::from_fn(|i| at[i] as f64 + if i == axis { 0.5 * side } else { 0.0 }))
            };
            for axis in 0..3 {
                let next = if at[axis] + 1 < image.sizes[axis] { image.value(voxel + strides[axis]) } else { 0.0 };
                if next != value {
                    found.push(centre(axis, 1.0));
                }
                if at[axis] == 0 && value != 0.0 {
                    found.push(centre(axis, -1.0));
                }
            }
        }
    })
}

#[cfg(test)]
mod tests {
    use super::super::nrrd::Kind;
    use super::*;
    use crate::mesh::vector::dot;

    #[test]
    fn a_quadratic_has_its_second_derivatives() {
        let frame = Frame::new([1.0, -2.0, 3.0], [[0.1, 0.02, 0.0], [0.0, 0.15, 0.01], [0.03, 0.0, 0.2]]).unwrap();
        let sizes = [24, 20, 16];
        let exact = [2.0, 0.7, -1.5, 0.3, 0.2, 4.0];
        let value = |p: Vec3| {
            let [x, y, z] = p;
            let terms = [x * x / 2.0, x * y, y * y / 2.0, x * z, y * z, z * z / 2.0];
            (0..6).map(|i| exact[i] * terms[i]).sum::<f64>() + dot(p, [1.0, 2.0, -3.0])
        };
        let at = |voxel: usize| frame.point([voxel % 24, voxel / 24 % 20, voxel / 480].map(|i| i as f64));
        let image = Image::new(sizes, frame, Kind::Double, (0..24 * 20 * 16).map(|voxel| value(at(voxel))));
        for deviation in [0.0, 1.0] {
            let smoothed = Smoothed::new(Team::alone(), &image, deviation).unwrap();
            let found = smoothed.hessian(frame.point([11.3, 9.6, 8.2]));
            assert!((0..6).all(|i| (found[i] - exact[i]).abs() < 2e-2), "{deviation}: {found:?}");
        }
    }

    #[test]
    fn a_step_is_smoothed_and_its_border_found() {
        let frame = Frame::of_spacings([1.0, 1.0, 2.0]).unwrap();
        let image = Image::new([8, 4, 3], frame, Kind::Uint8, (0..96).map(|voxel| f64::from(u8::from(voxel % 8 >= 4))));
        let smoothed = Smoothed::new(Team::alone(), &image, 1.0).unwrap();
        assert!((smoothed.value_at([3.5, 1.0, 1.0]) - 0.5).abs() < 1e-6);
        assert!(smoothed.value_at([0.0, 0.0, 0.0]) < 1e-2 && smoothed.value_at([99.0, 0.0, 0.0]) > 0.99);
        let faces = borders(Team::alone(), &image);
        // The step, the end at x = 8, and of the half that is inside the sides.
        assert_eq!(faces.len(), 12 + 12 + 2 * 4 * 3 + 2 * 4 * 4);
        assert_eq!(faces.iter().filter(|p| p[0] == 3.5).count(), 12);
        let odd = Image::new([2, 1, 1], frame, Kind::Float, [1.0, f64::NAN]);
        assert_eq!(Smoothed::new(Team::alone(), &odd, 1.0).err(), Some(1));
    }
}
