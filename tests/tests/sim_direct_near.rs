//! Strands that may touch a collider are left to a kernel of their own: which ones, and that the others move as without it.

mod support;

use glam::{Vec3, Vec4};
use tressfx_conformance::sim::{Motion, Rig, builtin, random_strands};
use tressfx_core::backend::{Backend, Run};
use tressfx_core::pass::PassList;
use tressfx_core::shape::Capsule;
use tressfx_core::strands::Strands;
use tressfx_sim::{Collider, HairSim, SectionDesc, SimParams, Solver, StepInput};

use support::{gpu, taken_for};

const DT: f64 = 1.0 / 60.0;

fn ball(center: Vec3, radius: f32) -> Capsule {
    Capsule { a: center, b: center, radius_a: radius, radius_b: radius }
}

/// With room for 40 colliders where there are any: it decides which kernel a CPU takes.
fn rig(strands: &Strands, capsules: &[Capsule]) -> Option<Rig> {
    let (params, most) = (SimParams::default(), if capsules.is_empty() { 0 } else { 40 });
    Some(Rig::with_colliders(gpu()?, strands.clone(), params, Solver::Direct, capsules, most))
}

/// Strands near a collider in the last sub-step.
fn near(rig: &mut Rig) -> u32 {
    let ticket = rig.run(|sim, list| sim.read_near(list));
    bytemuck::pod_read_unaligned(&rig.backend.read(ticket).ready().expect("the list has run"))
}

/// Positions after a third of a second on a shaken head, and how many strands were near at the end.
fn shaken(strands: &Strands, capsules: &[Capsule]) -> Option<(Vec<Vec4>, u32)> {
    let mut rig = rig(strands, capsules)?;
    rig.play(&Motion::wild(strands), 0.33, 60);
    Some((rig.positions(0), near(&mut rig)))
}

#[test]
fn nothing_is_near_what_is_far_and_moves_as_without_it() {
    let strands = random_strands(130, 16, 0, 5);
    let Some((free, none)) = shaken(&strands, &[]) else { return };
    let (with, near) = shaken(&strands, &[ball(Vec3::X * 3.0, 0.5), ball(Vec3::Y * -9.0, 2.0)]).unwrap();
    assert_eq!((none, near), (0, 0));
    assert!(free == with);
}

/// All strands of a groom move with its head, and few of them past its skin: most are not near, though the head is shaken by centimetres.
#[test]
fn a_shaken_head_is_near_few_of_its_strands() {
    let strands = random_strands(400, 16, 0, 6);
    let Some((_, near)) = shaken(&strands, &[ball(Vec3::ZERO, 0.09)]) else { return };
    println!("{near} of {}", strands.guides);
    assert!(near > 0 && near < strands.guides / 3, "{near}");
}

#[test]
fn all_strands_within_a_collider_are_near() {
    let strands = random_strands(3000, 4, 0, 7);
    let Some(mut rig) = rig(&strands, &[ball(Vec3::ZERO, 5.0)]) else { return };
    rig.play(&Motion::turning(&strands), 2.0 * DT, 60);
    assert_eq!((near(&mut rig), rig.non_finite()), (strands.guides, 0));
}

/// Colliders from the 32nd on share a bit; what is looked at in vain changes nothing.
#[test]
fn the_last_of_many_colliders_is_felt_as_if_it_were_alone() {
    let strands = builtin("wavy", 60);
    let bounds = strands.guide_bounds();
    let middle = ball(0.5 * (bounds.min + bounds.max), 0.25 * (bounds.max - bounds.min).max_element());
    let far =
        |index: usize| ball(bounds.max + (bounds.max - bounds.min) * (3.0 + index as f32), 1e-3 * middle.radius_a);
    let many: Vec<_> = (0..39).map(far).chain([middle]).collect();
    let Some((alone, near_alone)) = shaken(&strands, &[middle]) else { return };
    let (last, near_last) = shaken(&strands, &many).unwrap();
    let free = shaken(&strands, &[]).unwrap().0;
    assert!(near_alone > 0 && alone != free);
    assert_eq!(near_alone, near_last);
    assert!(alone == last);
}

/// Each section has a list of its own.
#[test]
fn sections_move_as_each_of_them_alone() {
    let [one, other] = [random_strands(130, 16, 0, 8), random_strands(70, 8, 0, 8)];
    let capsule = [ball(Vec3::new(0.0, -0.15, 0.0), 0.12)];
    let run = |sections: &[&Strands]| -> Option<Vec<Vec<u8>>> {
        let mut backend = gpu()?;
        let descs: Vec<_> = sections.iter().map(|strands| SectionDesc::new(strands, SimParams::default())).collect();
        let mut list = PassList::new();
        let mut sim = HairSim::new(&mut *backend, &mut list, &descs, 1).unwrap();
        let colliders = Collider::all_with_head(&capsule);
        for frame in 0..20 {
            let input = Motion::wild(sections[0]).input(f64::from(frame) * DT, if frame == 0 { 0.0 } else { DT });
            sim.step(&mut list, &StepInput { colliders: &colliders, ..input }).unwrap();
        }
        let tickets = sim.read_positions(&mut list);
        backend.run(&list).unwrap();
        Some(tickets.into_iter().map(|ticket| backend.read(ticket).ready().unwrap().to_vec()).collect())
    };
    let Some(both) = run(&[&one, &other]) else { return };
    // A groom has one centre.
    let [again, swapped] = [run(&[&one, &other]).unwrap(), run(&[&other, &one]).unwrap()];
    assert!(both == again, "the order within a list changes nothing");
    assert!(both[0] == swapped[1] && both[1] == swapped[0]);
}

/// Rods that a group of threads goes along together, of lengths around the numbers of threads, some of them pinned at both ends, some by up to five vertices at their roots,
/// beside others that touch nothing: after some sub-steps they are where one thread a strand takes them, but for rounding. A contact multiplies that in taut strands.
#[test]
fn threads_that_go_along_a_strand_together_take_it_where_one_does() {
    // Of up to 2,048 guides 32 threads take a strand, of more 8.
    for (guides, vertices) in [(200, 2), (200, 9), (200, 33), (200, 35), (60, 75), (2100, 3), (2100, 10), (2100, 19)] {
        let mut strands = random_strands(guides, vertices, 0, 11);
        for (index, strand) in strands.rest.chunks_mut(vertices as usize).enumerate() {
            match index % 3 {
                0 => strand.last_mut().unwrap().w = 0.0,
                1 => strand.iter_mut().take(2 + index % 4).for_each(|vertex| vertex.w = 0.0),
                _ => {}
            }
        }
        let params = SimParams { internal_damping: 1e-3, pull_frequency: 0.5, ..SimParams::default() };
        let capsule = ball(Vec3::new(0.0, -0.15, 0.0), 0.12);
        let moved = |is_cpu| -> Option<(Vec<Vec4>, u32)> {
            let backend = taken_for(*gpu()?, is_cpu);
            let mut rig = Rig::with_colliders(backend, strands.clone(), params.clone(), Solver::Direct, &[capsule], 1);
            rig.play(&Motion::wild(&strands), 2.0 * DT, 60);
            assert_eq!(rig.non_finite(), 0);
            Some((rig.positions(0), near(&mut rig)))
        };
        let Some((alone, near_alone)) = moved(true) else { return };
        let (together, near_together) = moved(false).unwrap();
        let apart: Vec<_> = alone.iter().zip(&together).map(|(a, b)| a.truncate().distance(b.truncate())).collect();
        let largest = |strand: &[f32]| strand.iter().copied().fold(0.0, f32::max);
        let of_strands: Vec<_> = apart.chunks(vertices as usize).map(largest).collect();
        // The others are moved by the same kernel.
        let differ = |pinned: bool| {
            let some =
                of_strands.iter().enumerate().filter(|(index, apart)| (index % 3 == 0) == pinned && **apart > 0.0);
            let mut some: Vec<_> = some.map(|(_, apart)| *apart).collect();
            some.sort_by(f32::total_cmp);
            some
        };
        let (pinned, free) = (differ(true), differ(false));
        // Pinned at both ends, strands of two vertices do not move.
        let half = pinned.get(pinned.len() / 2).copied().unwrap_or(0.0);
        let most = free[free.len() * 9 / 10];
        println!(
            "{guides} strands of {vertices}: {near_alone} near; {} free ones differ, 90 % by at most {most:.1e} m, {} pinned ones, half by at most {half:.1e} m",
            free.len(),
            pinned.len()
        );
        assert!(near_alone > guides / 60 && near_alone.abs_diff(near_together) <= 1 + guides / 100);
        assert!(most < 1e-5 && half < 1e-4, "{guides} strands of {vertices}: {most:e} {half:e}");
    }
}
