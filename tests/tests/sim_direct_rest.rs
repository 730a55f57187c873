//! Grooms of the `Direct` solver that rest on what they grow on.

mod support;

use glam::{Vec3, Vec4};
use tressfx_asset::builtin::Builtin;
use tressfx_conformance::sim::{Motion, Rig, lengths, strands_of};
use tressfx_core::shape::Capsule;
use tressfx_sim::{SimParams, Solver};

use support::gpu;

/// No tip may be further from the groom than this share of its length.
const OFF: f32 = 5e-3;

/// The first two vertices of a strand are held by its root.
const HELD: usize = 2;

/// The least height of a line of points above any capsule.
fn height(points: &[Vec4], capsules: &[Capsule]) -> f32 {
    let of_edge = |edge: &[Vec4]| {
        let at = |i: u16| edge[0].truncate().lerp(edge[1].truncate(), f32::from(i) / 8.0);
        let above = |point: Vec3| capsules.iter().map(move |capsule| capsule.distance(point));
        (0..=8).map(at).flat_map(above).fold(f32::INFINITY, f32::min)
    };
    points.windows(2).map(of_edge).fold(f32::INFINITY, f32::min)
}

/// A strand after 5 s on its capsules.
struct Rested {
    /// The distance of its tip from the groom, as a share of its length.
    off: f32,
    /// What any vertex moves by in a frame, as a share of its length.
    moves: f32,
    /// The least height above a capsule, in metres: of what its root holds,
    held: f32,
    /// of the rest of it in the pose of the file,
    before: f32,
    /// and of its free vertices now.
    after: f32,
}

fn rested(builtin: &Builtin, capsules: &[Capsule]) -> Option<Vec<Rested>> {
    let strands = strands_of(builtin.asset(), 0);
    let params = SimParams::default();
    let mut rig = Rig::with_colliders(gpu()?, strands.clone(), params, Solver::Direct, capsules, capsules.len());
    rig.play(&Motion::still(&strands), 5.0, 60);
    let (now, world) = (rig.positions(0), rig.world(0));
    rig.frame(&Motion::still(&strands).input(0.0, 1.0 / 60.0));
    let then = rig.positions(0);
    assert_eq!(rig.non_finite(), 0);
    let (rest, vertices) = (rig.rest(0), strands.vertices as usize);
    let strand = |(strand, length): (usize, f64)| {
        let range = strand * vertices..(strand + 1) * vertices;
        let apart = |a: &[Vec4], b: &[Vec4], i: usize| a[i].truncate().distance(b[i].truncate()) / length as f32;
        let (file, world) = (&strands.rest[range.clone()], &world[range.clone()]);
        Rested {
            off: apart(&now, &rest, range.end - 1),
            moves: range.map(|i| (apart(&now, &then, i) - rounding(now[i], length)).max(0.0)).fold(0.0, f32::max),
            held: height(&file[..HELD], capsules),
            before: height(&file[HELD - 1..], capsules),
            after: height(&world[HELD..], capsules),
        }
    };
    Some(lengths(&strands).into_iter().enumerate().map(strand).collect())
}

/// Four roundings of a coordinate, as a share of a length: they do not count.
fn rounding(place: Vec4, length: f64) -> f32 {
    2.0 * f32::EPSILON * place.truncate().abs().max_element() / length as f32
}

/// The largest of a figure.
fn most<'a>(strands: impl IntoIterator<Item = &'a Rested>, of: impl Fn(&Rested) -> f32) -> f32 {
    strands.into_iter().map(of).fold(f32::NEG_INFINITY, f32::max)
}

#[test]
fn grooms_rest_on_their_bodies_as_they_were_made() {
    for name in ["straight", "wavy", "curly", "long", "fur"] {
        let builtin = Builtin { strands: 150, ..name.parse().expect("a built-in groom") };
        let Some(strands) = rested(&builtin, &builtin.capsules()) else { return };
        let (off, moves) = (most(&strands, |strand| strand.off), most(&strands, |strand| strand.moves));
        let deepest = most(&strands, |strand| -strand.before.min(strand.held));
        println!(
            "{name}: {:.2} mm above the body, tips off by {off:.1e}, moves by {moves:.1e} a frame",
            -1e3 * deepest
        );
        assert!(deepest < 1e-6 && off < OFF && moves < 1e-6, "{name}: {deepest} {off:e} {moves:e}");
    }
}

/// What begins within capsules that are too large for their groom is pushed out of them, and nothing else moves.
#[test]
fn strands_that_begin_inside_a_capsule_come_to_rest_on_it() {
    let builtin = Builtin { strands: 150, ..Builtin::parse("straight").unwrap() };
    let larger = |capsule: Capsule| {
        let [radius_a, radius_b] = [capsule.radius_a, capsule.radius_b].map(|radius| radius + 6e-3);
        Capsule { radius_a, radius_b, ..capsule }
    };
    let capsules: Vec<_> = builtin.capsules().into_iter().map(larger).collect();
    let Some(strands) = rested(&builtin, &capsules) else { return };
    let (clear, inside): (Vec<&Rested>, Vec<_>) = strands.iter().partition(|strand| strand.before >= 0.0);
    let (free, rooted): (Vec<&Rested>, Vec<_>) = inside.iter().partition(|strand| strand.held >= 0.0);
    for (name, strands) in [("clear", &clear), ("inside", &free), ("inside with their roots", &rooted)] {
        let figures =
            [most(strands.iter().copied(), |strand| strand.off), most(strands.iter().copied(), |strand| strand.moves)];
        let deepest = most(strands.iter().copied(), |strand| -strand.after);
        println!(
            "{} {name}: tips off by {:.1e}, moves by {:.1e}, {:.2} mm deep",
            strands.len(),
            figures[0],
            figures[1],
            1e3 * deepest
        );
    }
    assert!(clear.len() > 30 && free.len() > 10 && rooted.len() > 10);
    assert!(most(clear, |strand| strand.off) < OFF);
    // The longest are a quarter of a metre. One of them trembles where two capsules meet, by up to 1.6e-4 a frame, for as long as one looks.
    assert!(free.iter().filter(|strand| strand.moves >= 1e-4).count() <= 1);
    assert!(most(free.iter().copied(), |strand| -strand.after) < 3e-4 && most(free, |strand| strand.moves) < 3e-4);
    assert!(most(rooted, |strand| -strand.after) < 1e-3);
}
