//! VTK's files in all the ways that data can be stored.
use crate::sample::{Place, is_of_both, labels, read, refusal};
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use flate2::write::ZlibEncoder;
use std::io::Write;

/// How data is stored.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Store {
    Ascii,
    Inline { zlib: bool },
    Raw { zlib: bool },
    Base64 { zlib: bool },
}

const STORES: [Store; 7] = [
    Store::Ascii,
    Store::Inline { zlib: false },
    Store::Inline { zlib: true },
    Store::Raw { zlib: false },
    Store::Raw { zlib: true },
    Store::Base64 { zlib: false },
    Store::Base64 { zlib: true },
];

/// A writer of the format by its documentation: two tetrahedra, a triangle, a line and a point.
struct Grid {
    store: Store,
    big: bool,
    long: bool,
    appended: Vec<u8>,
}

impl Grid {
    fn number(&self, value: u64, size: usize) -> Vec<u8> {
        if self.big { value.to_be_bytes()[8 - size..].to_vec() } else { value.to_le_bytes()[..size].to_vec() }
    }

    fn header(&self, values: &[usize]) -> Vec<u8> {
        values.iter().flat_map(|&value| self.number(value as u64, if self.long { 8 } else { 4 })).collect()
    }

    /// Header and data, compressed in blocks of 32 bytes.
    fn packed(&self, bytes: &[u8], zlib: bool) -> [Vec<u8>; 2] {
        if !zlib {
            return [self.header(&[bytes.len()]), bytes.to_vec()];
        }
        let blocks: Vec<Vec<u8>> = bytes
            .chunks(32)
            .map(|block| {
                let mut encoder = ZlibEncoder::new(Vec::new(), flate2::Compression::default());
                encoder.write_all(block).unwrap();
                encoder.finish().unwrap()
            })
            .collect();
        let sizes =
            [blocks.len(), 32, bytes.len() % 32].into_iter().chain(blocks.iter().map(Vec::len)).collect::<Vec<_>>();
        [self.header(&sizes), blocks.concat()]
    }

    fn array(&mut self, kind: &str, name: &str, width: usize, values: &[f64]) -> String {
        let mut bytes = Vec::new();
        for &value in values {
            bytes.extend(match kind {
                "Float64" => self.number(value.to_bits(), 8),
                "Float32" => self.number((value as f32).to_bits().into(), 4),
                "Int64" => self.number(value as i64 as u64, 8),
                "Int32" => self.number(value as i32 as u32 as u64, 4),
                _ => self.number(value as u64, 1),
            });
        }
        let open = format!("<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{width}\" RangeMin=\"0\"");
        let (format, text) = match self.store {
            Store::Ascii => ("format=\"ascii\"".into(), values.iter().map(|v| format!(" {v}\n")).collect()),
            Store::Inline { zlib } => {
                let parts = self.packed(&bytes, zlib);
                // Header and data are one stream where nothing is compressed, by VTK; by others they are two.
                let text = if zlib {
                    parts.map(|part| BASE64_STANDARD.encode(part)).concat()
                } else {
                    BASE64_STANDARD.encode(parts.concat())
                };
                ("format=\"binary\"".into(), format!("\n  {text}\n"))
            }
            Store::Raw { zlib } => {
                let offset = self.appended.len();
                let parts = self.packed(&bytes, zlib).concat();
                self.appended.extend(parts);
                (format!("format=\"appended\" offset=\"{offset}\""), String::new())
            }
            Store::Base64 { zlib } => {
                let offset = self.appended.len();
                let text = self.packed(&bytes, zlib).map(|part| BASE64_STANDARD.encode(part)).concat();
                self.appended.extend(text.bytes());
                (format!("format=\"appended\" offset=\"{offset}\""), String::new())
            }
        };
        // VTK tells the range of vectors so.
        let information = "<InformationKey name=\"L2_NORM_RANGE\" location=\"vtkDataArray\" length=\"2\"><Value index=\"0\"> 1.5 </Value></InformationKey>";
        format!("{open} {format}>{text}{information}</DataArray>\n")
    }

    fn file(store: Store, big: bool, long: bool) -> Vec<u8> {
        let mut grid = Self { store, big, long, appended: Vec::new() };
        let mut text = String::from(
            "<?xml version=\"1.0\"?>\n<!-- a comment --><VTKFile type=\"UnstructuredGrid\" version=\"1.0\"",
        );
        text += if big { " byte_order=\"BigEndian\"" } else { " byte_order=\"LittleEndian\"" };
        text += if long { " header_type=\"UInt64\"" } else { "" };
        let zlib =
            [Store::Inline { zlib: true }, Store::Raw { zlib: true }, Store::Base64 { zlib: true }].contains(&store);
        text += if zlib { " compressor=\"vtkZLibDataCompressor\"" } else { "" };
        text += ">\n<UnstructuredGrid>\n<FieldData>\n";
        text += &grid.array("Int32", "w&amp;ng", 2, &[7.0, 2.0, 8.0, 2.0]);
        text += &grid.array("Float64", "TimeValue", 1, &[0.5]);
        text += "</FieldData>\n<Piece NumberOfPoints='5' NumberOfCells='5'>\n<PointData Scalars=\"p\">\n";
        text += &grid.array("Float32", "p", 1, &[1.0, 2.0, 3.0, 4.0, 5.5]);
        text += &grid.array("Float64", "S", 6, &(0..30).map(f64::from).collect::<Vec<_>>());
        text += &grid.array("Float64", "flat", 2, &(0..10).map(f64::from).collect::<Vec<_>>());
        text += &grid.array("Int64", "ids", 1, &[9.0, 8.0, 7.0, 6.0, 5.0]);
        text += "</PointData>\n<CellData>\n";
        text += &grid.array("Float64", "q", 1, &[1.0, 4.0, 100.0, 100.0, 100.0]);
        text += &grid.array("Float64", "p", 1, &[7.0; 5]);
        text += &grid.array("Int32", "medit:ref", 1, &[1.0, 2.0, -7.0, 9.0, 0.0]);
        text += "</CellData>\n<Points>\n";
        let points = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, -2.0];
        text += &grid.array("Float64", "Points", 3, &points);
        text += "</Points>\n<Cells>\n";
        let nodes = [0.0, 1.0, 2.0, 3.0, 0.0, 2.0, 1.0, 4.0, 0.0, 1.0, 2.0, 0.0, 1.0, 3.0];
        text += &grid.array("Int64", "connectivity", 1, &nodes);
        text += &grid.array("Int64", "offsets", 1, &[4.0, 8.0, 11.0, 13.0, 14.0]);
        text += &grid.array("UInt8", "types", 1, &[10.0, 10.0, 5.0, 3.0, 1.0]);
        text += "</Cells>\n</Piece>\n</UnstructuredGrid>\n";
        let mut bytes = text.into_bytes();
        if !grid.appended.is_empty() {
            let encoding = if matches!(store, Store::Raw { .. }) { "raw" } else { "base64" };
            bytes.extend(format!("<AppendedData encoding=\"{encoding}\">\n   _").into_bytes());
            bytes.extend(&grid.appended);
            bytes.extend(b"\n</AppendedData>\n");
        }
        bytes.extend(b"</VTKFile>\n");
        bytes
    }
}

#[test]
fn data_is_read_however_it_is_stored() {
    let place = Place::new();
    for store in STORES {
        for (big, long) in [(false, false), (false, true), (true, false)] {
            let path = place.text("a.vtu", Grid::file(store, big, long));
            let data = read(&path);
            let mesh = &data.mesh;
            assert_eq!((mesh.vertices.len(), mesh.vertices[4]), (5, [0.0, 0.0, -2.0]), "{store:?}");
            assert_eq!((&mesh.tets.nodes[..], &mesh.tets.refs[..]), (&[[0, 1, 2, 3], [0, 2, 1, 4]][..], &[1, 2][..]));
            assert_eq!((mesh.triangles.nodes[0], mesh.triangles.refs[0], mesh.edges.refs[0]), ([0, 1, 2], -7, 9));
            assert_eq!(data.names.triangles, labels(&[(7, "w&ng"), (8, "w&ng")]));
            let names: Vec<_> = data.fields.iter().map(|field| field.name.as_str()).collect();
            assert_eq!(names, ["p", "S", "flat", "q"]);
            assert_eq!(data.fields[0].values, [1.0, 2.0, 3.0, 4.0, 5.5]);
            // XX YY ZZ XY YZ XZ is what VTK has.
            assert_eq!(data.fields[1].values[..6], [0.0, 3.0, 1.0, 5.0, 4.0, 2.0]);
            assert_eq!(data.fields[2].values[..6], [0.0, 1.0, 0.0, 2.0, 3.0, 0.0]);
            assert!(is_of_both(&data.fields[3].values, true), "{:?}", data.fields[3]);
        }
    }
}

#[test]
fn what_is_wrong_is_named() {
    let file = String::from_utf8(Grid::file(Store::Ascii, false, false)).unwrap();
    let with = |from: &str, to: &str| {
        assert!(file.contains(from), "{from}");
        refusal("a.vtu", file.replacen(from, to, 1))
    };
    assert!(
        with(" 10\n 10\n 5\n", " 11\n 10\n 5\n")
            .starts_with("cell 1 of 5: a cell of type 11 (voxel): tetrahedra, prisms")
    );
    assert!(with(" 10\n 10\n 5\n", " 12\n 10\n 5\n").starts_with("cell 1 of 5: a cell of type 12 with 4 points"));
    assert!(with(" 10\n 10\n 5\n", " 5\n 10\n 5\n").starts_with("cell 1 of 5: a cell of type 5 with 4 points"));
    assert!(with(" 4\n 8\n 11\n", " 8\n 4\n 11\n").starts_with("cell 1 of 5: a cell of type 10 with 8 points"));
    assert!(
        with(" 11\n 13\n 14\n", " 11\n 13\n 99999999999\n")
            .starts_with("array connectivity: 14 values; 1 at each of 99999999999")
    );
    assert!(with("NumberOfPoints='5'", "NumberOfPoints='6'").starts_with("array Points: 15 values; 3 at each of 6"));
    assert!(with("NumberOfPoints='5'", "").contains("NumberOfPoints is missing"));
    assert!(with("NumberOfPoints='5'", "NumberOfPoints='x'").contains("NumberOfPoints=\"x\" is no count"));
    assert!(with("type=\"UnstructuredGrid\"", "type=\"PolyData\"").contains("line 2: a file of type PolyData"));
    assert!(
        with("\" version=\"1.0\"", "\" compressor=\"vtkLZ4DataCompressor\"")
            .contains("write it with ZLib, or not compressed")
    );
    assert!(with("</Cells>", "</Cell>").contains("no XML as VTK writes it"));
    assert!(refusal("a.vtu", file.replace("Piece", "Other")).contains("there is no Piece"));
    assert!(with("Name=\"types\"", "Name=\"kinds\"").contains("the array types is missing"));
    assert!(
        with("format=\"ascii\"", "format=\"appended\" offset=\"7\"")
            .contains("it is appended, and there is no AppendedData")
    );
    assert!(refusal("a.vtu", "").contains("there is no Piece"));

    let raw = Grid::file(Store::Raw { zlib: true }, false, true);
    let start = raw.windows(2).position(|part| part == b" _").unwrap() + 2;
    // 65535 blocks are said to be there.
    let mut lying = raw.clone();
    lying[start..start + 2].fill(255);
    assert!(refusal("a.vtu", &lying).starts_with("array w&ng: its compressed data ends too early; the file was cut"));
    for end in 0..raw.len() - 40 {
        refusal("a.vtu", &raw[..end]);
    }
}

/// As ParaView writes what several processes had, with an empty piece and data that one of them has not.
#[test]
fn pieces_are_joined() {
    let array = |kind: &str, name: &str, width: usize, values: &str| {
        format!("<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{width}\">{values}</DataArray>")
    };
    let piece = |at: f64, more: &str| {
        let points = format!("{at} 0 0 {} 0 0 {at} 1 0 {at} 0 1", at + 1.0);
        format!(
            "<Piece NumberOfPoints=\"4\" NumberOfCells=\"1\"><PointData>{}{more}</PointData><CellData/><Points>{}</Points><Cells>{}{}{}</Cells></Piece>",
            array("Float32", "p", 1, &format!("{at} 2 3 4")),
            array("Float32", "", 3, &points),
            array("Int32", "connectivity", 1, "0 1 2 3"),
            array("Int32", "offsets", 1, "4"),
            array("UInt8", "types", 1, "10"),
        )
    };
    let only = array("Float32", "only", 1, "1 2 3 4");
    let empty =
        "<Piece NumberOfPoints=\"0\" NumberOfCells=\"0\"><PointData></PointData><Points/><Cells></Cells></Piece>";
    let [first, second] = [piece(0.0, &only), piece(5.0, "")];
    let text = format!(
        "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid>{first}{empty}{second}</UnstructuredGrid></VTKFile>"
    );
    let place = Place::new();
    let found = geo_adapt::formats::read(&place.text("a.vtu", text)).unwrap();
    assert_eq!(found.content.mesh.tets.nodes, [[0, 1, 2, 3], [4, 5, 6, 7]]);
    assert_eq!(found.content.mesh.vertices[4], [5.0, 0.0, 0.0]);
    assert_eq!(found.content.fields.len(), 1);
    assert_eq!(found.content.fields[0].values, [0.0, 2.0, 3.0, 4.0, 5.0, 2.0, 3.0, 4.0]);
    assert!(
        found.notices.iter().any(|notice| notice.contains("the array only is not in all pieces")),
        "{:?}",
        found.notices
    );
}

/// A grid of four points whose array of points or, if `wide`, of values at them claims so many bytes; the compressed data is none.
fn claiming(bytes: u32, wide: Option<u32>) -> String {
    let header: Vec<u8> = [1, bytes, 0, 7].iter().flat_map(|number: &u32| number.to_le_bytes()).collect();
    let data = BASE64_STANDARD.encode([&header[..], b"no zlib"].concat());
    let lying = |name: &str, width: u32| {
        format!(
            "<DataArray type=\"Float64\" Name=\"{name}\" NumberOfComponents=\"{width}\" format=\"binary\">{data}</DataArray>"
        )
    };
    let points = match wide {
        None => lying("xyz", 3),
        Some(_) => {
            "<DataArray type=\"Float64\" Name=\"xyz\" NumberOfComponents=\"3\">0 0 0 1 0 0 0 1 0 0 0 1</DataArray>"
                .into()
        }
    };
    let values = wide.map_or(String::new(), |width| lying("u", width));
    format!(
        "<VTKFile type=\"UnstructuredGrid\" compressor=\"vtkZLibDataCompressor\"><UnstructuredGrid>\
         <Piece NumberOfPoints=\"4\" NumberOfCells=\"0\"><PointData>{values}</PointData><Points>{points}</Points></Piece>\
         </UnstructuredGrid></VTKFile>"
    )
}

#[test]
fn four_points_that_claim_half_a_gigabyte_are_refused_before_it_is_unpacked() {
    // Unpacking would find that the data is none.
    let told = refusal("a.vtu", claiming(512 << 20, None));
    assert_eq!(told, "array xyz: 67108864 values; 3 at each of 4 are expected");
    assert!(refusal("a.vtu", claiming(96, None)).contains("damaged"));
    // Values that fit the points, and are too many for a field: it is left out as it is.
    let place = Place::new();
    let found = geo_adapt::formats::read(&place.text("a.vtu", claiming(512 << 20, Some(16 << 20)))).unwrap();
    assert_eq!((found.content.mesh.vertices.len(), found.content.fields.len()), (4, 0));
    assert_eq!(found.notices, ["the array u has 16777216 values an item and is left out"]);
}
