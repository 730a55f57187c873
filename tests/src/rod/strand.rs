//! A strand in the `Direct` solver's f64 function, for tests: its shape, its material, its motion.

use glam::{DQuat, DVec3};
use tressfx_sim::reference::direct::{Rod, RodRest, RodStep, direct};

use super::G;

/// The length of the strands that [`line()`] makes, m.
pub const LENGTH: f64 = 0.2;

/// Vertices on a straight line from the origin, the first of which is pinned.
pub fn line(vertices: usize, direction: DVec3) -> RodRest {
    let at = |i: usize| direction.normalize() * (LENGTH * i as f64 / (vertices - 1) as f64);
    RodRest::new(&(0..vertices).map(at).collect::<Vec<_>>(), 0)
}

/// A sub-step of hair of this bending length in metres, in still air that does not hold it.
pub fn step(length: f64, bending_length: f64) -> RodStep<'static> {
    let gravity = DVec3::new(0.0, -G, 0.0);
    let bending = G * bending_length.powi(3);
    RodStep { length, gravity, bending, twist_ratio: 0.77, ..RodStep::default() }
}

/// So many seconds.
pub fn run(step: &RodStep, rest: &RodRest, rod: &mut Rod, seconds: f64) {
    for _ in 0..(seconds / step.length).round() as usize {
        direct(step, rest, rod);
    }
}

/// At rest in its file's pose, then so many seconds of still air that takes its motion away.
pub fn settled(step: &RodStep, rest: &RodRest, seconds: f64) -> Rod {
    let mut rod = Rod::at_rest(rest, step.root);
    run(&RodStep { drag: [20.0; 2], ..*step }, rest, &mut rod, seconds);
    rod
}

/// Its last vertex.
///
/// # Panics
/// If the rod has none.
pub fn tip(rod: &Rod) -> DVec3 {
    *rod.positions.last().expect("a tip")
}

/// Turns the edges so that the vertices are as far to the side (along x) of a strand that hangs straight down as `aside` says of
/// their distance from the root over the length.
pub fn bend(rest: &RodRest, rod: &mut Rod, aside: impl Fn(f64) -> f64) {
    let edges = rest.lengths.len();
    let share = |i: usize| aside(i as f64 / edges as f64);
    for edge in 0..edges {
        let slope = (share(edge + 1) - share(edge)) / rest.lengths[edge];
        let there = DVec3::new(slope, -(1.0 - slope * slope).sqrt(), 0.0);
        rod.frames[edge] = DQuat::from_rotation_arc(rod.frames[edge] * DVec3::Z, there) * rod.frames[edge];
    }
    rod.place(rest);
}

/// Energy of motion, of height and of bending.
pub fn energy(step: &RodStep, rest: &RodRest, rod: &Rod) -> f64 {
    let vertex =
        |i: usize| rest.masses[i] * (0.5 * rod.velocities[i].length_squared() - step.gravity.dot(rod.positions[i]));
    let joint = |i: usize| {
        let weights = DVec3::new(1.0, 1.0, step.twist_ratio);
        0.5 * step.bending * rest.stiffening / rest.spans[i] * (rod.strains[i] * rod.strains[i]).dot(weights)
    };
    let turning = |i: usize| {
        // Mass along an edge has less energy of turning than mass at its ends.
        let difference = (rod.velocities[i + 1] - rod.velocities[i]).length_squared();
        -rest.mass_correction() * rest.lengths[i] / 12.0 * difference
    };
    let edges = (0..rest.lengths.len()).map(|i| joint(i) + turning(i));
    (0..rest.masses.len()).map(vertex).sum::<f64>() + edges.sum::<f64>()
}
