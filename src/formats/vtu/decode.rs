//! The values of a .vtu's arrays: words, base64 or bytes, compressed or not. Source: VTK's wiki, "VTK XML Formats": before binary data
//! stands its size; before compressed data the number of blocks, their size, that of the last (0 for a whole one), and what each takes.
use super::super::error;
use super::super::scan::real_or_nan;
use super::xml::{Array, Document, Kind, Place};
use crate::mesh::io::{Error, number};
use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use flate2::read::ZlibDecoder;
use std::borrow::Cow;
use std::cell::{Cell, RefCell};
use std::collections::BTreeSet;
use std::io::Read;
use std::path::Path;

/// Reads base64 with or without padding.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::Indifferent)
        .with_decode_allow_trailing_bits(true),
);

/// Is asked whether there may be so many values.
type Check<'c> = &'c dyn Fn(usize) -> Result<(), Error>;

/// Decodes the arrays of a document, each once. So no more memory is needed than deflate can pack into the file (1032 bytes a byte).
pub(super) struct Decoder<'d, 'a> {
    path: &'d Path,
    document: &'d Document<'a>,
    /// Where arrays begin in the appended data.
    offsets: BTreeSet<usize>,
    decoded: RefCell<BTreeSet<usize>>,
}

impl<'d, 'a> Decoder<'d, 'a> {
    pub fn new(path: &'d Path, document: &'d Document<'a>) -> Self {
        let of_piece = |piece: &'d super::xml::Piece<'a>| {
            let lists = [&piece.coordinates, &piece.topology, &piece.point_data, &piece.cell_data];
            lists.into_iter().flatten()
        };
        let arrays = document.pieces.iter().flat_map(of_piece).chain(&document.field_data);
        let offsets = arrays.filter_map(|array| match array.place {
            Place::Appended(offset) => Some(offset),
            _ => None,
        });
        Self { path, document, offsets: offsets.collect(), decoded: RefCell::default() }
    }

    /// An error at an array.
    pub fn fail(&self, array: &Array, message: impl Into<String>) -> Error {
        error::at(self.path, format!("array {}", error::short(&array.name)), message)
    }

    /// Whole numbers; as many as `items` of the array's width.
    pub fn ints(&self, array: &Array<'a>, items: usize) -> Result<Vec<i64>, Error> {
        let values = self.ints_of(array, &|count| self.counted(array, items, count))?;
        self.counted(array, items, values.len()).map(|()| values)
    }

    /// Whole numbers, as many as there are; none where there are more than `most`.
    pub fn few_ints(&self, array: &Array<'a>, most: usize) -> Result<Option<Vec<i64>>, Error> {
        let is_long = Cell::new(false);
        let check = |count: usize| {
            is_long.set(count > most);
            if count > most { Err(self.fail(array, "there are too many values")) } else { Ok(()) }
        };
        match self.ints_of(array, &check) {
            Err(_) if is_long.get() => Ok(None),
            values => values.map(Some),
        }
    }

    /// Whole numbers; `check` is asked how many there may be before they are unpacked.
    fn ints_of(&self, array: &Array<'a>, check: Check<'_>) -> Result<Vec<i64>, Error> {
        Ok(match (array.place, array.kind) {
            (_, Kind::Real(_) | Kind::Other) => return Err(self.fail(array, "whole numbers are expected")),
            (Place::Text(text), _) => self.words(array, text, number::parse_int)?,
            (_, kind) => {
                let bytes = self.bytes(array, check)?;
                match kind {
                    Kind::Int(1) => bytes.iter().map(|&byte| (byte as i8).into()).collect(),
                    Kind::Int(2) => self.numbers(&bytes, |b| i16::from_ne_bytes(b).into()),
                    Kind::Int(4) => self.numbers(&bytes, |b| i32::from_ne_bytes(b).into()),
                    Kind::Unsigned(1) => bytes.iter().map(|&byte| byte.into()).collect(),
                    Kind::Unsigned(2) => self.numbers(&bytes, |b| u16::from_ne_bytes(b).into()),
                    Kind::Unsigned(4) => self.numbers(&bytes, |b| u32::from_ne_bytes(b).into()),
                    // Numbers beyond what fits are wrong as indices and as references, negative too.
                    _ => self.numbers(&bytes, i64::from_ne_bytes),
                }
            }
        })
    }

    /// Numbers; as many as `items` of the array's width.
    pub fn reals(&self, array: &Array<'a>, items: usize) -> Result<Vec<f64>, Error> {
        let values = match (array.place, array.kind) {
            (Place::Text(text), Kind::Real(_)) => self.words(array, text, real_or_nan)?,
            (_, Kind::Real(size)) => {
                let bytes = self.bytes(array, &|count| self.counted(array, items, count))?;
                match size {
                    4 => self.numbers(&bytes, |b| f32::from_ne_bytes(b).into()),
                    _ => self.numbers(&bytes, f64::from_ne_bytes),
                }
            }
            _ => self.ints(array, items)?.into_iter().map(|value| value as f64).collect(),
        };
        self.counted(array, items, values.len()).map(|()| values)
    }

    fn counted(&self, array: &Array, items: usize, values: usize) -> Result<(), Error> {
        if Some(values) == items.checked_mul(array.width) {
            return Ok(());
        }
        Err(self.fail(array, format!("{values} values; {} at each of {items} are expected", array.width)))
    }

    fn words<T>(&self, array: &Array, text: &str, parse: impl Fn(&[u8]) -> Result<T, String>) -> Result<Vec<T>, Error> {
        let words = text.split_ascii_whitespace();
        words.map(|word| parse(word.as_bytes()).map_err(|message| self.fail(array, message))).collect()
    }

    /// Numbers in this machine's order of bytes.
    fn numbers<T, const N: usize>(&self, bytes: &[u8], of: impl Fn([u8; N]) -> T) -> Vec<T> {
        let swap = self.document.is_big_endian != cfg!(target_endian = "big");
        let number = |&(mut chunk): &[u8; N]| {
            if swap {
                chunk.reverse();
            }
            of(chunk)
        };
        bytes.as_chunks::<N>().0.iter().map(number).collect()
    }

    /// The bytes of an array's values.
    fn bytes(&self, array: &Array<'a>, check: Check<'_>) -> Result<Cow<'a, [u8]>, Error> {
        let stored = match array.place {
            Place::Base64(text) => Cow::Owned(self.base64(array, text.as_bytes())?),
            Place::Appended(offset) => self.appended(array, offset)?,
            Place::Text(_) => unreachable!("words are no bytes"),
        };
        if self.document.is_compressed {
            return self.inflated(array, &stored, check).map(Cow::Owned);
        }
        if stored.is_empty() {
            return Ok(stored); // an array without values may have no header either
        }
        let header = self.document.header;
        let size = self.header(array, &stored, 0)?;
        let end = size.checked_add(header).filter(|&end| end <= stored.len());
        let end =
            end.ok_or_else(|| self.fail(array, format!("{size} bytes are said to follow, and the data ends before")))?;
        Ok(match stored {
            Cow::Borrowed(bytes) => Cow::Borrowed(&bytes[header..end]),
            Cow::Owned(mut bytes) => {
                bytes.truncate(end);
                bytes.drain(..header);
                Cow::Owned(bytes)
            }
        })
    }

    fn appended(&self, array: &Array, offset: usize) -> Result<Cow<'a, [u8]>, Error> {
        let (data, is_base64) = self
            .document
            .appended
            .ok_or_else(|| self.fail(array, "it is appended, and there is no AppendedData; the file was cut"))?;
        if !self.decoded.borrow_mut().insert(offset) {
            return Err(self.fail(array, "another array has the same data; write each of them"));
        }
        let rest =
            data.get(offset..).ok_or_else(|| self.fail(array, "its data is behind the end of the file; it was cut"))?;
        if !is_base64 {
            return Ok(Cow::Borrowed(rest));
        }
        let next = self.offsets.range(offset + 1..).next().map_or(rest.len(), |next| next - offset);
        let part = &rest[..next.min(rest.len())];
        let end = part.iter().position(|&byte| byte == b'<').unwrap_or(part.len());
        self.base64(array, &part[..end]).map(Cow::Owned)
    }

    /// Base64; header and data may be encoded one by one, so that padding stands within.
    fn base64(&self, array: &Array, text: &[u8]) -> Result<Vec<u8>, Error> {
        let text: Vec<u8> = text.iter().copied().filter(|byte| !byte.is_ascii_whitespace()).collect();
        let mut bytes = Vec::with_capacity(text.len() / 4 * 3 + 3);
        let mut rest = &text[..];
        while !rest.is_empty() {
            let data = rest.iter().position(|&byte| byte == b'=').unwrap_or(rest.len());
            let padding = rest[data..].iter().take_while(|&&byte| byte == b'=').count();
            BASE64
                .decode_vec(&rest[..data], &mut bytes)
                .map_err(|error| self.fail(array, format!("no base64 ({error})")))?;
            rest = &rest[data + padding..];
        }
        Ok(bytes)
    }

    /// A number of the header.
    fn header(&self, array: &Array, bytes: &[u8], index: usize) -> Result<usize, Error> {
        let size = self.document.header;
        let cut = || self.fail(array, "its data ends within the header; the file was cut");
        let start = index.checked_mul(size).ok_or_else(cut)?;
        let bytes = bytes.get(start..).and_then(|rest| rest.get(..size)).ok_or_else(cut)?;
        let value = match size {
            4 => self.numbers(bytes, u32::from_ne_bytes)[0].into(),
            _ => self.numbers(bytes, u64::from_ne_bytes)[0],
        };
        usize::try_from(value).map_err(|_| cut())
    }

    fn inflated(&self, array: &Array, stored: &[u8], check: Check<'_>) -> Result<Vec<u8>, Error> {
        if stored.is_empty() {
            return Ok(Vec::new());
        }
        let blocks = self.header(array, stored, 0)?;
        let cut = || self.fail(array, "its compressed data ends too early; the file was cut");
        let start =
            blocks.checked_add(3).and_then(|numbers| numbers.checked_mul(self.document.header)).ok_or_else(cut)?;
        let mut rest = stored.get(start..).ok_or_else(cut)?;
        if blocks == 0 {
            return Ok(Vec::new());
        }
        let (size, last) = (self.header(array, stored, 1)?, self.header(array, stored, 2)?);
        let all_but_last = size.saturating_mul(blocks - 1);
        check(all_but_last.saturating_add(if last > 0 { last } else { size }) / array.kind.size())?;
        let mut all = Vec::new();
        for block in 0..blocks {
            let wanted = if block + 1 == blocks && last > 0 { last } else { size };
            let stored = self.header(array, stored, 3 + block)?;
            let (here, behind) = rest.split_at_checked(stored).ok_or_else(cut)?;
            let before = all.len();
            let limit = u64::try_from(wanted).unwrap_or(u64::MAX);
            let read = ZlibDecoder::new(here).take(limit).read_to_end(&mut all);
            read.map_err(|error| {
                self.fail(array, format!("block {} is damaged ({error}); write the file again", block + 1))
            })?;
            if all.len() - before != wanted {
                return Err(self.fail(
                    array,
                    format!("block {} has {} bytes; {wanted} are expected", block + 1, all.len() - before),
                ));
            }
            rest = behind;
        }
        Ok(all)
    }
}
