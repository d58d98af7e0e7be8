//! Which format a file has.
use super::surfaces::Shape;
use super::ugrid::Encoding;
use super::{error, foam};
use crate::mesh::io::{Error, read_head};
use std::path::Path;

/// A format of files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// libMeshb's meshes: .mesh, .meshb.
    Libmeshb,
    /// SU2's meshes: .su2.
    Su2,
    /// VTK's unstructured grids: .vtu.
    Vtu,
    /// VTK's legacy files: .vtk.
    LegacyVtk,
    /// XDMF: .xdmf, .xmf, with the arrays in .h5 beside it.
    Xdmf {
        /// Whether one grid of mixed cells is written.
        is_mixed: bool,
    },
    /// CGNS on HDF5: .cgns.
    Cgns,
    /// Meshes of Abaqus and CalculiX: .inp.
    Abaqus,
    /// Nastran's bulk data: .bdf, .nas.
    Nastran,
    /// gmsh's meshes: .msh, .msh2, .msh4; written as version 4.1, or 2.2.
    Msh {
        /// Whether version 4.1 is written.
        is_new: bool,
    },
    /// UGRID: .ugrid, .b8.ugrid, .lb8.ugrid.
    Ugrid(Encoding),
    /// Triangles alone: .stl, .obj, .ply.
    Surface(Shape),
    /// OpenFOAM's cases: folders.
    Foam,
    /// libMeshb's solutions: .sol, .solb.
    Solution,
    /// SU2's restarts as text: .csv.
    Table,
    /// SU2's binary restarts: .dat.
    Restart,
}

/// What can be read and written.
const KNOWN: &str = ".mesh, .meshb, .su2, .vtu, .vtk, .xdmf, .xmf, .cgns, .msh, .msh2, .inp, .bdf, .nas, .ugrid, .b8.ugrid, .lb8.ugrid, surfaces .stl, .obj, .ply, folders (OpenFOAM; \
     a new one is named with a / at its end); fields alone .sol, .solb, .csv, .dat";

/// Bytes of a file by which its format is known.
const HEAD: usize = 1 << 12;

impl Format {
    /// The format by the extension; a folder without one that is known, or with a / at its end, is a case of OpenFOAM.
    ///
    /// # Errors
    /// When it is none that is known.
    pub fn of(path: &Path) -> Result<Self, Error> {
        let found = Self::of_extension(path);
        let is_folder =
            foam::is_folder(path) && (found.is_err() || path.as_os_str().as_encoded_bytes().ends_with(b"/"));
        if is_folder { Ok(Self::Foam) } else { found }
    }

    fn of_extension(path: &Path) -> Result<Self, Error> {
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_ascii_lowercase();
        Ok(match extension.as_str() {
            "mesh" | "meshb" => Self::Libmeshb,
            "su2" => Self::Su2,
            "vtu" => Self::Vtu,
            "vtk" => Self::LegacyVtk,
            "xdmf" | "xdmf3" => Self::Xdmf { is_mixed: false },
            "xmf" => Self::Xdmf { is_mixed: true },
            "inp" => Self::Abaqus,
            "bdf" | "nas" => Self::Nastran,
            "msh" | "msh4" => Self::Msh { is_new: true },
            "msh2" => Self::Msh { is_new: false },
            "ugrid" => {
                let stem = path.file_stem().map(Path::new).and_then(Path::extension).and_then(|word| word.to_str());
                let word = stem.unwrap_or("").to_ascii_lowercase();
                let message = "the unformatted UGRID of Fortran is not read; write .b8.ugrid or .lb8.ugrid";
                Self::Ugrid(Encoding::of(&word).ok_or_else(|| error::at(path, "extension", message))?)
            }
            "stl" => Self::Surface(Shape::Stl),
            "obj" => Self::Surface(Shape::Obj),
            "ply" => Self::Surface(Shape::Ply),
            "sol" | "solb" => Self::Solution,
            "csv" => Self::Table,
            "dat" => Self::Restart,
            "cgns" => Self::Cgns,
            _ => return Err(error::at(path, "extension", format!("the format is not known; these are: {KNOWN}"))),
        })
    }

    /// The format by the extension; where that is unknown, by the first bytes.
    ///
    /// # Errors
    /// When neither tells.
    pub fn of_input(path: &Path, bytes: &[u8]) -> Result<Self, Error> {
        Self::of(path).or_else(|error| {
            let head = &bytes[..bytes.len().min(HEAD)];
            let holds = |word: &[u8]| head.windows(word.len()).any(|part| part == word);
            match () {
                () if holds(b"MeshVersionFormatted")
                    || [[1, 0, 0, 0], [0, 0, 0, 1]].iter().any(|one| head.starts_with(one)) =>
                {
                    Ok(Self::Libmeshb)
                }
                () if holds(b"$MeshFormat") => Ok(Self::Msh { is_new: true }),
                () if holds(b"<VTKFile") => Ok(Self::Vtu),
                () if holds(b"<Xdmf") => Ok(Self::Xdmf { is_mixed: false }),
                () if head.starts_with(b"# vtk DataFile") => Ok(Self::LegacyVtk),
                () if holds(b"NDIME=") => Ok(Self::Su2),
                () => Err(error),
            }
        })
    }

    /// As [`Format::of_input`], of a file that is there.
    ///
    /// # Errors
    /// When neither tells, and when the file cannot be read.
    pub fn of_file(path: &Path) -> Result<Self, Error> {
        Self::of(path).or_else(|_| Self::of_input(path, &read_head(path, HEAD)?))
    }

    /// Whether fields stand in the file of the mesh itself, at its vertices.
    pub fn holds_fields(self) -> bool {
        matches!(self, Self::Vtu | Self::LegacyVtk | Self::Xdmf { .. } | Self::Cgns | Self::Msh { .. })
    }

    /// Whether prisms, pyramids and hexahedra are read and written.
    pub fn holds_stacks(self) -> bool {
        matches!(
            self,
            Self::Libmeshb | Self::Su2 | Self::Vtu | Self::Cgns | Self::Ugrid(_) | Self::Msh { .. } | Self::Foam
        )
    }

    /// Whether files of the format hold fields and no mesh.
    pub fn is_fields(self) -> bool {
        matches!(self, Self::Solution | Self::Table | Self::Restart)
    }
}

/// Numbers of elements, as VTK and SU2 have them.
pub(super) mod vtk {
    /// A point.
    pub const VERTEX: i64 = 1;
    /// An edge.
    pub const LINE: i64 = 3;
    /// A triangle.
    pub const TRIANGLE: i64 = 5;
    /// A quadrilateral.
    pub const QUADRILATERAL: i64 = 9;
    /// A tetrahedron.
    pub const TETRAHEDRON: i64 = 10;
    /// A hexahedron.
    pub const HEXAHEDRON: i64 = 12;
    /// A prism.
    pub const PRISM: i64 = 13;
    /// A pyramid.
    pub const PYRAMID: i64 = 14;

    /// What VTK (and SU2) call an element of a number, in parentheses.
    pub fn name(number: i64) -> &'static str {
        match number {
            1 => " (vertex)",
            3 => " (line)",
            4 => " (lines)",
            5 => " (triangle)",
            9 => " (quadrilateral)",
            10 => " (tetrahedron)",
            11 => " (voxel)",
            12 => " (hexahedron)",
            13 => " (prism)",
            14 => " (pyramid)",
            21..=37 => " (of second order)",
            42 => " (polyhedron)",
            68..=79 => " (of higher order)",
            _ => "",
        }
    }
}
