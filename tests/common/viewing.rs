//! Pages and pictures of `geo-adapt view`, read independently of the program.
use flate2::read::ZlibDecoder;
use serde_json::Value;
use std::collections::BTreeMap;
use std::io::Read;
use std::path::Path;

/// What a page holds, read independently of its program.
pub struct Page {
    /// All of it.
    pub text: String,
    /// What the program is told.
    pub head: Value,
    /// Rows of numbers by the names of the arrays.
    pub arrays: BTreeMap<String, Vec<Vec<u32>>>,
}

impl Page {
    /// From a file.
    pub fn read(path: &Path) -> Self {
        let text = std::fs::read_to_string(path).unwrap();
        let element = |open: &str| {
            let from = text.find(open).unwrap() + open.len();
            &text[from..from + text[from..].find("</script>").unwrap()]
        };
        let head: Value = serde_json::from_str(element(r#"<script id="head" type="application/json">"#)).unwrap();
        let data = element(r#"<script id="data" type="text/plain">"#);
        let mut bytes = Vec::new();
        for line in data.lines().filter(|line| !line.is_empty()) {
            ZlibDecoder::new(&decoded(line)[..]).read_to_end(&mut bytes).unwrap();
        }
        let mut rest = &bytes[..];
        let mut arrays = BTreeMap::new();
        for entry in head["arrays"].as_array().unwrap() {
            let number = |key: &str| entry[key].as_u64().unwrap() as usize;
            let (rows, columns) = (number("rows"), number("columns"));
            let width = match entry["kind"].as_str().unwrap() {
                "u8" => 1,
                "u16" => 2,
                _ => 4,
            };
            let (own, behind) = rest.split_at(rows * columns * width);
            rest = behind;
            let mut table = vec![vec![0; columns]; rows];
            for column in 0..columns {
                let mut before = 0u32;
                for row in 0..rows {
                    let byte = |rank: usize| u32::from(own[(column * width + rank) * rows + row]) << (8 * rank);
                    let mut word: u32 = (0..width).map(byte).sum();
                    if entry["delta"] == true {
                        let difference = if word & 1 == 0 { word >> 1 } else { !(word >> 1) };
                        before = before.wrapping_add(difference);
                        word = before;
                    }
                    table[row][column] = word;
                }
            }
            arrays.insert(entry["name"].as_str().unwrap().to_owned(), table);
        }
        assert!(rest.is_empty());
        Self { text, head, arrays }
    }

    /// Rows of an array of real numbers.
    pub fn reals(&self, name: &str) -> Vec<Vec<f64>> {
        let real = |bits: &u32| f64::from(f32::from_bits(*bits));
        self.arrays[name].iter().map(|row| row.iter().map(real).collect()).collect()
    }
}

fn decoded(line: &str) -> Vec<u8> {
    let value = |c: u8| match c {
        b'A'..=b'Z' => c - b'A',
        b'a'..=b'z' => c - b'a' + 26,
        b'0'..=b'9' => c - b'0' + 52,
        b'+' => 62,
        _ => 63,
    };
    let mut bytes = Vec::new();
    for four in line.as_bytes().chunks(4) {
        let letters: Vec<u8> = four.iter().copied().filter(|&c| c != b'=').collect();
        let word = letters.iter().fold(0u32, |word, &c| word << 6 | u32::from(value(c))) << (6 * (4 - letters.len()));
        bytes.extend(&word.to_be_bytes()[1..letters.len()]);
    }
    bytes
}

/// A picture: rows of pixels.
pub struct Picture {
    /// Pixels a row.
    pub width: usize,
    /// From the top left.
    pub pixels: Vec<[u8; 3]>,
}

impl Picture {
    /// From a file.
    pub fn read(path: &Path) -> Self {
        let file = std::io::BufReader::new(std::fs::File::open(path).unwrap());
        let mut reader = png::Decoder::new(file).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut bytes).unwrap();
        assert_eq!((info.color_type, info.bit_depth), (png::ColorType::Rgb, png::BitDepth::Eight));
        Self { width: info.width as usize, pixels: bytes.as_chunks().0.to_vec() }
    }

    /// A pixel.
    pub fn at(&self, x: usize, y: usize) -> [u8; 3] {
        self.pixels[y * self.width + x]
    }

    /// How many pixels are of such a colour.
    pub fn count(&self, is: impl Fn([i32; 3]) -> bool) -> usize {
        self.pixels.iter().filter(|pixel| is(pixel.map(i32::from))).count()
    }
}
