//! Edge removal: the ring about an edge is triangulated and each triangle joined to both ends of the edge.
//!
//! Rings of three and four are the 3-2 and 4-4 flips; an open ring on a model face is the surface's 2-2 flip. The best triangulation
//! is found by dynamic programming over the polygon (Klincsek 1980; Shewchuk 2002).
use super::access::Access;
use super::cavity::NewTet;
use super::criteria::{Criterion, wanted_score};
use super::ids::{TetId, VertexId};
use super::outcome::Refusal;
use super::shell::Shell;
use super::worker::Worker;

/// Longest ring that is looked at.
pub const LONGEST_RING: usize = 7;

/// Tables of the dynamic program: best score of the polygon i..j, and the triangle's third vertex.
#[derive(Default)]
pub struct RingTables {
    score: [[f64; LONGEST_RING]; LONGEST_RING],
    third: [[usize; LONGEST_RING]; LONGEST_RING],
    cavity: Vec<VertexId>,
}

impl<A: Access> Worker<'_, '_, A> {
    /// Removes the edge a–b of a tetrahedron that holds still, when the criterion gains by it.
    pub fn remove_edge(&mut self, a: VertexId, b: VertexId, t: TetId, criterion: Criterion) -> Result<(), Refusal> {
        self.claim(a)?;
        self.claim(b)?;
        if self.store.ridge_curve(a, b).is_some() {
            return Err(Refusal::Geometry);
        }
        self.gather_shell_while(a, b, t, LONGEST_RING, |worker, other| worker.goes_first(t, other))?;
        let shell = std::mem::take(&mut self.state.shell);
        let result = self.remove_shell(a, b, &shell, criterion);
        self.state.shell = shell;
        result
    }

    fn remove_shell(&mut self, a: VertexId, b: VertexId, shell: &Shell, criterion: Criterion) -> Result<(), Refusal> {
        let n = shell.ring.len();
        if !(3..=LONGEST_RING).contains(&n) {
            return Err(Refusal::Topology);
        }
        let surface = self.surface_flip(a, b, shell)?;
        let mut tables = std::mem::take(&mut self.state.ring);
        tables.cavity.clear();
        tables.cavity.extend([a, b]);
        tables.cavity.extend(&shell.ring);
        let old = shell.tets.iter().map(|&t| self.present_score(criterion, t, &tables.cavity));
        let old = old.fold(f64::INFINITY, f64::min);
        let wanted = wanted_score(old);
        self.triangulate(a, b, shell, criterion, wanted, &mut tables);
        let gains = tables.score[0][n - 1] > wanted;
        if gains {
            self.write_triangulation(a, b, shell, &tables);
        }
        self.state.ring = tables;
        if !gains {
            return Err(Refusal::Shape);
        }
        if let Some((old, new)) = surface {
            let facing = self.facing(&old);
            self.compare_normals(facing, &new, 0.0)?;
            self.refuse_joined(shell.ring[0], shell.ring[n - 1])?;
            self.state.replacement.faces.extend(new);
        }
        self.commit()
    }

    /// The two surface triangles at the edge and the two that would replace them; none inside.
    #[allow(clippy::type_complexity)]
    fn surface_flip(
        &self,
        a: VertexId,
        b: VertexId,
        shell: &Shell,
    ) -> Result<Option<([([VertexId; 3], u32); 2], [([VertexId; 3], u32); 2])>, Refusal> {
        let count = shell.surface_tags().count();
        if shell.closed {
            return if count == 0 { Ok(None) } else { Err(Refusal::Geometry) };
        }
        let (first, last) = (shell.ring[0], shell.ring[shell.ring.len() - 1]);
        let tag = shell.tags[0];
        if count != 2 || shell.tags[shell.tags.len() - 1] != tag {
            return Err(Refusal::Geometry);
        }
        let old = [([a, first, b], tag), ([a, b, last], tag)];
        let new = [([a, first, last], tag), ([first, b, last], tag)];
        Ok(Some((old, new)))
    }

    /// Refuses when the two claimed vertices are joined by an edge already.
    fn refuse_joined(&mut self, x: VertexId, y: VertexId) -> Result<(), Refusal> {
        let joined = self.with_passing_ball(x, |ball| ball.link.contains(&y));
        if joined { Err(Refusal::Topology) } else { Ok(()) }
    }

    /// Fills the tables; triangulations at or below `wanted` are not followed.
    fn triangulate(
        &self,
        a: VertexId,
        b: VertexId,
        shell: &Shell,
        criterion: Criterion,
        wanted: f64,
        tables: &mut RingTables,
    ) {
        let (ring, n) = (&shell.ring, shell.ring.len());
        for i in 0..n - 1 {
            tables.score[i][i + 1] = f64::INFINITY;
        }
        for width in 2..n {
            for i in 0..n - width {
                let j = i + width;
                let (mut best, mut third) = (f64::NEG_INFINITY, i + 1);
                for k in i + 1..j {
                    let bound = tables.score[i][k].min(tables.score[k][j]);
                    if bound <= best.max(wanted) {
                        continue;
                    }
                    let floor = best.max(wanted);
                    let score = |tet| self.score(criterion, tet, &tables.cavity, floor).unwrap_or(f64::NEG_INFINITY);
                    let upper = bound.min(score([ring[i], ring[k], ring[j], b]));
                    if upper <= floor {
                        continue;
                    }
                    let value = upper.min(score([ring[i], ring[j], ring[k], a]));
                    if value > best {
                        (best, third) = (value, k);
                    }
                }
                tables.score[i][j] = best;
                tables.third[i][j] = third;
            }
        }
    }

    fn write_triangulation(&mut self, a: VertexId, b: VertexId, shell: &Shell, tables: &RingTables) {
        let region = self.store.region(shell.tets[0]);
        self.state.replacement.clear();
        self.state.replacement.old.extend(&shell.tets);
        let mut open = [(0, 0); LONGEST_RING];
        let mut depth = 1;
        open[0] = (0, shell.ring.len() - 1);
        while depth > 0 {
            depth -= 1;
            let (i, j) = open[depth];
            if j - i < 2 {
                continue;
            }
            let k = tables.third[i][j];
            let (x, y, z) = (shell.ring[i], shell.ring[k], shell.ring[j]);
            for vertices in [[x, y, z, b], [x, z, y, a]] {
                let quality = self.shape(vertices);
                self.state.replacement.new.push(NewTet { vertices, region, quality });
            }
            open[depth] = (i, k);
            open[depth + 1] = (k, j);
            depth += 2;
        }
    }
}
