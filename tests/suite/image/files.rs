//! NRRD files: all kinds and encodings are read as they were written, and what is wrong in a file is told with its place and the remedy.
use crate::common::adapting::{Workplace, complaint};
use crate::common::program;
use geo_adapt::image::{Encoding, Frame, Image, Kind, read, write};
use std::path::Path;

const ENCODINGS: [Encoding; 3] = [Encoding::Raw, Encoding::Gzip, Encoding::Text];

fn sample(kind: Kind) -> Image {
    let frame = Frame::new([0.1, -2.0, 3.5], [[0.5, 0.0, 0.1], [0.0, -1.25, 0.0], [0.0, 0.3, 2.0]]).unwrap();
    let values = (0..4 * 3 * 5).map(|n| match kind {
        Kind::Uint8 => f64::from(n * 4),
        Kind::Int8 => f64::from(n * 4 - 120),
        Kind::Int16 => f64::from(n * 1000 - 30_000),
        Kind::Uint16 => f64::from(n * 1000 + 5000),
        Kind::Int32 => f64::from(n) * 70_000_000.0 - 2_100_000_000.0,
        Kind::Uint32 => f64::from(n) * 70_000_000.0,
        Kind::Float => f64::from(0.1_f32) * f64::from(n - 30),
        Kind::Double => 0.1 * f64::from(n - 30) + 1e-300,
    });
    Image::new([4, 3, 5], frame, kind, values)
}

#[test]
fn what_is_written_is_read() {
    let work = Workplace::new();
    for kind in Kind::ALL {
        for encoding in ENCODINGS {
            // With the voxels behind the header, and beside it.
            for name in ["a.nrrd", "a.nhdr"] {
                let (path, image) = (work.path(name), sample(kind));
                write(&path, &image, encoding).unwrap();
                assert_eq!(read(&path).unwrap(), image, "{kind:?} {encoding:?} {name}");
            }
        }
    }
}

/// A header of these fields, and the voxels.
fn file(fields: &[&str], voxels: &[u8]) -> Vec<u8> {
    let mut file = format!("NRRD0004\n{}\n\n", fields.join("\n")).into_bytes();
    file.extend_from_slice(voxels);
    file
}

fn read_bytes(bytes: &[u8]) -> Image {
    let work = Workplace::new();
    std::fs::write(work.path("a.nrrd"), bytes).unwrap();
    read(&work.path("a.nrrd")).unwrap()
}

#[test]
fn both_byte_orders_are_read() {
    for (endian, bytes) in [("big", [1, 2, 0, 3]), ("little", [2, 1, 3, 0])] {
        let endian = format!("endian: {endian}");
        let image = read_bytes(&file(
            &["type: unsigned short", "dimension: 3", "sizes: 2 1 1", "encoding: raw", &endian],
            &bytes,
        ));
        assert_eq!([image.value(0), image.value(1)], [258.0, 3.0]);
    }
    let double = 1.5_f64.to_be_bytes();
    let image =
        read_bytes(&file(&["type: double", "dimension: 3", "sizes: 1 1 1", "encoding: raw", "endian: big"], &double));
    assert_eq!(image.value(0), 1.5);
}

#[test]
fn headers_are_written_in_many_ways() {
    let fields = [
        "# a comment",
        "Type: uchar",
        "dimension: 3",
        "sizes: 2 1 2",
        "encoding: ascii",
        "my key:=my: value",
        "spacings: 0.5 1 2",
        "kinds: domain domain domain",
        "content: anything",
        "space units: \"mm\" \"mm\" \"mm\"",
        "axis mins: nan nan nan",
    ];
    let image = read_bytes(&file(&fields, b"1, 2\n3\t4"));
    assert_eq!((0..4).map(|n| image.value(n)).collect::<Vec<_>>(), [1.0, 2.0, 3.0, 4.0]);
    assert_eq!(image.frame.spacings(), [0.5, 1.0, 2.0]);
    // Lines that end as on Windows.
    let text = String::from_utf8(file(&fields, b"1 2 3 4")).unwrap().replace('\n', "\r\n");
    assert_eq!(read_bytes(text.as_bytes()), image);
}

#[test]
fn what_lies_before_the_voxels_is_passed_over() {
    let common = ["type: uint8", "dimension: 3", "sizes: 2 1 1", "encoding: raw"];
    for (skips, voxels) in [
        (vec!["line skip: 2"], &b"one\ntwo\n\x05\x06"[..]),
        (vec!["byte skip: 3"], b"abc\x05\x06"),
        (vec!["lineskip: 1", "byteskip: 1"], b"one\n.\x05\x06"),
        (vec!["byte skip: -1"], b"whatever\x05\x06"),
    ] {
        let image = read_bytes(&file(&[&common[..], &skips].concat(), voxels));
        assert_eq!([image.value(0), image.value(1)], [5.0, 6.0], "{skips:?}");
    }
}

/// The error of a file, by the program.
fn refusal(work: &Workplace, path: &Path, arguments: &[&str]) -> String {
    let output = work.path("out.meshb");
    let run = program().arg("image-mesh").arg(path).arg("-o").arg(&output).args(arguments).output().unwrap();
    let message = complaint(&run);
    assert!(!output.exists());
    message
}

fn says(message: &str, parts: &[&str]) {
    for part in parts {
        assert!(message.contains(part), "'{part}' is not in: {message}");
    }
}

/// A file that is right but for the fields given, which come in the place of their like, or are taken out where they have no value.
fn refusal_of(changes: &[&str], voxels: &[u8]) -> String {
    let mut fields = vec!["type: int16", "dimension: 3", "sizes: 2 2 1", "encoding: raw", "endian: little"];
    for &change in changes {
        let name = change.split(':').next().unwrap();
        fields.retain(|field| field.split(':').next() != Some(name));
        if !change.ends_with(':') {
            fields.push(change);
        }
    }
    let work = Workplace::new();
    let path = work.path("bad.nrrd");
    std::fs::write(&path, file(&fields, voxels)).unwrap();
    refusal(&work, &path, &[])
}

#[test]
fn a_wrong_header_is_told_with_its_line() {
    let eight = [1, 0, 1, 0, 1, 0, 1, 0];
    for (change, parts) in [
        ("type: int64", &["line 6", "'int64' is not supported", "convert"][..]),
        ("type: block", &["line 6", "'block'"]),
        ("type:", &["without the field 'type'", "add it"]),
        ("dimension: 4", &["line 6", "dimension 4", "one channel"]),
        ("dimension: 2", &["line 6", "dimension 2"]),
        ("sizes: 2 2", &["line 6", "'2 2'", "three positive"]),
        ("sizes: 2 0 2", &["line 6", "three positive"]),
        ("sizes: 2 -1 2", &["line 6", "three positive"]),
        ("sizes: 4000000000 4000000000 4000000000", &["line 6", "more than any memory"]),
        ("encoding: bzip2", &["line 6", "'bzip2'", "raw, gzip or text"]),
        ("encoding: hex", &["line 6", "'hex'"]),
        ("endian: middle", &["line 6", "'middle'", "little or big"]),
        ("endian:", &["without the field 'endian'"]),
        ("spacings: 1 0 1", &["line 7", "three positive"]),
        ("spacings: 1 nan 1", &["line 7", "three positive"]),
        ("spacings: 1 1", &["line 7", "three positive"]),
        ("space directions: (1,0,0) (0,1,0) (1,1,0)", &["line 7", "span space"]),
        ("space directions: (1,0,0) none (0,0,1)", &["line 7", "three vectors"]),
        ("space dimension: 2", &["line 7", "only 3"]),
        ("axis mins: 0 0 0", &["line 7", "space origin"]),
        ("byte skip: many", &["line 7", "whole number"]),
        ("data file: LIST", &["line 7", "several are not supported"]),
        ("data file: %03d.raw 1 10 1", &["line 7", "several are not supported"]),
        ("data file: nowhere.raw", &["nowhere.raw", "No such file"]),
        ("colour: red", &["line 7", "'colour' is not known", ":="]),
        ("no field at all", &["line 7", "is no field", "comment"]),
    ] {
        let message = refusal_of(&[change], &eight);
        says(&message, parts);
        assert!(message.contains("bad.nrrd") || message.contains("nowhere.raw"), "{message}");
    }
    let origin = refusal_of(&["space directions: (1,0,0) (0,1,0) (0,0,1)", "space origin: (1,2)"], &eight);
    says(&origin, &["line 8", "space origin"]);
    says(&refusal_of(&["Sizes: 2 2 1"], &eight), &["line 7", "the field of line 4 again"]);
}

#[test]
fn cut_and_damaged_voxels_are_told() {
    says(&refusal_of(&[], &[1, 0, 1, 0, 1]), &["bad.nrrd", "5 of 8 bytes", "cut"]);
    says(&refusal_of(&["sizes: 100000 100000 1000"], &[1, 0]), &["2 of 20000000000000 bytes"]);
    says(&refusal_of(&["byte skip: 100"], &[1, 0]), &["0 of 8 bytes"]);
    says(&refusal_of(&["line skip: 3"], b"one\ntwo"), &["3 lines of 'line skip'"]);
    says(&refusal_of(&["encoding: text"], b"1 2 3"), &["3 of 4 values", "cut"]);
    says(&refusal_of(&["encoding: text"], b"1 2 3 4 5"), &["more than the 4 values"]);
    says(&refusal_of(&["encoding: text"], b"1 2 three 4"), &["value 3 is 'three'"]);
    says(&refusal_of(&["encoding: text"], b"1 2 40000 4"), &["value 3 is '40000'", "int16"]);
    says(&refusal_of(&["encoding: text"], b"1 2 0.5 4"), &["value 3 is '0.5'", "int16"]);
    says(&refusal_of(&["encoding: gzip"], b"no gzip here"), &["is not whole gzip"]);
    // Whole, and then cut at every length.
    let work = Workplace::new();
    let path = work.path("cut.nrrd");
    write(&path, &sample(Kind::Uint8), Encoding::Gzip).unwrap();
    let whole = std::fs::read(&path).unwrap();
    // The sum at the end of a gzip stream is not looked at once all voxels are there.
    for length in 0..whole.len() - 12 {
        std::fs::write(&path, &whole[..length]).unwrap();
        let message = read(&path).expect_err("a cut file").to_string();
        assert!(message.contains("cut.nrrd"), "{message}");
    }
}

#[test]
fn what_is_no_image_is_told() {
    let work = Workplace::new();
    let path = work.path("a.nrrd");
    for bytes in [&b""[..], b"PNG", b"NRRD0009\n", b"NRRD00041\n", b"\xff\xfe\n"] {
        std::fs::write(&path, bytes).unwrap();
        says(&refusal(&work, &path, &[]), &["a.nrrd", "line 1", "not NRRD"]);
    }
    std::fs::write(&path, b"NRRD0004\ntype: int8\n\xff\xfe\n").unwrap();
    says(&refusal(&work, &path, &[]), &["line 3", "empty line"]);
    says(&refusal(&work, &work.path("missing.nrrd"), &[]), &["missing.nrrd", "No such file"]);
}

#[test]
fn values_that_make_no_domain_are_told() {
    let work = Workplace::new();
    let path = work.path("a.nrrd");
    let frame = Frame::of_spacings([1.0; 3]).unwrap();
    let refused = |kind: Kind, values: [f64; 2], arguments: &[&str]| {
        write(&path, &Image::new([2, 1, 1], frame, kind, values), Encoding::Raw).unwrap();
        refusal(&work, &path, arguments)
    };
    says(&refused(Kind::Float, [1.0, 2.0], &[]), &["a.nrrd", "not labels", "--isovalue"]);
    says(&refused(Kind::Float, [1.0, f64::NAN], &["--isovalue", "0"]), &["voxel (1, 0, 0)", "NaN"]);
    says(&refused(Kind::Double, [f64::INFINITY, 1.0], &["--isovalue", "0"]), &["voxel (0, 0, 0)", "inf"]);
    says(&refused(Kind::Float, [1.0, 2.0], &["--isovalue", "2"]), &["greatest value is 2", "smaller --isovalue"]);
    says(&refused(Kind::Uint8, [0.0, 0.0], &[]), &["all labels are 0"]);
    says(&refused(Kind::Uint32, [1.0, 4e9], &[]), &["voxel (1, 0, 0)", "4000000000", "renumber"]);
    says(&refused(Kind::Uint8, [1.0, 1.0], &["--size", "1e-4"]), &["at least"]);
    says(&refused(Kind::Uint8, [1.0, 1.0], &["--surface-distance", "1e-3"]), &["at least"]);
    says(&refused(Kind::Uint8, [1.0, 1.0], &["--size", "-1"]), &["--size"]);
    says(&refused(Kind::Uint8, [1.0, 1.0], &["--radius-edge", "0.5"]), &["would not end"]);
    says(&refused(Kind::Uint8, [1.0, 1.0], &["--isovalue", "nan"]), &["finite"]);
    says(&refused(Kind::Uint8, [1.0, 1.0], &["--threads", "0"]), &["--threads"]);
}

#[test]
fn outputs_are_looked_at_before_the_work() {
    let work = Workplace::new();
    let path = work.path("a.nrrd");
    write(&path, &sample(Kind::Uint8), Encoding::Raw).unwrap();
    let before = std::fs::read(&path).unwrap();
    let run = |output: &Path, arguments: &[&str]| {
        complaint(&program().arg("image-mesh").arg(&path).arg("-o").arg(output).args(arguments).output().unwrap())
    };
    says(&run(&work.path("out.xyz"), &[]), &["out.xyz", "these are: .mesh, .meshb"]);
    says(&run(&work.path("no/out.mesh"), &[]), &["there is no folder"]);
    let image = path.to_str().unwrap();
    says(&run(&work.path("out.mesh"), &["--report", image]), &["would be overwritten"]);
    assert_eq!(std::fs::read(&path).unwrap(), before);
}
