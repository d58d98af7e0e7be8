//! Datasets of HDF5 files, by the crate hdf5-pure: what XDMF and CGNS stand on. A damaged file can announce any size, so no more is
//! read than deflate can have packed into the file.
use super::error;
use crate::mesh::io::Error;
use hdf5_pure::{AttrValue, DType, Dataset, Group};
use std::cell::Cell;
use std::fmt::Display;
use std::path::{Path, PathBuf};

/// The first bytes of a file.
pub(super) const MAGIC: &[u8] = b"\x89HDF\r\n\x1a\n";

/// Bytes that deflate can make of one.
const DEFLATED: usize = 1032;

/// A file that is read.
pub(super) struct Hdf5 {
    path: PathBuf,
    file: hdf5_pure::File,
    /// Bytes that may still be read.
    left: Cell<usize>,
}

/// A dataset that is there, and not read yet.
pub(super) struct Array<'h> {
    of: &'h Hdf5,
    dataset: Dataset,
    at: String,
    /// The number of values, and whether all are whole.
    pub count: usize,
    pub is_whole: bool,
    /// As the file has it, the index that changes fastest last.
    pub shape: Vec<usize>,
}

impl Hdf5 {
    /// Of the bytes of a file.
    pub fn of_bytes(path: &Path, bytes: Vec<u8>) -> Result<Self, Error> {
        if !bytes.starts_with(MAGIC) {
            return Err(error::at(path, "byte 0", "no HDF5 file"));
        }
        let left = Cell::new(bytes.len().saturating_mul(DEFLATED));
        let file = hdf5_pure::File::from_bytes(bytes);
        let file = file.map_err(|error| error::at(path, "the head", damaged(&error)))?;
        Ok(Self { path: path.to_owned(), file, left })
    }

    /// An error at a place.
    pub fn fail(&self, at: &str, message: impl Into<String>) -> Error {
        error::at(&self.path, error::short(at), message)
    }

    /// The outermost group.
    pub fn root(&self) -> Group {
        self.file.root()
    }

    /// The dataset of a path.
    pub fn array(&self, at: &str) -> Result<Array<'_>, Error> {
        let dataset = self.file.dataset(at).map_err(|error| self.fail(at, damaged(&error)))?;
        self.array_of(at, dataset)
    }

    /// A dataset of numbers; `at` is what errors say.
    pub fn array_of(&self, at: &str, dataset: Dataset) -> Result<Array<'_>, Error> {
        let wrong = |error| self.fail(at, damaged(&error));
        let shape = dataset.shape().map_err(wrong)?;
        let shape: Option<Vec<usize>> = shape.into_iter().map(|length| usize::try_from(length).ok()).collect();
        let is_whole = match dataset.dtype().map_err(wrong)? {
            DType::F32 | DType::F64 => false,
            DType::I8 | DType::I16 | DType::I32 | DType::I64 => true,
            DType::U8 | DType::U16 | DType::U32 | DType::U64 => true,
            _ => return Err(self.fail(at, "numbers are expected")),
        };
        let counted = shape.and_then(|shape| Some((bytes_of(&shape, 1)?, shape)));
        let (count, shape) = counted.ok_or_else(|| self.fail(at, "its shape is beyond all bounds"))?;
        Ok(Array { of: self, dataset, at: at.to_owned(), count, is_whole, shape })
    }

    /// Texts of characters, as CGNS has them: bytes or whole numbers.
    pub fn text(&self, at: &str, dataset: Dataset) -> Result<String, Error> {
        let array = self.array_of(at, dataset)?;
        array.spend()?;
        let bytes = array.dataset.read_u8().map_err(|error| self.fail(at, damaged(&error)))?;
        let text = String::from_utf8_lossy(&bytes);
        Ok(text.trim_end_matches(['\0', ' ']).to_owned())
    }
}

impl Array<'_> {
    /// Its values.
    pub fn reals(&self) -> Result<Vec<f64>, Error> {
        self.spend()?;
        self.dataset.read_f64().map_err(|error| self.of.fail(&self.at, damaged(&error)))
    }

    /// Its values, which are whole.
    pub fn ints(&self) -> Result<Vec<i64>, Error> {
        if !self.is_whole {
            return Err(self.of.fail(&self.at, "whole numbers are expected"));
        }
        self.spend()?;
        self.dataset.read_i64().map_err(|error| self.of.fail(&self.at, damaged(&error)))
    }

    /// Takes its bytes from those that may be read.
    fn spend(&self) -> Result<(), Error> {
        let wrong = |error| self.of.fail(&self.at, damaged(&error));
        let size = usize::try_from(self.dataset.element_size().map_err(wrong)?).unwrap_or(usize::MAX);
        let chunk = self.dataset.chunk_shape().map_err(wrong)?.unwrap_or_default();
        let chunk: Vec<usize> = chunk.into_iter().map(|length| usize::try_from(length).unwrap_or(usize::MAX)).collect();
        let [all, of_chunk] = [&self.shape, &chunk].map(|shape| bytes_of(shape, size).unwrap_or(usize::MAX));
        let left = self.of.left.get();
        if all > left || of_chunk > left {
            let message = format!("{} values are announced, more than the file can hold; it is damaged", self.count);
            return Err(self.of.fail(&self.at, message));
        }
        self.of.left.set(left - all);
        Ok(())
    }
}

/// A text that an attribute of a group is.
pub(super) fn attribute(group: &Group, name: &str) -> Option<String> {
    let attributes = group.attrs().ok()?;
    Some(attributes.get(name).and_then(AttrValue::as_str)?.trim_end_matches(['\0', ' ']).to_owned())
}

/// What is wrong, as the crate says it.
pub(super) fn damaged(error: &dyn Display) -> String {
    let text: String = error.to_string().chars().take(160).flat_map(char::escape_debug).collect();
    format!("it cannot be read ({text})")
}

fn bytes_of(shape: &[usize], size: usize) -> Option<usize> {
    shape.iter().try_fold(size, |count, &length| count.checked_mul(length))
}
