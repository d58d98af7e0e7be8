//! Streamlines of a velocity at vertices: dx/ds = u/|u|, with u linear in each tetrahedron, by the classical method of Runge and Kutta of
//! fourth order in the length of the line (Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, section II.1).
use super::picture::Options;
use super::scene::Scene;
use super::section::Of;
use crate::mesh::TetMesh;
use crate::mesh::locate::{Location, Locator};
use crate::mesh::vector::{Vec3, add, distance, dot, norm, scale};
use crate::tasks::Team;

/// A velocity.
pub struct Velocity {
    /// What it is called.
    pub name: String,
    /// At each vertex, shape (vertices, 3).
    pub values: Vec<[f32; 3]>,
}

/// A point of a line.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// Where.
    pub at: Vec3,
    /// In which tetrahedron.
    pub tet: u32,
    /// With which barycentric coordinates.
    pub weights: [f64; 4],
}

impl Point {
    /// The value of a field at vertices.
    pub fn value(&self, mesh: &TetMesh, values: &[f32]) -> f32 {
        let nodes = mesh.tets.nodes[self.tet as usize];
        (0..4).map(|i| self.weights[i] as f32 * values[nodes[i] as usize]).sum()
    }
}

/// A step goes so far through a tetrahedron.
const STEP: f64 = 0.35;
/// The shortest and the longest step, of the radius of what is shown.
const STEPS: [f64; 2] = [2e-4, 2e-2];
/// A line is at most so many radii long, to each side of its seed.
const LONGEST: f64 = 6.0;
/// Where the velocity is less, of its greatest, a line ends.
const REST: f64 = 1e-5;
/// Seeds are chosen among so many points at most.
const CANDIDATES: usize = 5_000;
/// Every so many points of a line keep further lines away.
const SPARSE: usize = 4;
/// Lines begin within the box of what is shown, widened by this share of its diagonal.
const AROUND: f64 = 0.12;

/// The streamlines of a scene, as many as are asked for, of the cut along the plane where there is one: each goes through the point that is
/// farthest from all lines before it (Mebarki, Alliez, Devillers, Farthest Point Seeding for Efficient Placement of Streamlines, 2005).
pub fn streamlines(team: Team<'_>, scene: &Scene<'_>, options: &Options) -> Vec<Vec<Point>> {
    let Some(velocity) = scene.given.velocity.as_ref().filter(|_| options.streamlines > 0) else { return Vec::new() };
    let mesh = scene.mesh;
    if mesh.tets.is_empty() {
        return Vec::new();
    }
    let (low, high) = seen(scene, options);
    let flow = Flow {
        locator: Locator::new(mesh.vertices.clone(), mesh.tets.nodes.clone()),
        velocity: &velocity.values,
        radius: 0.5 * distance(low, high),
        least: REST * velocity.values.iter().map(|u| norm(u.map(f64::from))).fold(0.0, f64::max),
    };
    flow.lines(&candidates(team, scene, options, [low, high]), options.streamlines as usize)
}

/// The box in which lines begin.
fn seen(scene: &Scene<'_>, options: &Options) -> (Vec3, Vec3) {
    let hidden = &options.part.hidden;
    let triangles = scene.surface.triangles.iter().filter(|(_, reference)| !hidden.contains(reference));
    let points = triangles.flat_map(|(nodes, _)| nodes.map(|v| scene.mesh.vertices[v as usize]));
    let none = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    let (low, high): (Vec3, Vec3) = points.fold(none, |(low, high), p| {
        (std::array::from_fn(|i| low[i].min(p[i])), std::array::from_fn(|i| high[i].max(p[i])))
    });
    if low[0] > high[0] {
        return (scene.bounds[0], scene.bounds[1]);
    }
    let more = AROUND * distance(low, high);
    (low.map(|x| x - more), high.map(|x| x + more))
}

/// Points through which lines may go.
fn candidates(team: Team<'_>, scene: &Scene<'_>, options: &Options, [low, high]: [Vec3; 2]) -> Vec<Vec3> {
    let vertices = &scene.mesh.vertices;
    let within = |p: &Vec3| (0..3).all(|i| low[i] <= p[i] && p[i] <= high[i]);
    let pieces = options.part.of(team, scene).pieces;
    let on_plane = pieces.iter().filter(|piece| matches!(piece.of, Of::Tet(_))).map(|piece| {
        let [a, b, c] = piece.corners.map(|corner| corner.point(vertices));
        scale(add(add(a, b), c), 1.0 / 3.0)
    });
    let mut found: Vec<Vec3> = on_plane.filter(within).collect();
    if found.is_empty() {
        let middle =
            |nodes: &[u32; 4]| scale(nodes.iter().fold([0.0; 3], |sum, &v| add(sum, vertices[v as usize])), 0.25);
        found = scene.mesh.tets.nodes.iter().map(middle).filter(within).collect();
    }
    let every = found.len().div_ceil(CANDIDATES).max(1);
    found.into_iter().step_by(every).collect()
}

/// A velocity in a mesh.
struct Flow<'v> {
    locator: Locator,
    velocity: &'v [[f32; 3]],
    /// Half the diagonal of what is shown.
    radius: f64,
    /// Velocities below this are rest.
    least: f64,
}

impl Flow<'_> {
    /// So many lines at most, through some of the points.
    fn lines(&self, points: &[Vec3], count: usize) -> Vec<Vec<Point>> {
        let mut far = vec![f64::INFINITY; points.len()];
        let mut lines = Vec::new();
        // A point at rest gives no line.
        for _ in 0..2 * count {
            let farthest = far.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1).then(b.0.cmp(&a.0)));
            let Some(seed) = farthest.filter(|(_, far)| **far > 0.0).map(|(i, _)| i) else { break };
            far[seed] = 0.0;
            let line = self.line(points[seed]);
            for point in line.iter().step_by(SPARSE) {
                far.iter_mut().zip(points).for_each(|(far, &p)| *far = far.min(distance(p, point.at)));
            }
            if line.len() > 1 {
                lines.push(line);
            }
            if lines.len() == count {
                break;
            }
        }
        lines
    }

    /// The line through a point, in the direction of the flow.
    fn line(&self, seed: Vec3) -> Vec<Point> {
        let mut line = self.half(seed, -1.0);
        line.reverse();
        line.pop();
        line.extend(self.half(seed, 1.0));
        line
    }

    /// Downstream (sign 1) or upstream (−1) from a point, which comes first.
    fn half(&self, seed: Vec3, sign: f64) -> Vec<Point> {
        let mut hint = u32::MAX;
        let mut line = Vec::new();
        let Some(mut here) = self.inside(seed, &mut hint) else { return line };
        line.push(here);
        let mut length = 0.0;
        while length < LONGEST * self.radius {
            let Some(direction) = self.direction(&here, sign) else { break };
            let step = self.step(&here, direction);
            let Some(next) = self.runge_kutta(here.at, direction, step, sign, &mut hint) else { break };
            length += step;
            here = next;
            line.push(here);
        }
        line
    }

    fn runge_kutta(&self, at: Vec3, first: Vec3, step: f64, sign: f64, hint: &mut u32) -> Option<Point> {
        let ahead = |direction: Vec3, share: f64| add(at, scale(direction, share * step));
        let mut slope = |p: Vec3| self.inside(p, hint).and_then(|there| self.direction(&there, sign));
        let second = slope(ahead(first, 0.5))?;
        let third = slope(ahead(second, 0.5))?;
        let fourth = slope(ahead(third, 1.0))?;
        let mean = std::array::from_fn(|i| (first[i] + 2.0 * (second[i] + third[i]) + fourth[i]) / 6.0);
        self.inside(ahead(mean, 1.0), hint)
    }

    /// The point with its place in the mesh; none outside.
    fn inside(&self, at: Vec3, hint: &mut u32) -> Option<Point> {
        let Location { tet, weights, distance } = self.locator.locate(at, hint);
        (distance <= 1e-9 * self.radius).then_some(Point { at, tet, weights })
    }

    /// The unit vector along the flow; none at rest.
    fn direction(&self, point: &Point, sign: f64) -> Option<Vec3> {
        let nodes = self.locator.tets()[point.tet as usize];
        let velocity: Vec3 = std::array::from_fn(|k| {
            (0..4).map(|i| point.weights[i] * f64::from(self.velocity[nodes[i] as usize][k])).sum()
        });
        let speed = norm(velocity);
        (speed > self.least).then(|| scale(velocity, sign / speed))
    }

    /// A share of the tetrahedron's width in this direction.
    fn step(&self, point: &Point, direction: Vec3) -> f64 {
        let along = self.locator.corners(point.tet).map(|corner| dot(corner, direction));
        let [low, high] = [f64::min, f64::max].map(|f| along.into_iter().reduce(f).unwrap_or(0.0));
        (STEP * (high - low)).clamp(STEPS[0] * self.radius, STEPS[1] * self.radius)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::samples::cube;

    fn flow(mesh: &TetMesh, velocity: impl Fn(Vec3) -> Vec3) -> Vec<[f32; 3]> {
        mesh.vertices.iter().map(|&p| velocity(p).map(|x| x as f32)).collect()
    }

    fn of<'v>(mesh: &TetMesh, velocity: &'v [[f32; 3]]) -> Flow<'v> {
        let locator = Locator::new(mesh.vertices.clone(), mesh.tets.nodes.clone());
        Flow { locator, velocity, radius: 0.75f64.sqrt(), least: 1e-5 }
    }

    #[test]
    fn a_rotation_has_circles() {
        let mesh = cube(4);
        // Linear, so that there is no error of interpolation.
        let velocity = flow(&mesh, |p| [0.5 - p[1], p[0] - 0.5, 0.0]);
        let line = of(&mesh, &velocity).half([0.8, 0.5, 0.4], 1.0);
        let turned: f64 = line.windows(2).map(|ends| distance(ends[0].at, ends[1].at)).sum();
        assert!(turned > 2.0 * std::f64::consts::PI * 0.3, "{turned}: more than once around");
        for point in &line {
            let radius = (point.at[0] - 0.5).hypot(point.at[1] - 0.5);
            assert!((radius - 0.3).abs() < 1e-4 && (point.at[2] - 0.4).abs() < 1e-12, "{point:?}");
        }
    }

    #[test]
    fn a_line_goes_both_ways_to_the_border_and_ends_at_rest() {
        let mesh = cube(3);
        let straight = flow(&mesh, |_| [2.0, 0.0, 0.0]);
        let line = of(&mesh, &straight).line([0.4, 0.3, 0.6]);
        let (first, last) = (line[0].at[0], line[line.len() - 1].at[0]);
        assert!(
            first < 0.03 && last > 0.97 && line.windows(2).all(|ends| ends[0].at[0] < ends[1].at[0]),
            "{first} {last}"
        );
        let x: Vec<f32> = mesh.vertices.iter().map(|p| p[0] as f32).collect();
        assert!(line.iter().all(|point| (f64::from(point.value(&mesh, &x)) - point.at[0]).abs() < 1e-6));
        let at_rest = flow(&mesh, |_| [0.0; 3]);
        assert_eq!(of(&mesh, &at_rest).line([0.4, 0.3, 0.6]).len(), 1);
        assert!(of(&mesh, &straight).line([2.0, 0.0, 0.0]).is_empty());
    }

    #[test]
    fn lines_keep_away_from_each_other() {
        let mesh = cube(3);
        let straight = flow(&mesh, |_| [1.0, 0.0, 0.0]);
        let flow = of(&mesh, &straight);
        // Many points of one line, one of another: the second line is not the first again.
        let points: Vec<Vec3> = (1..20).map(|i| [f64::from(i) / 20.0, 0.5, 0.5]).chain([[0.5, 0.9, 0.5]]).collect();
        let lines = flow.lines(&points, 2);
        assert_eq!(lines.len(), 2);
        assert!((lines[0][0].at[1] - 0.5).abs() < 1e-9 && (lines[1][0].at[1] - 0.9).abs() < 1e-9);
        assert!(flow.lines(&[[0.5; 3]], 3).len() == 1 && flow.lines(&[], 3).is_empty());
    }
}
