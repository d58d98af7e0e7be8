//! Images in NRRD files (teem's "nearly raw raster data"): a text header, then the voxels, here or in a file of their own.
mod data;
mod header;
mod write;

use super::frame::Frame;
use crate::mesh::io::{Error, check_regular, read_file};
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

pub use write::write;

/// What a voxel holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names say it")]
pub enum Kind {
    Int8,
    Uint8,
    Int16,
    Uint16,
    Int32,
    Uint32,
    Float,
    Double,
}

/// How voxels are written in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names say it")]
pub enum Encoding {
    Raw,
    Gzip,
    Text,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 8] =
        [Self::Int8, Self::Uint8, Self::Int16, Self::Uint16, Self::Int32, Self::Uint32, Self::Float, Self::Double];

    /// Bytes of a voxel.
    pub fn size(self) -> usize {
        match self {
            Self::Int8 | Self::Uint8 => 1,
            Self::Int16 | Self::Uint16 => 2,
            Self::Int32 | Self::Uint32 | Self::Float => 4,
            Self::Double => 8,
        }
    }

    /// Whether its values are whole numbers.
    pub fn is_integer(self) -> bool {
        !matches!(self, Self::Float | Self::Double)
    }

    /// As headers spell it, the spelling that is written first.
    fn names(self) -> &'static [&'static str] {
        match self {
            Self::Int8 => &["int8", "int8_t", "signed char"],
            Self::Uint8 => &["uint8", "uint8_t", "uchar", "unsigned char"],
            Self::Int16 => &["int16", "int16_t", "short", "short int", "signed short", "signed short int"],
            Self::Uint16 => &["uint16", "uint16_t", "ushort", "unsigned short", "unsigned short int"],
            Self::Int32 => &["int32", "int32_t", "int", "signed int"],
            Self::Uint32 => &["uint32", "uint32_t", "uint", "unsigned int"],
            Self::Float => &["float"],
            Self::Double => &["double"],
        }
    }
}

/// A 3D image.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Voxels along each axis; the first axis is the fastest in memory.
    pub sizes: [usize; 3],
    /// Where they lie.
    pub frame: Frame,
    /// What a voxel holds.
    pub kind: Kind,
    /// The voxels, least significant byte first.
    bytes: Vec<u8>,
}

impl Image {
    /// An image whose voxels are those values, rounded to what the kind holds.
    ///
    /// # Panics
    /// When there are not as many values as the sizes say.
    pub fn new(sizes: [usize; 3], frame: Frame, kind: Kind, values: impl IntoIterator<Item = f64>) -> Self {
        let mut bytes = Vec::with_capacity(sizes.iter().product::<usize>() * kind.size());
        values.into_iter().for_each(|value| data::push(&mut bytes, kind, value));
        assert_eq!(bytes.len(), sizes.iter().product::<usize>() * kind.size(), "a value for each voxel");
        Self { sizes, frame, kind, bytes }
    }

    /// Number of voxels.
    pub fn len(&self) -> usize {
        self.sizes.iter().product()
    }

    /// Whether there is no voxel: never so in an image that was read.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The value of a voxel, counted in the order of memory; exact for all kinds.
    pub fn value(&self, voxel: usize) -> f64 {
        data::value(&self.bytes, self.kind, voxel)
    }
}

/// Reads .nrrd or .nhdr, attached or detached.
///
/// # Errors
/// [`Error::System`] when a file cannot be read, [`Error::Content`] when what it says cannot be true or is not supported.
pub fn read(path: &Path) -> Result<Image, Error> {
    let file = read_file(path)?;
    let (header, rest) = header::parse(path, &file)?;
    let bytes = data::read(path, &header, &file[rest..])?;
    Ok(Image { sizes: header.sizes, frame: header.frame, kind: header.kind, bytes })
}

/// Bytes in which a header ends.
const LONGEST_HEADER: u64 = 1 << 20;

/// The file that holds the voxels of an image, where it is another; none too where there is no image to read.
pub fn data_file(path: &Path) -> Option<PathBuf> {
    check_regular(path).ok()?;
    let mut head = Vec::new();
    File::open(path).ok()?.take(LONGEST_HEADER).read_to_end(&mut head).ok()?;
    header::parse(path, &head).ok()?.0.data_file
}

/// An error at a place of a file.
fn content(path: &Path, place: impl Into<String>, message: impl Into<String>) -> Error {
    Error::Content { path: path.into(), place: place.into(), message: message.into() }
}
