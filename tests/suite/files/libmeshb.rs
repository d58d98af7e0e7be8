//! A small mesh, and an encoder of libMeshb files for tests, independent of the library's own: any version, either byte order.

/// A value of a row.
#[derive(Clone, Copy, Debug)]
pub enum Value {
    Int(i64),
    Real(f64),
}

/// One keyword with its rows; `fields` are the types in a solution's header.
#[derive(Clone, Debug)]
pub struct Section {
    pub code: i32,
    pub name: &'static str,
    pub fields: Vec<i32>,
    pub rows: Vec<Vec<Value>>,
}

/// A section without fields; whole numbers of `rows` in the columns `reals` become reals.
pub fn section(code: i32, name: &'static str, reals: std::ops::Range<usize>, rows: &[&[f64]]) -> Section {
    let value = |(k, &x): (usize, &f64)| if reals.contains(&k) { Value::Real(x) } else { Value::Int(x as i64) };
    let rows = rows.iter().map(|row| row.iter().enumerate().map(value).collect()).collect();
    Section { code, name, fields: Vec::new(), rows }
}

/// A binary file of three dimensions.
pub fn binary(version: i32, big: bool, sections: &[Section]) -> Vec<u8> {
    let mut file = Binary { bytes: Vec::new(), version, big };
    file.put(&1_i32.to_be_bytes());
    file.put(&version.to_be_bytes());
    file.link(3, |file| file.put(&3_i32.to_be_bytes()));
    for section in sections {
        file.link(section.code, |file| {
            file.value(Value::Int(section.rows.len() as i64));
            if !section.fields.is_empty() {
                file.put(&(section.fields.len() as i32).to_be_bytes());
            }
            section.fields.iter().for_each(|kind| file.put(&kind.to_be_bytes()));
            section.rows.iter().flatten().for_each(|&value| file.value(value));
        });
    }
    file.put(&54_i32.to_be_bytes());
    file.put(&vec![0; file.position_size()]);
    file.bytes
}

struct Binary {
    bytes: Vec<u8>,
    version: i32,
    big: bool,
}

impl Binary {
    fn put(&mut self, big_endian: &[u8]) {
        let mut word = big_endian.to_vec();
        if !self.big {
            word.reverse();
        }
        self.bytes.extend(word);
    }

    fn position_size(&self) -> usize {
        if self.version < 3 { 4 } else { 8 }
    }

    fn value(&mut self, value: Value) {
        match value {
            Value::Int(i) if self.version < 4 => self.put(&(i as i32).to_be_bytes()),
            Value::Int(i) => self.put(&i.to_be_bytes()),
            Value::Real(x) if self.version < 2 => self.put(&(x as f32).to_be_bytes()),
            Value::Real(x) => self.put(&x.to_be_bytes()),
        }
    }

    /// A keyword, the position behind its body (known only then), and the body.
    fn link(&mut self, code: i32, body: impl FnOnce(&mut Self)) {
        self.put(&code.to_be_bytes());
        let (at, size) = (self.bytes.len(), self.position_size());
        self.bytes.extend(vec![0; size]);
        body(self);
        let mut next = Self { bytes: Vec::new(), ..*self };
        next.put(&(self.bytes.len() as u64).to_be_bytes()[8 - size..]);
        self.bytes[at..at + size].copy_from_slice(&next.bytes);
    }
}

/// The same as a text.
pub fn ascii(sections: &[Section]) -> String {
    let mut text = String::from("MeshVersionFormatted 2\nDimension\n3\n");
    for section in sections {
        text += &format!("\n{}\n{}\n", section.name, section.rows.len());
        if !section.fields.is_empty() {
            text += &format!("{}", section.fields.len());
            section.fields.iter().for_each(|kind| text += &format!(" {kind}"));
            text += "\n";
        }
        for row in &section.rows {
            for value in row {
                match value {
                    Value::Int(i) => text += &format!("{i} "),
                    Value::Real(x) => text += &format!("{x:e} "),
                }
            }
            text += "\n";
        }
    }
    text + "\nEnd\n"
}

/// Two tetrahedra with everything that a mesh file carries.
pub fn sections() -> Vec<Section> {
    vec![
        section(
            4,
            "Vertices",
            0..3,
            &[
                &[0.0, 0.0, 0.0, 1.0],
                &[1.5, 0.0, -0.0, 2.0],
                &[0.0, 1.25, 0.0, 3.0],
                &[0.0, 0.0, 1.0, -4.0],
                &[1.0, 1.0, 0.375, 5.0],
            ],
        ),
        section(5, "Edges", 0..0, &[&[1.0, 2.0, 7.0], &[2.0, 3.0, 8.0]]),
        section(6, "Triangles", 0..0, &[&[1.0, 3.0, 2.0, 1.0], &[1.0, 2.0, 4.0, 2.0], &[2.0, 3.0, 5.0, 3.0]]),
        section(8, "Tetrahedra", 0..0, &[&[1.0, 2.0, 3.0, 4.0, 1.0], &[2.0, 3.0, 4.0, 5.0, 2.0]]),
        section(13, "Corners", 0..0, &[&[1.0], &[5.0]]),
        section(14, "Ridges", 0..0, &[&[2.0]]),
        section(15, "RequiredVertices", 0..0, &[&[3.0]]),
        section(16, "RequiredEdges", 0..0, &[&[1.0]]),
        section(17, "RequiredTriangles", 0..0, &[&[3.0], &[1.0]]),
        section(40, "VerticesOnGeometricVertices", 0..0, &[&[1.0, 9.0]]),
        section(41, "VerticesOnGeometricEdges", 2..4, &[&[2.0, 4.0, 0.5, 1.0]]),
        section(42, "VerticesOnGeometricTriangles", 2..5, &[&[3.0, 6.0, 0.25, -2.0, 0.0], &[2.0, 7.0, 1.0, 2.0, 3.0]]),
    ]
}
