//! The arguments of `geo-adapt view` that say how it is to look.
use crate::mesh::vector::Vec3;
use crate::view::cut::Plane;

/// What is seen; a page begins with it.
#[derive(clap::Args)]
pub struct LookArguments {
    /// What it is called [default: the mesh's file]
    #[arg(long, value_name = "TEXT")]
    pub title: Option<String>,
    /// Width and height of the picture, in pixels
    #[arg(long, value_name = "WxH", default_value = "1200x900", value_parser = size)]
    pub size: [u32; 2],
    /// From where: azimuth and elevation, in degrees [default: what sees the cut]
    #[arg(long, value_name = "AZ,EL", value_parser = view, allow_hyphen_values = true)]
    pub view: Option<Direction>,
    /// The point in the middle [default: the middle of what is shown]
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    pub at: Option<Point>,
    /// So many times larger than what fits
    #[arg(long, value_name = "F", default_value_t = 1.0, value_parser = crate::cli::positive, allow_negative_numbers = true)]
    pub zoom: f64,
    /// A plane: only the tetrahedra that reach behind it are shown: x=0.5, -z=0.1 (the other side), or a normal: 1,1,0=0.5
    #[arg(long, value_name = "PLANE", allow_hyphen_values = true)]
    pub cut: Option<Plane>,
    /// Where the cut goes: along the plane, or between whole tetrahedra [default: plane for fields and models, else tets]
    #[arg(long, value_name = "STYLE", value_enum, requires = "cut")]
    pub cut_style: Option<CutStyle>,
    /// About how many lines of equal value a field has on a cut along the plane, else on the surface [default: 20 on such a cut]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=1000))]
    pub isolines: Option<u32>,
    /// So many streamlines of the velocity, the first field of --field that is a vector [without a number: 40]
    #[arg(long, value_name = "N", num_args = 0..=1, require_equals = true, default_missing_value = "40", value_parser = clap::value_parser!(u32).range(1..=2000))]
    pub streamlines: Option<u32>,
    /// What elements are coloured by: reference, quality, field, distance (with --cad), size, aspect (with a metric),
    /// or a field's name [default: field, else quality, on a cut or in a metric, else reference]
    #[arg(long, visible_alias = "colour", value_name = "BY")]
    pub color: Option<String>,
    /// Ends of the colours of a field [default: its least and greatest value]
    #[arg(long, value_name = "A,B", value_parser = range, allow_hyphen_values = true)]
    pub range: Option<Range>,
    /// Surfaces that are not shown, by reference or name; the others fill the picture [default: farfield and symmetry, where a surface is
    /// called farfield; none: all are shown]
    #[arg(long, value_name = "REF|NAME,…", value_delimiter = ',', allow_negative_numbers = true)]
    pub hide: Vec<String>,
    /// Only tetrahedra of a mean ratio below this, and no surface
    #[arg(long, value_name = "Q", value_parser = crate::cli::positive, allow_negative_numbers = true)]
    pub below: Option<f64>,
    /// No lines between the elements
    #[arg(long)]
    pub no_wire: bool,
    /// Whether surfaces have their number and name on them [default: yes for a model, no for a mesh]
    #[arg(long, value_name = "yes|no", num_args = 0..=1, default_missing_value = "yes", require_equals = true, value_parser = yes_or_no)]
    pub numbers: Option<bool>,
}

/// Where a cut goes.
#[derive(Clone, Copy, clap::ValueEnum)]
pub enum CutStyle {
    /// Along the plane: the field, interpolated
    Plane,
    /// Between tetrahedra: all that reach behind the plane are whole
    Tets,
}

// Types of their own: clap would take a bare array for something else.

/// Azimuth and elevation, degrees.
#[derive(Clone, Copy)]
pub struct Direction(pub [f64; 2]);
/// A point, model units.
#[derive(Clone, Copy)]
pub struct Point(pub Vec3);
/// The ends of values.
#[derive(Clone, Copy)]
pub struct Range(pub [f32; 2]);

/// Parses numbers with commas between.
fn numbers<const N: usize>(text: &str) -> Option<[f64; N]> {
    let all: Result<Vec<f64>, _> = text.split(',').map(|part| part.trim().parse()).collect();
    <[f64; N]>::try_from(all.ok()?).ok().filter(|all| all.iter().all(|x| x.is_finite()))
}

fn view(text: &str) -> Result<Direction, String> {
    match numbers(text) {
        Some([azimuth, elevation]) if (-90.0..=90.0).contains(&elevation) => Ok(Direction([azimuth, elevation])),
        _ => Err("give azimuth and elevation in degrees, such as -55,25; the elevation from -90 to 90".into()),
    }
}

fn yes_or_no(text: &str) -> Result<bool, String> {
    match text {
        "yes" => Ok(true),
        "no" => Ok(false),
        _ => Err("give yes or no".into()),
    }
}

fn point(text: &str) -> Result<Point, String> {
    numbers(text).map(Point).ok_or_else(|| "give three coordinates, such as 0.5,0,1".into())
}

fn range(text: &str) -> Result<Range, String> {
    match numbers(text) {
        Some([low, high]) if low < high => Ok(Range([low as f32, high as f32])),
        _ => Err("give two numbers, the smaller first, such as 0,1.2".into()),
    }
}

fn size(text: &str) -> Result<[u32; 2], String> {
    let parse = |side: &str| side.parse::<u32>().ok().filter(|side| (64..=8192).contains(side));
    match text.split_once('x').map(|(width, height)| [parse(width), parse(height)]) {
        Some([Some(width), Some(height)]) => Ok([width, height]),
        _ => Err("give width and height in pixels, each from 64 to 8192, such as 1200x900".into()),
    }
}
