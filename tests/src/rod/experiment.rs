//! What is done to a strand in the `Direct` solver's f64 function to see a known answer: for tests and for the plots of the docs.

use std::f64::consts::{PI, TAU};

use glam::{DQuat, DVec3};
use tressfx_sim::reference::direct::{Rod, RodRest, RodStep, TipHold, direct};

use super::kirchhoff::Kirchhoff;
use super::strand::{LENGTH, bend, line, run, settled, step, tip};
use super::{G, chain, elastica, threshold};

/// Of a chain of edges: as good as none.
const NO_BENDING: f64 = 1e-4;
/// The sub-step that frames are cut into by default, s.
const SUB_STEP: f64 = 1.0 / 120.0;

/// How far the tip of a strand that is clamped horizontally is from that of the heavy elastica, as a share of its length.
pub fn elastica_error(vertices: usize, ratio: f64) -> f64 {
    let rod = settled(&step(1.0 / 60.0, LENGTH / ratio), &line(vertices, DVec3::X), 6.0);
    let [along, up] = elastica::tip(ratio);
    (tip(&rod) / LENGTH).distance(DVec3::new(along, up, 0.0))
}

/// Frequency and damping ratio of a mode of a hanging strand, from its amplitude in the mode over ten periods.
///
/// # Panics
/// If it does not swing.
pub fn mode(vertices: usize, number: usize, length: f64) -> (f64, f64) {
    let rest = line(vertices, DVec3::NEG_Y);
    let step = step(length, NO_BENDING);
    let mut rod = Rod::at_rest(&rest, DQuat::IDENTITY);
    bend(&rest, &mut rod, |share| 1e-3 * LENGTH * chain::shape(number, share));
    let share = |i: usize| chain::shape(number, i as f64 / (vertices - 1) as f64);
    let amplitude = |rod: &Rod| (0..vertices).map(|i| rest.masses[i] * share(i) * rod.positions[i].x).sum::<f64>();
    let steps = (10.0 * TAU / chain::frequency(LENGTH, number) / length) as usize;
    let mut values = vec![amplitude(&rod)];
    for _ in 0..steps {
        direct(&step, &rest, &mut rod);
        values.push(amplitude(&rod));
    }
    let crossings: Vec<f64> = (1..values.len())
        .filter(|&i| (values[i] > 0.0) != (values[i - 1] > 0.0))
        .map(|i| (i as f64 - values[i] / (values[i] - values[i - 1])) * length)
        .collect();
    let last = crossings.len() - 1;
    let frequency = PI * last as f64 / (crossings[last] - crossings[0]);
    // The largest value between two crossings, by the parabola through three.
    let peak = |i: usize| {
        let (a, b, c) = (values[i - 1].abs(), values[i].abs(), values[i + 1].abs());
        (b >= a && b >= c).then(|| b - (a - c) * (a - c) / (8.0 * (a - 2.0 * b + c)))
    };
    let peaks: Vec<f64> = (1..values.len() - 1).filter_map(peak).collect();
    let damping = (peaks[0] / peaks[peaks.len() - 1]).ln() / (PI * (peaks.len() - 1) as f64);
    (frequency, damping)
}

/// Length of the helix, m.
pub const HELIX_LENGTH: f64 = 0.3;
const HELIX_RADIUS: f64 = 0.01;
const HELIX_PITCH: f64 = 0.02;
const HELIX_BENDING: f64 = 0.05;

/// A helix that hangs under its weight.
#[derive(Clone, Copy, Debug)]
pub struct Hanging {
    /// Where its tip is, from the root, m.
    pub tip: DVec3,
    /// Its height over that without weight.
    pub longer: f64,
}

/// The helix of a Kirchhoff rod: radius 1 cm, pitch 2 cm, bending length 5 cm.
///
/// # Panics
/// If its equilibrium is not found, or if without weight it is not the helix.
pub fn known_helix() -> Hanging {
    let (radius, rise) = (HELIX_RADIUS, HELIX_PITCH / TAU);
    let square = radius * radius + rise * rise;
    // The frame of Frenet at the start: normal, binormal, tangent.
    let tangent = DVec3::new(radius, -rise, 0.0).normalize();
    let normal = DVec3::NEG_Z;
    let root = DQuat::from_mat3(&glam::DMat3::from_cols(normal, tangent.cross(normal), tangent));
    let rod = Kirchhoff {
        length: HELIX_LENGTH,
        bending: G * HELIX_BENDING.powi(3),
        twist_ratio: 0.77,
        natural: DVec3::new(0.0, radius / square, -rise / square),
        gravity: DVec3::new(0.0, -G, 0.0),
        steps: 4000,
    };
    let unloaded = Kirchhoff { gravity: DVec3::ZERO, ..rod }.loaded(root, 1).expect("unloaded").1;
    assert!(unloaded.distance(helix_at_rest(2000).positions[1999]) < 1e-5, "{unloaded}");
    let (_, tip) = rod.loaded(root, 60).expect("a path without a turn");
    Hanging { tip, longer: -tip.y / helix_height() }
}

/// The same of so many vertices, after five seconds.
pub fn helix(vertices: usize) -> Hanging {
    let tip = tip(&settled(&step(1.0 / 60.0, HELIX_BENDING), &helix_at_rest(vertices), 5.0));
    Hanging { tip, longer: -tip.y / helix_height() }
}

fn helix_height() -> f64 {
    let rise = HELIX_PITCH / TAU;
    rise / HELIX_RADIUS.hypot(rise) * HELIX_LENGTH
}

fn helix_at_rest(vertices: usize) -> RodRest {
    let rise = HELIX_PITCH / TAU;
    let angle = HELIX_LENGTH / HELIX_RADIUS.hypot(rise);
    let at = |i: usize| {
        let t = angle * i as f64 / (vertices - 1) as f64;
        DVec3::new(HELIX_RADIUS * t.sin(), -rise * t, HELIX_RADIUS * t.cos())
    };
    RodRest::new(&(0..vertices).map(at).collect::<Vec<_>>(), 0)
}

/// How far a rod that is naturally an arc of `arc` radians, and hangs from a clamp that points down, is out of its plane where a
/// thousandth of the weight pulls it out; as a share of its length. `ratio` is the length over the bending length.
pub fn arc_aside(arc: f64, ratio: f64) -> f64 {
    // From the plane of the arc, x and y, a thousandth of the weight pulls it along z.
    let vertices = 96;
    let radius = LENGTH / arc;
    let at = |i: usize| {
        let t = arc * i as f64 / (vertices - 1) as f64;
        DVec3::new(radius * (1.0 - t.cos()), -radius * t.sin(), 0.0)
    };
    let rest = RodRest::new(&(0..vertices).map(at).collect::<Vec<_>>(), 0);
    let pull = RodStep { gravity: DVec3::new(0.0, -G, 1e-3 * G), ..step(1.0 / 60.0, LENGTH / ratio) };
    (tip(&settled(&pull, &rest, 12.0)).z / LENGTH).abs()
}

/// A straight rod without weight that is bent to a ring, both ends held; its twist from end to end, in parts of what it is given,
/// four seconds after it was brought to this share of Michell's threshold and pushed a little.
pub fn twist_of_a_ring(vertices: usize, share: f64) -> f64 {
    let radius = LENGTH / TAU;
    let at = |i: usize| {
        let t = TAU * i as f64 / (vertices - 1) as f64;
        radius * DVec3::new(1.0 - t.cos(), 0.0, t.sin())
    };
    let mut rest = RodRest::new(&(0..vertices).map(at).collect::<Vec<_>>(), 0);
    let mut rod = Rod::at_rest(&rest, DQuat::IDENTITY);
    rest.joints.fill(DQuat::IDENTITY);
    let goal = share * threshold::michell(0.77);
    for i in 0..1680 {
        let turn = goal * (f64::from(i) / 1080.0).min(1.0);
        let push = if (1080..1140).contains(&i) { DVec3::new(0.0, 0.05, 0.03) } else { DVec3::ZERO };
        let frame = Some(DQuat::from_rotation_z(turn));
        let held = RodStep {
            gravity: push,
            drag: [20.0; 2],
            damping: 1e-3,
            tip: Some(TipHold { place: DVec3::ZERO, frame }),
            ..step(SUB_STEP, 0.1)
        };
        direct(&held, &rest, &mut rod);
    }
    rod.strains.iter().map(|strain| strain.z).sum::<f64>() / goal
}

/// How far an upright strand leans after eight seconds, as a share of what a push of half a second made it lean by. It is near 0 where
/// the strand stands, and grows where it falls. `ratio` is the length over the bending length.
pub fn lean(ratio: f64) -> f64 {
    let rest = line(32, DVec3::Y);
    let step = RodStep { drag: [5.0; 2], ..step(1.0 / 60.0, LENGTH / ratio) };
    let mut rod = Rod::at_rest(&rest, DQuat::IDENTITY);
    run(&RodStep { gravity: DVec3::new(0.05, -G, 0.0), ..step }, &rest, &mut rod, 0.5);
    let pushed = tip(&rod).x;
    run(&step, &rest, &mut rod, 8.0);
    tip(&rod).x / pushed
}
