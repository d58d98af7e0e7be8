//! `geo-adapt metric`: metric fields made, combined and measured; one file a subcommand.
pub(super) mod common;
pub(super) mod fields;
mod from_image;
mod from_points;
pub(super) mod geometry;
pub(super) mod goal;
mod grade;
mod implied;
mod interpolate;
mod intersect;
mod isotropic;
mod limit;
mod multiscale;
mod scale;
mod show;
pub(super) mod wall;

use super::Outcome;
use clap::Subcommand;

/// Arguments of `geo-adapt metric`.
#[derive(clap::Args)]
pub struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// The metric of an image: fine where its values bend, or at borders between labels
    FromImage(from_image::Arguments),
    /// The metric of a cloud of points: the ellipsoid about each vertex that holds its nearest points
    FromPoints(from_points::Arguments),
    /// Make the metric that the geometry asks for: curvature, thin parts, gaps
    Geometry(geometry::Arguments),
    /// Make the metric that lets a functional be computed best for its complexity: fields weighted by an adjoint
    Goal(goal::Arguments),
    /// Let sizes grow no faster than a ratio from an edge to the next
    Grade(grade::Arguments),
    /// The metric of a mesh itself: the one in which its edges have length one, as far as they can
    Implied(implied::Arguments),
    /// Bring a metric from one mesh to another
    Interpolate(interpolate::Arguments),
    /// Ask for what each of several metrics of the same mesh asks for
    Intersect(intersect::Arguments),
    /// Make a metric of sizes, one a vertex, the same in all directions
    Isotropic(isotropic::Arguments),
    /// Bound sizes and their ratios
    Limit(limit::Arguments),
    /// Make the metric that resolves a field best for its complexity: L^p multiscale
    Multiscale(multiscale::Arguments),
    /// Scale a metric to a complexity: about half the number of vertices
    Scale(scale::Arguments),
    /// Measure a metric: complexity, sizes, aspect ratios, how fast sizes grow
    Show(show::Arguments),
    /// Make the metric of layers along walls: prescribed heights and growth, or a turbulent boundary layer
    Wall(wall::Arguments),
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    match &arguments.command {
        Command::FromImage(arguments) => from_image::run(arguments),
        Command::FromPoints(arguments) => from_points::run(arguments),
        Command::Geometry(arguments) => geometry::run(arguments),
        Command::Goal(arguments) => goal::run(arguments),
        Command::Grade(arguments) => grade::run(arguments),
        Command::Implied(arguments) => implied::run(arguments),
        Command::Interpolate(arguments) => interpolate::run(arguments),
        Command::Intersect(arguments) => intersect::run(arguments),
        Command::Isotropic(arguments) => isotropic::run(arguments),
        Command::Limit(arguments) => limit::run(arguments),
        Command::Multiscale(arguments) => multiscale::run(arguments),
        Command::Scale(arguments) => scale::run(arguments),
        Command::Show(arguments) => show::run(arguments),
        Command::Wall(arguments) => wall::run(arguments),
    }
}
