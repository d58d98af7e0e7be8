//! Where a mesh is cut.
use super::{centroids, sample};
use crate::decomposition::cuts::{Cuts, samples};
use crate::decomposition::piece::{Piece, WAITING};
use crate::metric::Sym3;

/// How many tetrahedra have a vertex on the other side of a cut.
fn crossed(piece: &Piece, owners: &[u32]) -> usize {
    let mut of_vertex = vec![None; piece.ids.len()];
    let mut crossed = vec![false; piece.ids.len()];
    for (nodes, owner) in piece.mesh.tets.nodes.iter().zip(owners) {
        for v in nodes.map(|v| v as usize) {
            crossed[v] |= of_vertex[v].is_some_and(|other| other != *owner);
            of_vertex[v] = Some(*owner);
        }
    }
    piece.mesh.tets.nodes.iter().filter(|nodes| nodes.iter().any(|&v| crossed[v as usize])).count()
}

/// A cube whose metric asks for more on one side.
fn uneven(n: u32) -> Piece {
    let (_, _, mut piece) = sample(n, 0.1);
    for (log, at) in piece.logs.iter_mut().zip(&piece.mesh.vertices) {
        *log = Sym3::ZERO.plus_identity(4.0 + 6.0 * at[0] + at[1]);
    }
    piece
}

#[test]
fn parts_have_equal_work() {
    let piece = uneven(12);
    for most in [1 << 20, 2000] {
        for parts in [2, 3, 5, 8, 13] {
            let cuts = Cuts::of(samples(&piece, most), parts, 3);
            let alone = Cuts::of(samples(&piece, most), parts, 1);
            assert!(alone.work == cuts.work && alone.owners(&piece) == cuts.owners(&piece));
            let mean = cuts.work.iter().sum::<f64>() / parts as f64;
            assert_eq!(cuts.work.len(), parts);
            // The last cut may be off by 6 % of both parts, the one before by 3 % of four; the cells have a size too.
            let slack = 1.0 + 0.2 * (1.0 + f64::ln(f64::log2(parts as f64).max(1.0)));
            assert!(cuts.work.iter().all(|work| *work < slack * mean && slack * *work > mean), "{:?}", cuts.work);
            let owners = cuts.owners(&piece);
            let mut counts = vec![0; parts];
            owners.iter().for_each(|&owner| counts[owner as usize] += 1);
            assert!(counts.iter().all(|&count| count > 0));
        }
    }
}

#[test]
fn cuts_lie_where_few_tetrahedra_are() {
    // The cube's cells are twice as long along z: a cut across z crosses half as many as one along it.
    let (_, _, mut piece) = sample(8, 0.1);
    piece.mesh.vertices.iter_mut().for_each(|at| at[2] *= 3.0);
    let keep: Vec<u32> = centroids(&piece).iter().map(|at| u32::from(at[0] > 0.5 || at[1] > 0.5)).collect();
    let column = crate::decomposition::split::split(&piece, &keep, 2, |_, _| false).swap_remove(0);
    let cuts = Cuts::of(samples(&column, 1 << 20), 2, 3);
    let owners = cuts.owners(&column);
    // Of eight layers one or two are crossed, with their neighbours.
    assert!(crossed(&column, &owners) * 8 <= 4 * column.len(), "{} of {}", crossed(&column, &owners), column.len());
}

#[test]
fn former_cuts_are_avoided() {
    let (_, _, mut piece) = sample(16, 0.1);
    let first = Cuts::of(samples(&piece, 1 << 20), 2, 3).owners(&piece);
    // All that the cut went through waits.
    let mut of_vertex = vec![[false; 2]; piece.ids.len()];
    for (nodes, &owner) in piece.mesh.tets.nodes.iter().zip(&first) {
        nodes.iter().for_each(|&v| of_vertex[v as usize][owner as usize] = true);
    }
    for (mark, of) in piece.marks.iter_mut().zip(&of_vertex) {
        *mark |= if *of == [true; 2] { WAITING } else { 0 };
    }
    let second = Cuts::of(samples(&piece, 1 << 20), 2, 3).owners(&piece);
    let is_waiting = |t: &usize| piece.waits(*t);
    let waiting = (0..piece.len()).filter(is_waiting).count();
    let mut mixed = vec![[false; 2]; piece.ids.len()];
    for (nodes, &owner) in piece.mesh.tets.nodes.iter().zip(&second) {
        nodes.iter().for_each(|&v| mixed[v as usize][owner as usize] = true);
    }
    let at_both =
        |t: &usize| is_waiting(t) && piece.mesh.tets.nodes[*t].iter().any(|&v| mixed[v as usize] == [true; 2]);
    let again = (0..piece.len()).filter(at_both).count();
    assert!(4 * again < waiting, "{again} of {waiting} are cut again");
}

#[test]
fn where_there_is_little_to_cut() {
    assert_eq!(Cuts::of(Vec::new(), 4, 3).work, [0.0; 4]);
    assert_eq!(Cuts::of(Vec::new(), 0, 3).work, [0.0]);
    let (_, _, piece) = sample(1, 0.5);
    let owner: Vec<u32> = (0..piece.len() as u32).collect();
    let one = crate::decomposition::split::split(&piece, &owner, piece.len(), |_, _| true).swap_remove(0);
    let cuts = Cuts::of(samples(&one, 10), 4, 3);
    assert!(cuts.owners(&one).len() == 1 && cuts.work.iter().filter(|work| **work > 0.0).count() == 1);
    // All at one place.
    let mut same = one.clone();
    for _ in 0..9 {
        let nodes = same.mesh.tets.nodes[0];
        same.mesh.tets.push(nodes, 1);
    }
    let cuts = Cuts::of(samples(&same, 10), 4, 3);
    assert!(cuts.work.iter().filter(|work| **work > 0.0).count() == 1);
    assert!(cuts.owners(&same).iter().all(|owner| *owner == cuts.owners(&same)[0]));
    // No more samples than were asked for, and none of nothing.
    assert!(samples(&piece, 4).len() <= 4 && samples(&Piece::default(), 4).is_empty());
}

#[test]
fn few_large_tetrahedra_are_cut_as_well_as_it_goes() {
    // One of six has nearly all of the work: no cut shares it evenly, and yet there are cuts.
    let (_, _, mut piece) = sample(1, 0.5);
    let corner = piece.mesh.tets.nodes[0]
        .iter()
        .copied()
        .find(|&v| piece.mesh.tets.nodes.iter().filter(|nodes| nodes.contains(&v)).count() < 4);
    piece.logs[corner.unwrap() as usize] = Sym3::ZERO.plus_identity(40.0);
    let cuts = Cuts::of(samples(&piece, 100), 2, 3);
    let owners = cuts.owners(&piece);
    assert!(owners.contains(&0) && owners.contains(&1));
}

#[test]
fn as_many_parts_as_tetrahedra() {
    let (_, _, piece) = sample(2, 0.5);
    let cuts = Cuts::of(samples(&piece, 1000), piece.len(), 3);
    let owners = cuts.owners(&piece);
    assert!(owners.iter().all(|owner| (*owner as usize) < piece.len()));
}
