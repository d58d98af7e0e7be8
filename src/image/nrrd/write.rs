//! Writing an image.
use super::{Encoding, Image, Kind};
use crate::mesh::io::{Batch, Error, write_beside};
use flate2::Compression;
use flate2::write::GzEncoder;
use std::fmt::Write as _;
use std::io::{self, Write};
use std::path::Path;

/// Writes an image: with the voxels behind the header, or, when the path ends in .nhdr, in a file beside it.
///
/// # Errors
/// [`Error::System`] when a file cannot be written.
pub fn write(path: &Path, image: &Image, encoding: Encoding) -> Result<(), Error> {
    let mut header = header(image, encoding);
    if path.extension().is_none_or(|extension| extension != "nhdr") {
        return write_beside(path, |file| {
            file.write_all(header.as_bytes())?;
            file.write_all(b"\n")?;
            voxels(file, image, encoding)
        });
    }
    let data = path.with_extension(match encoding {
        Encoding::Raw => "raw",
        Encoding::Gzip => "raw.gz",
        Encoding::Text => "txt",
    });
    let _ = writeln!(header, "data file: {}", data.file_name().unwrap_or_default().display());
    let mut batch = Batch::new();
    batch.add(&data, |file| voxels(file, image, encoding))?;
    batch.add_main(path, |file| file.write_all(header.as_bytes()))?;
    batch.commit()
}

fn header(image: &Image, encoding: Encoding) -> String {
    let [x, y, z] = image.sizes;
    let encoding = match encoding {
        Encoding::Raw => "raw",
        Encoding::Gzip => "gzip",
        Encoding::Text => "text",
    };
    let vector = |[x, y, z]: [f64; 3]| format!("({x:?},{y:?},{z:?})");
    let kind = image.kind.names()[0];
    let [a, b, c] = image.frame.axes.map(vector);
    let origin = vector(image.frame.origin);
    format!(
        "NRRD0004\ntype: {kind}\ndimension: 3\nsizes: {x} {y} {z}\nspace dimension: 3\n\
         space directions: {a} {b} {c}\nspace origin: {origin}\nendian: little\nencoding: {encoding}\n"
    )
}

fn voxels(mut file: &mut dyn Write, image: &Image, encoding: Encoding) -> io::Result<()> {
    match encoding {
        Encoding::Raw => file.write_all(&image.bytes),
        Encoding::Gzip => {
            let mut gzip = GzEncoder::new(&mut file, Compression::default());
            gzip.write_all(&image.bytes)?;
            gzip.finish().map(|_| ())
        }
        Encoding::Text => (0..image.len()).try_for_each(|voxel| {
            let value = image.value(voxel);
            // As few digits as lead back to the same number of that kind.
            if image.kind == Kind::Float { writeln!(file, "{}", value as f32) } else { writeln!(file, "{value}") }
        }),
    }
}
