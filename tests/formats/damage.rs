//! Damaged files: whatever the bytes, data that can be written again or an error that names the file; never a crash, and no more memory
//! than the file can hold.
use crate::sample::{Place, dataset};
use geo_adapt::formats::{self, Dataset, Format};
use geo_adapt::mesh::samples::of_all_kinds;
use proptest::prelude::Rng;
use proptest::test_runner::{RngAlgorithm, TestRng};
use std::alloc::{GlobalAlloc, Layout, System};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// Counts the bytes that this process has taken at once.
struct Counting;

static NOW: AtomicUsize = AtomicUsize::new(0);
static MOST: AtomicUsize = AtomicUsize::new(0);

// SAFETY: hands over to the system's allocator, which keeps the contract.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let now = NOW.fetch_add(layout.size(), Relaxed) + layout.size();
        MOST.fetch_max(now, Relaxed);
        // SAFETY: as our caller's.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        NOW.fetch_sub(layout.size(), Relaxed);
        // SAFETY: as our caller's.
        unsafe { System.dealloc(at, layout) }
    }
}

#[global_allocator]
static MEMORY: Counting = Counting;

/// What a reader may take at most for these files of some kilobytes. A count of a file that is believed would take gigabytes.
const MOST_BYTES: usize = 64 << 20;

/// Mutations of the files of a format together: enough for every run, or as many as are asked for.
fn mutations(files: usize) -> usize {
    let asked = std::env::var("GEO_ADAPT_MUTATIONS").ok().and_then(|text| text.parse().ok());
    asked.unwrap_or(2000_usize).div_ceil(files)
}

/// Parts of files that mean something, which make better damage than any bytes.
const TELLING: &[&[u8]] = &[
    b"0",
    b"-1",
    b"1",
    b"4294967296",
    b"99999999999999999999",
    b"-9223372036854775808",
    b"2147483647",
    b"nan",
    b"1e999",
    b"\n",
    b" ",
    b"=",
    b"\"",
    b"<",
    b">",
    b"/>",
    b"</",
    b"&",
    b"$",
    b"%",
    b",",
    b"_",
    b"\0",
    b"\xff\xff\xff\xff",
    b"\xff\xff\xff\x7f",
    b"\x7f\xff\xff\xff",
    b"\0\0\0\0\0\0\0\x80",
    b"\x01\0\0\0",
    b"ascii",
    b"binary",
    b"appended",
    b"$Nodes",
    b"*ELEMENT, TYPE=C3D4",
    b"*ELSET, ELSET=a",
    b", GENERATE",
    b"CTETRA  ",
    b"GRID,",
    b"\n+",
    b"CELLS ",
    b"POINT_DATA ",
    b"FIELD a ",
    b"METADATA\n",
    b"$Elements",
    b"$EndNodes",
    b"NPOIN= ",
    b"NELEM= ",
    b"MARKER_TAG= ",
    b"MARKER_ELEMS= ",
    b"NDIME= ",
    b"<DataArray ",
    b"</DataArray>",
    b"<Piece ",
    b"<Grid>",
    b"</Grid>",
    b"<DataItem Format=\"HDF\">",
    b"Temporal",
    b"offset=\"",
    b"nonuniform",
    b"List<scalar>",
    b"nFaces",
    b"format",
    b"(",
    b"}",
    b";",
    b"/*",
    b"\xc3",
];

/// Changes bytes, puts telling parts in or over others, takes parts out, repeats them, cuts.
fn damaged(valid: &[u8], random: &mut TestRng) -> Vec<u8> {
    let mut bytes = valid.to_vec();
    let mut below = |limit: usize| (random.next_u64() % limit.max(1) as u64) as usize;
    // Most of the structure is in the head of a file and, for texts, in its words.
    for _ in 0..1 + below(4) {
        if bytes.is_empty() {
            break;
        }
        let length = bytes.len();
        let at = if below(2) == 0 { below(length) } else { below(length.min(600)) };
        match below(7) {
            0 => bytes[at] ^= 1 << below(8),
            1 => bytes[at] = below(256) as u8,
            2 => {
                let part = TELLING[below(TELLING.len())];
                let end = (at + part.len()).min(length);
                bytes[at..end].copy_from_slice(&part[..end - at]);
            }
            3 => {
                bytes.splice(at..at, TELLING[below(TELLING.len())].iter().copied());
            }
            4 => {
                let end = (at + 1 + below(40)).min(length);
                bytes.drain(at..end);
            }
            5 => {
                let end = (at + 1 + below(200)).min(length);
                let part = bytes[at..end].to_vec();
                let to = below(length);
                bytes.splice(to..to, part);
            }
            _ if below(4) == 0 => bytes.truncate(at),
            _ => {
                // A number becomes another one.
                if let Some(digit) = (at..length).find(|&at| bytes[at].is_ascii_digit()) {
                    bytes[digit] = b'0' + below(10) as u8;
                }
            }
        }
    }
    bytes
}

/// Files of a format, by their names.
fn seeds(names: &[(&str, bool)]) -> Vec<(String, Vec<u8>)> {
    let mut data = dataset();
    data.names.triangles.remove(&11);
    seeds_of(&data, names)
}

/// The same of a mesh with cells of all kinds.
fn stacked(names: &[(&str, bool)]) -> Vec<(String, Vec<u8>)> {
    let (mut mesh, mut stack) = of_all_kinds();
    stack.join(&mut mesh).unwrap();
    seeds_of(&Dataset { mesh, stack, ..Dataset::default() }, names)
}

fn seeds_of(data: &Dataset, names: &[(&str, bool)]) -> Vec<(String, Vec<u8>)> {
    let place = Place::new();
    let written = names.iter().map(|&(name, text)| {
        let (path, _) = place.write(name, data, text);
        (name.to_owned(), std::fs::read(path).unwrap())
    });
    written.collect()
}

/// The files of other programs whose names begin so.
fn foreign(start: &str) -> Vec<(String, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/formats");
    let mut found: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.file_name().unwrap().to_str().unwrap().starts_with(start))
        .map(|path| (path.file_name().unwrap().to_str().unwrap().to_owned(), std::fs::read(&path).unwrap()))
        .filter(|(name, _)| Format::of(Path::new(name)).is_ok())
        .collect();
    found.sort();
    assert!(!found.is_empty());
    found
}

/// Damages each file and reads it; what is read must be good enough to be written.
fn survive(files: Vec<(String, Vec<u8>)>, read: impl Fn(&Path, &[u8]) -> Option<Dataset>) {
    let rounds = mutations(files.len());
    for (name, valid) in files {
        let path = Path::new(&name);
        assert!(read(path, &valid).is_some(), "{name} is no valid file");
        let mut random = TestRng::from_seed(RngAlgorithm::ChaCha, &[7; 32]);
        let mut good = 0;
        for round in 0..rounds {
            let bytes = damaged(&valid, &mut random);
            let before = NOW.load(Relaxed);
            MOST.store(before, Relaxed);
            let found = read(path, &bytes);
            // Other tests run at the same time and take some too.
            let taken = MOST.load(Relaxed).saturating_sub(before);
            assert!(taken < MOST_BYTES, "{name}, mutation {round}: {taken} bytes were taken for {}", bytes.len());
            let Some(data) = found else { continue };
            good += 1;
            let vertices = data.mesh.vertices.len();
            let nodes = data.mesh.tets.nodes.as_flattened().iter().chain(data.mesh.triangles.nodes.as_flattened());
            assert!(
                nodes.chain(data.mesh.edges.nodes.as_flattened()).all(|&v| (v as usize) < vertices),
                "{name}, mutation {round}"
            );
            assert!(data.mesh.vertices.as_flattened().iter().all(|x| x.is_finite()), "{name}, mutation {round}");
            assert_eq!((data.mesh.vertex_refs.len(), data.mesh.tets.refs.len()), (vertices, data.mesh.tets.len()));
            assert_eq!(
                (data.mesh.triangles.refs.len(), data.mesh.edges.refs.len()),
                (data.mesh.triangles.len(), data.mesh.edges.len())
            );
            for field in &data.fields {
                assert_eq!(field.values.len(), vertices * field.kind.values(), "{name}, mutation {round}");
                assert!(field.values.iter().all(|x| x.is_finite()), "{name}, mutation {round}");
            }
        }
        // Damage that no file survives, or that all do, tests nothing.
        let share = good as f64 / rounds as f64;
        assert!((0.002..0.98).contains(&share), "{name}: {good} of {} were read", rounds);
    }
}

/// Reads a mesh; an error must name the file.
fn mesh(path: &Path, bytes: &[u8]) -> Option<Dataset> {
    match formats::read_bytes(Format::of(path).unwrap(), path, bytes) {
        Ok(read) => Some(read.content),
        Err(error) => {
            let text = error.to_string();
            assert!(text.starts_with(&format!("{}: ", path.display())) && text.len() < 600, "{text}");
            None
        }
    }
}

#[test]
fn no_bytes_make_su2_panic() {
    survive(seeds(&[("a.su2", false)]), mesh);
}

#[test]
fn no_bytes_make_vtu_panic() {
    let by_vtk = foreign("vtk-").into_iter().filter(|(name, _)| name.ends_with("vtu")).collect();
    survive([seeds(&[("a.vtu", false), ("b.vtu", true)]), by_vtk].concat(), mesh);
}

#[test]
fn no_bytes_make_msh_panic() {
    let ours = seeds(&[("a.msh", false), ("b.msh", true), ("a.msh2", false), ("b.msh2", true)]);
    survive([ours, foreign("meshio-22.")].concat(), mesh);
}

#[test]
fn no_bytes_make_legacy_vtk_panic() {
    survive([seeds(&[("a.vtk", false), ("b.vtk", true)]), foreign("vtk-legacy")].concat(), mesh);
}

#[test]
fn no_bytes_make_xdmf_panic() {
    survive(seeds(&[("a.xdmf", true), ("a.xmf", true)]), mesh);
}

/// The XML and the arrays beside it, each damaged with the other whole.
#[test]
fn no_bytes_make_xdmf_with_its_arrays_panic() {
    let place = Place::new();
    let mut files = Vec::new();
    for (main, arrays) in [("a.xdmf", "a.h5"), ("b.xmf", "b.xmf.h5")] {
        place.write(main, &dataset(), false);
        files.extend([main.to_owned(), arrays.to_owned()]);
    }
    let files: Vec<_> =
        files.into_iter().map(|name| (name.clone(), std::fs::read(place.path(&name)).unwrap())).collect();
    let whole = files.clone();
    survive(files, |name, bytes| {
        let damaged = place.text(name.to_str().unwrap(), bytes);
        let main = if name.to_str().unwrap().starts_with('a') { "a.xdmf" } else { "b.xmf" };
        let read = formats::read(&place.path(main));
        let (_, valid) = whole.iter().find(|(file, _)| Path::new(file) == name).unwrap();
        std::fs::write(damaged, valid).unwrap();
        match read {
            Ok(read) => Some(read.content),
            Err(error) => {
                let text = error.to_string();
                assert!(text.starts_with(&*place.path("").to_string_lossy()) && text.len() < 600, "{text}");
                None
            }
        }
    });
}

#[test]
fn no_bytes_make_cgns_panic() {
    let names = [("a.cgns", false)];
    survive([seeds(&names), stacked(&names)].concat(), mesh);
}

#[test]
fn no_bytes_make_abaqus_panic() {
    survive([seeds(&[("a.inp", false)]), foreign("gmsh-")].concat(), mesh);
}

#[test]
fn no_bytes_make_nastran_panic() {
    survive(seeds(&[("a.bdf", false)]), mesh);
}

#[test]
fn no_bytes_make_ugrid_panic() {
    survive(seeds(&[("a.ugrid", false), ("a.b8.ugrid", false), ("a.lb8l.ugrid", false)]), mesh);
}

#[test]
fn no_bytes_make_libmeshb_panic() {
    let names = [("a.mesh", false), ("a.meshb", false)];
    survive([seeds(&names), stacked(&names)].concat(), mesh);
}

#[test]
fn no_bytes_make_fields_panic() {
    let bare = dataset();
    let place = Place::new();
    survive(seeds(&[("f.csv", false), ("f.dat", false), ("f.sol", false), ("f.solb", false)]), |path, bytes| {
        let mut data = Dataset { fields: Vec::new(), ..bare.clone() };
        let path = place.text(path.to_str().unwrap(), bytes);
        match formats::read_fields(&path, &mut data) {
            Ok(_) => Some(data),
            Err(error) => {
                assert!(error.to_string().starts_with(&format!("{}: ", path.display())), "{error}");
                None
            }
        }
    });
}

/// Each file of a case of OpenFOAM, the others whole beside it.
#[test]
fn no_bytes_make_openfoam_panic() {
    let place = Place::new();
    let mut files = Vec::new();
    for text in [true, false] {
        let case = if text { "text" } else { "binary" };
        place.write(&format!("{case}/"), &dataset(), text);
        for folder in ["constant/polyMesh", "0"] {
            for file in std::fs::read_dir(place.path(case).join(folder)).unwrap() {
                let path = file.unwrap().path();
                let name = path.strip_prefix(place.path("")).unwrap().to_str().unwrap().to_owned();
                files.push((name, std::fs::read(path).unwrap()));
            }
        }
    }
    // Points, faces, owner, neighbour, boundary, zones and four fields.
    assert_eq!(files.len(), 20);
    files.sort();
    let whole = files.clone();
    survive(files, |name, bytes| {
        let case = place.path(name.iter().next().unwrap().to_str().unwrap());
        std::fs::write(place.path(name.to_str().unwrap()), bytes).unwrap();
        let read = formats::read(&case);
        let (_, valid) = whole.iter().find(|(file, _)| Path::new(file) == name).unwrap();
        std::fs::write(place.path(name.to_str().unwrap()), valid).unwrap();
        match read {
            Ok(read) => Some(read.content),
            Err(error) => {
                let text = error.to_string();
                assert!(text.starts_with(&*case.to_string_lossy()) && text.len() < 600, "{text}");
                None
            }
        }
    });
}

/// The names that lie beside a grid.
#[test]
fn no_bytes_make_names_panic() {
    let place = Place::new();
    place.write("a.ugrid", &dataset(), false);
    let valid = std::fs::read(place.path("a.mapbc")).unwrap();
    survive(vec![("a.mapbc".into(), valid)], |_, bytes| {
        place.text("a.mapbc", bytes);
        formats::read(&place.path("a.ugrid")).ok().map(|read| read.content)
    });
}
