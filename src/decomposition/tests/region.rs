//! What a part takes of the metric: all tetrahedra about it, and few others.
use super::{Random, sample};
use crate::decomposition::cuts::{Cuts, Sample, samples};
use crate::decomposition::ground::{Around, Block, Ground};
use crate::decomposition::region::Region;
use crate::decomposition::shelf::{Key, Shelf};
use crate::decomposition::split::{split, split_tets};
use crate::metric::Source;

#[test]
fn a_part_finds_the_metric_at_all_of_its_points() {
    let (_, source, mut whole) = sample(8, 0.3);
    // A metric that tells one place from another.
    whole.logs = whole.mesh.vertices.iter().map(|p| whole.logs[0].plus_identity(p[0] - 3.0 * p[1] + p[2])).collect();
    let Source::Background(background) = source else { unreachable!() };
    let source = {
        let (vertices, tets) = (background.locator().mesh().vertices.clone(), whole.mesh.tets.nodes.clone());
        Source::Background(crate::metric::Background::new(vertices, tets, whole.logs.clone()))
    };
    let found = samples(&whole, 1000);
    let whole_box = Sample::box_of(&found);
    let cuts = Cuts::of(found, 5, 1);
    let parts = split(&whole, &cuts.owners(&whole), 5, |_, _| false);
    let blocks = split(&whole, &(0..whole.len() as u32).map(|t| t % 3).collect::<Vec<_>>(), 3, |_, _| false);
    let boxes = cuts.boxes(whole_box);
    let mut random = Random(3);
    for (number, part) in parts.iter().enumerate() {
        let mut region = Region::new(boxes[number]);
        region.add(part);
        let region = Region::of_words(&region.words()).unwrap().grown();
        let (shelf, mut around) = (Shelf::in_memory(), Around::new());
        let mut taken = 0;
        for (block, of) in blocks.iter().zip(0..) {
            let tets = region.of(block);
            taken += tets.len();
            shelf.put(Key::Around { round: 1, part: 0, of }, split_tets(block, &tets)).unwrap();
            around.entry(0).or_default().push(of);
        }
        assert!(taken >= part.len() && taken < 2 * whole.len() / 3, "{taken} of {}", whole.len());
        let ground = Ground::Blocks(blocks.iter().zip(0..).map(|(piece, at)| Block::of(at, 0, piece)).collect(), 0.25);
        let under = ground.under(&shelf, 1, 0, &around).unwrap();
        for _ in 0..200 {
            let nodes = part.mesh.tets.nodes[random.below(part.len())];
            let weights = [0; 4].map(|_| 1.0 + random.below(100) as f64);
            let sum: f64 = weights.iter().sum();
            let mut p = [0.0; 3];
            for (v, weight) in nodes.iter().zip(weights) {
                (0..3).for_each(|k| p[k] += weight / sum * part.mesh.vertices[*v as usize][k]);
            }
            let [here, there] = [under.source().log_at(p, &mut 0), source.log_at(p, &mut 0).plus_identity(0.25)];
            assert!((0..6).all(|k| (here.0[k] - there.0[k]).abs() < 1e-12), "{p:?}: {here:?} {there:?}");
        }
    }
}

#[test]
fn a_slab_across_the_box_takes_a_slab() {
    let (_, _, whole) = sample(16, 0.3);
    let is_in = |t: usize| whole.mesh.tets.nodes[t].iter().all(|&v| whole.mesh.vertices[v as usize][1] <= 0.125);
    let owner: Vec<u32> = (0..whole.len()).map(|t| u32::from(!is_in(t))).collect();
    let slab = &split(&whole, &owner, 2, |_, _| false)[0];
    let mut region = Region::new([[0.0; 3], [1.0; 3]]);
    region.add(slab);
    let region = region.grown();
    let taken = region.of(&whole);
    assert!(taken.len() >= slab.len() && taken.len() < 3 * slab.len(), "{} for {}", taken.len(), slab.len());
    assert!(region.reaches([[0.2, 0.1, 0.2], [0.3, 0.9, 0.3]]) && !region.reaches([[0.0, 0.5, 0.0], [1.0; 3]]));
}
