//! The oracle: in which region of the image a point lies, and where a segment crosses a surface.
//!
//! Voxels stand for points at their centres. Between them a grey image is trilinear; of labels each has the trilinear weight of its
//! voxels, and the greatest wins (at a tie the lower label). Around the image lies a layer of outside, so that a region which touches the
//! border ends there.
use super::frame::Frame;
use super::nrrd::Image;
use crate::mesh::vector::{Vec3, distance, lerp};

/// The surface is found to this part of the least distance between voxels.
const RESOLUTION: f64 = 1e-4;

/// Why an image is no domain.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum DomainError {
    #[error("holds floating-point values, not labels; say with --isovalue above which value is inside")]
    NoIsovalue,
    #[error("voxel ({0}, {1}, {2}) has the value {3}, which is no finite number; replace it")]
    NotFinite(usize, usize, usize, f64),
    #[error(
        "voxel ({0}, {1}, {2}) has the label {3}; a reference in a mesh is at most 2147483647: renumber the labels"
    )]
    LabelTooGreat(usize, usize, usize, f64),
    #[error("has more than 65535 labels; is it a grey image? then say with --isovalue above which value is inside")]
    ManyLabels,
    #[error("has no voxel inside: all labels are 0")]
    NoLabel,
    #[error("has no voxel inside: the greatest value is {0}; give a smaller --isovalue")]
    NothingAbove(f64),
}

/// The values at the voxels, with a layer outside around them.
enum Field {
    /// Index of the region.
    Labels(Vec<u16>),
    /// Value above the isovalue.
    Grey(Vec<f32>),
}

/// A domain of regions. Region 0 is outside.
pub struct Domain {
    frame: Frame,
    /// Voxels along each axis, with the layer outside.
    padded: [usize; 3],
    field: Field,
    references: Vec<i32>,
    /// A box around the image.
    pub low: Vec3,
    /// Its other corner.
    pub high: Vec3,
}

impl Domain {
    /// The labels of an image, or what is above the isovalue.
    ///
    /// # Errors
    /// When the values cannot be used so, or nothing is inside.
    pub fn new(image: &Image, isovalue: Option<f64>) -> Result<Self, DomainError> {
        let padded = image.sizes.map(|size| size + 2);
        let (field, references) = match isovalue {
            None if !image.kind.is_integer() => return Err(DomainError::NoIsovalue),
            None => labels(image, padded)?,
            Some(isovalue) => (grey(image, padded, isovalue)?, vec![0, 1]),
        };
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for corner in 0..8 {
            let index = std::array::from_fn(|i| if corner >> i & 1 == 0 { -1.0 } else { image.sizes[i] as f64 });
            let p = image.frame.point(index);
            low = std::array::from_fn(|i| low[i].min(p[i]));
            high = std::array::from_fn(|i| high[i].max(p[i]));
        }
        Ok(Self { frame: image.frame, padded, field, references, low, high })
    }

    /// The reference of a region.
    pub fn reference(&self, region: u16) -> i32 {
        self.references[region as usize]
    }

    /// Number of regions, outside included.
    pub fn regions(&self) -> usize {
        self.references.len()
    }

    /// Where the voxels lie.
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// Voxels along each axis, with the layer outside.
    pub fn padded(&self) -> [usize; 3] {
        self.padded
    }

    /// The centre of a voxel, counted with the layer outside.
    pub fn voxel_centre(&self, voxel: usize) -> Vec3 {
        let [x, y, _] = self.padded;
        let index = [voxel % x, voxel / x % y, voxel / (x * y)];
        self.frame.point(index.map(|i| i as f64 - 1.0))
    }

    /// The region of a voxel, counted with the layer outside.
    #[inline]
    pub fn voxel_region(&self, voxel: usize) -> u16 {
        match &self.field {
            Field::Labels(labels) => labels[voxel],
            Field::Grey(values) => u16::from(values[voxel] > 0.0),
        }
    }

    /// The region that a point lies in.
    #[inline]
    pub fn region(&self, p: Vec3) -> u16 {
        let index = self.frame.index(p);
        let (mut first, mut part) = ([0usize; 3], [0.0; 3]);
        for i in 0..3 {
            let at = index[i] + 1.0;
            // The negation catches NaN.
            if !(at >= 0.0 && at < (self.padded[i] - 1) as f64) {
                return 0;
            }
            first[i] = at as usize;
            part[i] = at - first[i] as f64;
        }
        let [x, y, _] = self.padded;
        let voxel = first[0] + x * (first[1] + y * first[2]);
        let corners = [0, 1, x, x + 1, x * y, x * y + 1, x * y + x, x * y + x + 1].map(|step| voxel + step);
        match &self.field {
            Field::Labels(labels) => heaviest(corners.map(|corner| labels[corner]), part),
            Field::Grey(values) => {
                let v = corners.map(|corner| f64::from(values[corner]));
                let along = |a: f64, b: f64, i: usize| a + part[i] * (b - a);
                let layer = |k: usize| along(along(v[k], v[k + 1], 0), along(v[k + 2], v[k + 3], 0), 1);
                u16::from(along(layer(0), layer(4), 2) > 0.0)
            }
        }
    }

    /// Where a segment leaves the region of `from`; that of `to` is another one.
    pub fn crossing(&self, (from, region): (Vec3, u16), (to, other): (Vec3, u16)) -> Vec3 {
        debug_assert_ne!(region, other);
        // The search starts in the greater region, which is not outside. So the point is the same whichever end comes first.
        let (inside, region, outside) = if region > other { (from, region, to) } else { (to, other, from) };
        let mut ends = [inside, self.clip(inside, outside)];
        let resolution = RESOLUTION * self.least_spacing();
        while distance(ends[0], ends[1]) > resolution {
            let middle = lerp(ends[0], ends[1], 0.5);
            let end = usize::from(self.region(middle) != region);
            if ends[end] == middle {
                break;
            }
            ends[end] = middle;
        }
        lerp(ends[0], ends[1], 0.5)
    }

    /// The least distance between voxels.
    pub fn least_spacing(&self) -> f64 {
        self.frame.spacings().into_iter().fold(f64::INFINITY, f64::min)
    }

    /// The geometric mean of the distances between voxels.
    pub fn mean_spacing(&self) -> f64 {
        self.frame.spacings().iter().product::<f64>().cbrt()
    }

    /// The end of a segment that begins in the box about the image, or where it leaves that box.
    fn clip(&self, from: Vec3, to: Vec3) -> Vec3 {
        let mut share: f64 = 1.0;
        for i in 0..3 {
            let step = to[i] - from[i];
            let bound = if step > 0.0 { self.high[i] } else { self.low[i] };
            if step.abs() > (bound - from[i]).abs() {
                share = share.min((bound - from[i]) / step);
            }
        }
        lerp(from, to, share)
    }
}

/// Of the labels at the corners of a cell the one with the greatest trilinear weight.
#[inline]
fn heaviest(labels: [u16; 8], part: Vec3) -> u16 {
    if labels.iter().all(|&label| label == labels[0]) {
        return labels[0];
    }
    let [x, y, z] = part.map(|part| [1.0 - part, part]);
    let weights: [f64; 8] = std::array::from_fn(|corner| x[corner & 1] * y[corner >> 1 & 1] * z[corner >> 2]);
    let (mut best, mut most) = (labels[0], -1.0);
    for candidate in labels {
        let mut sum = 0.0;
        for corner in 0..8 {
            sum += if labels[corner] == candidate { weights[corner] } else { 0.0 };
        }
        if sum > 0.5 {
            return candidate;
        }
        if sum > most || sum == most && candidate < best {
            (best, most) = (candidate, sum);
        }
    }
    best
}

/// Where in the image a voxel is.
fn place(image: &Image, voxel: usize) -> [usize; 3] {
    let [x, y, _] = image.sizes;
    [voxel % x, voxel / x % y, voxel / (x * y)]
}

/// Index of a voxel with the layer outside.
fn padded_index(image: &Image, padded: [usize; 3], voxel: usize) -> usize {
    let [i, j, k] = place(image, voxel);
    (i + 1) + padded[0] * ((j + 1) + padded[1] * (k + 1))
}

fn labels(image: &Image, padded: [usize; 3]) -> Result<(Field, Vec<i32>), DomainError> {
    let mut found = std::collections::BTreeSet::from([0]);
    for voxel in 0..image.len() {
        let value = image.value(voxel);
        if value > f64::from(i32::MAX) {
            let [i, j, k] = place(image, voxel);
            return Err(DomainError::LabelTooGreat(i, j, k, value));
        }
        if found.insert(value as i32) && found.len() > usize::from(u16::MAX) + 1 {
            return Err(DomainError::ManyLabels);
        }
    }
    let mut references: Vec<i32> = found.into_iter().collect();
    if references.len() == 1 {
        return Err(DomainError::NoLabel);
    }
    // Outside comes first, whatever the signs.
    let zero = references.iter().position(|&reference| reference == 0).unwrap_or(0);
    references[..=zero].rotate_right(1);
    let mut regions = vec![0; padded.iter().product()];
    for voxel in 0..image.len() {
        let reference = image.value(voxel) as i32;
        if reference != 0 {
            let region = match references[1..=zero].binary_search(&reference) {
                Ok(at) => at + 1,
                Err(_) => zero + 1 + references[zero + 1..].partition_point(|&other| other < reference),
            };
            regions[padded_index(image, padded, voxel)] = region as u16;
        }
    }
    Ok((Field::Labels(regions), references))
}

fn grey(image: &Image, padded: [usize; 3], isovalue: f64) -> Result<Field, DomainError> {
    let mut greatest = f64::NEG_INFINITY;
    for voxel in 0..image.len() {
        let value = image.value(voxel);
        if !value.is_finite() {
            let [i, j, k] = place(image, voxel);
            return Err(DomainError::NotFinite(i, j, k, value));
        }
        greatest = greatest.max(value);
    }
    if greatest <= isovalue {
        return Err(DomainError::NothingAbove(greatest));
    }
    // Beyond any value that matters, and no sum of eight overflows.
    let most = f64::from(f32::MAX) / 16.0;
    let above = |at: [usize; 3]| {
        let [x, y, _] = image.sizes;
        (image.value(at[0] + x * (at[1] + y * at[2])) - isovalue).clamp(-most, most) as f32
    };
    let mut values = Vec::with_capacity(padded.iter().product());
    for voxel in 0..padded.iter().product() {
        let [x, y, _] = padded;
        let index = [voxel % x, voxel / x % y, voxel / (x * y)];
        let inside: [usize; 3] = std::array::from_fn(|i| index[i].clamp(1, image.sizes[i]));
        let value = above(inside.map(|i| i - 1));
        // A voxel beyond the border is as far outside as the border's is inside, so the surface is where the voxel ends.
        values.push(if inside == index { value } else { -value.abs() });
    }
    Ok(Field::Grey(values))
}
