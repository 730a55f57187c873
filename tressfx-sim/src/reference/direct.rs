//! `hair.sim.direct` in f64: a rod whose edges turn and never stretch.
//!
//! The unknowns of a sub-step are the rotations of the edges. Positions follow from them, so that edges keep their lengths to
//! rounding. Inertia, drag, bending and twist are all implicit (BDF2), and Newton's method solves for all rotations at once:
//! along a strand every joint only meets its neighbours, so that elimination goes from the tip to the root and back, as in
//! the dynamics of articulated bodies (Featherstone 1983). Bending and twist are those of a discrete elastic rod (Bergou,
//! Wardetzky, Robinson, Audoly, Grinspun 2008), with the frame of each edge stored (Spillmann, Teschner 2007, CoRdE).
//!
//! Forces are per mass of unit length: a metre of hair has the mass 1, and its bending stiffness is `bending`, m^4/s^2.

mod contact;
mod guide;
mod joint;
mod newton;
mod rest;
mod stand;

use glam::{DMat3, DQuat, DVec3};
use tressfx_core::strands::shortest_turn;

pub use contact::{FieldObstacle, Obstacle, Touch};
pub use guide::direct_guide;
pub use rest::RodRest;

/// An edge that is shorter than this share of its strand has no direction of its own.
const NO_EDGE: f64 = 1e-12;
/// Where an edge turns by more than this in the last round of a sub-step, rad, the rounds have not come to their end: the strand's past says
/// little about its future, and its velocities would be what is left undone. It keeps the share of them that this is of the turn. With a limit
/// of 0.5 and all of the velocities, 31 of 3,637 random cases without drag gained more than 0.2 % of the energy of a fall; now 11 do. What
/// touches something turns less in a round, and would not slide any more.
const TOO_FAST: f64 = 0.1;
/// There is another round where an edge turns by more than this, rad/s times the length of the sub-step,
const ANOTHER_ROUND: f64 = 4.0;
/// and in sub-steps shorter than this, s, by less, as the square of the sub-step: what a round leaves undone is a force that is
/// missing. With a constant limit strands gain energy where sub-steps are short, and the error falls only with the sub-step
/// itself.
const SHORT: f64 = 1.0 / 120.0;
/// The share of what the spring of a held tip leaves that the force which the tip has come to takes up in a sub-step. With all of it, a strand
/// that is pulled taut swings to and fro without end.
const TAKEN_UP: f64 = 0.125;
/// In sub-steps shorter than this, s, it is less, in proportion, and the spring is no stiffer: what is taken back within a shorter time, be it
/// rounding, throws folded strands about.
const AT_ONCE: f64 = 2e-3;
/// An edge whose ends move against each other by more than so many times its length is not aimed: the direction that it would get is no
/// guess at all. With half of the length fast bars go through strands that they push.
const NO_AIM: f64 = 2.0;
/// Nor is one that would be turned by more than what this cosine says,
const FOLDED: f64 = -0.99;
/// nor is one rolled that has rolled by more than this, rad.
const MOST_ROLL: f64 = 0.5;

/// Where something is touched, there are at least so many rounds, unless no edge turns by more than `SETTLED`, rad,
const TOUCHING_ROUNDS: u32 = 4;
/// and at most so many where an edge is deep inside a capsule.
const MOST_ROUNDS: u32 = 16;
const SETTLED: f64 = 1e-5;

/// How a rod moves during a sub-step. Lengths in the unit of the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RodStep<'a> {
    /// Length of the sub-step, s.
    pub length: f64,
    /// Acceleration by gravity, units/s^2.
    pub gravity: DVec3,
    /// Velocity of the air, units/s.
    pub wind: DVec3,
    /// Rate at which still air stops a strand that moves across itself and along itself, 1/s. A slender cylinder is dragged
    /// half as much along itself as across (Batchelor 1970). The direction of the hair is that at the beginning of a
    /// round: with less than a quarter along, soft tips of many vertices flutter in a steady wind.
    pub drag: [f64; 2],
    /// Stiffness of the spring to the rest pose that the root carries, over mass, 1/s^2.
    pub pull: f64,
    /// Bending stiffness over the mass of unit length, units^4/s^2.
    pub bending: f64,
    /// Twist stiffness over bending stiffness.
    pub twist_ratio: f64,
    /// Time by which bending moments lag behind, s: they damp as a force of `damping` times the rate of bending.
    pub damping: f64,
    /// The frame of the root at the end of the sub-step, on the axes of the world.
    pub root: DQuat,
    /// What the root moves by in the sub-step.
    pub root_displacement: DVec3,
    /// What holds the tip; `None` where it is free.
    pub tip: Option<TipHold>,
    /// What it may touch.
    pub obstacles: &'a [Obstacle],
    /// Signed distance fields that it may touch.
    pub fields: &'a [FieldObstacle<'a>],
    /// Coefficient of Coulomb friction.
    pub friction: f64,
    /// The most rounds of Newton's method.
    pub rounds: u32,
}

impl Default for RodStep<'_> {
    /// No time, no forces and no stiffness, on a root that stays where it is.
    fn default() -> Self {
        Self {
            length: 0.0,
            gravity: DVec3::ZERO,
            wind: DVec3::ZERO,
            drag: [0.0; 2],
            pull: 0.0,
            bending: 0.0,
            twist_ratio: 1.0,
            damping: 0.0,
            root: DQuat::IDENTITY,
            root_displacement: DVec3::ZERO,
            tip: None,
            obstacles: &[],
            fields: &[],
            friction: 0.0,
            rounds: 2,
        }
    }
}

/// What holds the tip of a rod.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TipHold {
    /// Where it is held, from the root.
    pub place: DVec3,
    /// The frame that it is clamped to; `None` where it may turn.
    pub frame: Option<DQuat>,
}

/// The state of a rod. Entry `i` of what belongs to edges is that of the edge from vertex `i` to the next one.
#[derive(Clone, Debug, PartialEq)]
pub struct Rod {
    /// Frame of each edge on the axes of the world: the third axis points along it.
    pub frames: Vec<DQuat>,
    /// Vertices from the root.
    pub positions: Vec<DVec3>,
    /// What each vertex moved by in the last sub-step, in the world.
    pub displacements: Vec<DVec3>,
    /// What it moved by one sub-step before.
    pub last_displacements: Vec<DVec3>,
    /// By how much each edge rolled about itself in the last sub-step, rad.
    pub rolls: Vec<f64>,
    /// Whether it came back in the last sub-step: turned against what it did one sub-step before.
    pub came_back: Vec<bool>,
    /// Whether anything was touched in the last round.
    pub is_touching: bool,
    /// Velocities after the last sub-step, in the world.
    pub velocities: Vec<DVec3>,
    /// Velocities one sub-step before.
    pub last_velocities: Vec<DVec3>,
    /// Bending and twist at the joint before each edge.
    pub strains: Vec<DVec3>,
    /// The same one sub-step before.
    pub last_strains: Vec<DVec3>,
    /// What each edge touches.
    pub touches: Vec<Touch>,
    /// The force that holds the tip, if it is held, times the square of the sub-step.
    pub holding: DVec3,
    /// By what the hair around it accelerates each vertex, on the axes of the world.
    pub pushes: Vec<DVec3>,
    /// Whether the past counts: not after a reset, after a change of the sub-step, or after an edge turned too fast.
    pub has_past: bool,
}

impl Rod {
    /// At rest in the pose of its file, on a root with this frame.
    pub fn at_rest(rest: &RodRest, root: DQuat) -> Self {
        let frames: Vec<_> = rest.frames.iter().map(|&frame| root * frame).collect();
        let zeros = vec![DVec3::ZERO; rest.lengths.len() + 1];
        let mut rod = Self {
            positions: zeros.clone(),
            displacements: zeros.clone(),
            last_displacements: zeros.clone(),
            rolls: vec![0.0; frames.len()],
            came_back: vec![false; frames.len()],
            is_touching: false,
            velocities: zeros.clone(),
            last_velocities: zeros.clone(),
            strains: vec![DVec3::ZERO; frames.len()],
            last_strains: vec![DVec3::ZERO; frames.len()],
            touches: vec![Touch::default(); frames.len()],
            holding: DVec3::ZERO,
            pushes: zeros.clone(),
            has_past: false,
            frames,
        };
        rod.place(rest);
        let strains = rod.strains_now(rest, root);
        (rod.last_strains, rod.strains) = (strains.clone(), strains);
        rod
    }

    /// Puts the vertices where the edges take them.
    pub fn place(&mut self, rest: &RodRest) {
        let mut place = DVec3::ZERO;
        for (edge, frame) in self.frames.iter().enumerate() {
            place += *frame * DVec3::Z * rest.lengths[edge];
            self.positions[edge + 1] = place;
        }
    }

    fn strains_now(&self, rest: &RodRest, root: DQuat) -> Vec<DVec3> {
        let parent = |edge: usize| if edge == 0 { root } else { self.frames[edge - 1] };
        let joints = self.frames.iter().enumerate();
        joints.map(|(edge, &frame)| joint::Joint::new(parent(edge), rest.joints[edge], frame).strain).collect()
    }
}

/// What the past says of a vertex: where it would be without forces, and how fast.
#[derive(Clone, Copy, Debug)]
struct Past {
    place: DVec3,
    velocity: DVec3,
}

/// The sub-step as the formula of second order has it, or that of first order where there is no past.
#[derive(Debug)]
struct Motion<'a> {
    step: &'a RodStep<'a>,
    rest: &'a RodRest,
    /// The length of the sub-step that the formula divides by, s.
    length: f64,
    past: Vec<Past>,
    /// Where the vertices were, from where the root is now.
    before: Vec<DVec3>,
    /// The strain that the past says, for the rate of bending.
    past_strains: Vec<DVec3>,
    /// Accelerations by gravity and by the hair around.
    accelerations: Vec<DVec3>,
    /// The direction of the hair at each vertex, which the drag asks for.
    along: Vec<DVec3>,
}

impl<'a> Motion<'a> {
    fn new(step: &'a RodStep<'a>, rest: &'a RodRest, rod: &Rod) -> Self {
        let length = if rod.has_past { step.length * 2.0 / 3.0 } else { step.length };
        let past = |i: usize| {
            let here = rod.positions[i] - step.root_displacement;
            match rod.has_past {
                true => Past {
                    place: here + rod.displacements[i] / 3.0,
                    velocity: (4.0 * rod.velocities[i] - rod.last_velocities[i]) / 3.0,
                },
                false => Past { place: here, velocity: rod.velocities[i] },
            }
        };
        let past_strain = |i: usize| match rod.has_past {
            true => (4.0 * rod.strains[i] - rod.last_strains[i]) / 3.0,
            false => rod.strains[i],
        };
        Self {
            step,
            rest,
            length,
            past: (0..rod.positions.len()).map(past).collect(),
            before: rod.positions.iter().map(|place| *place - step.root_displacement).collect(),
            past_strains: (0..rod.frames.len()).map(past_strain).collect(),
            accelerations: rod.pushes.iter().map(|push| step.gravity + push).collect(),
            along: vec![DVec3::ZERO; rod.positions.len()],
        }
    }

    /// Where a vertex would be with its velocity and gravity alone.
    fn free(&self, vertex: usize) -> DVec3 {
        let Past { place, velocity } = self.past[vertex];
        place + self.length * (velocity + self.length * self.accelerations[vertex])
    }

    /// The mass of a vertex with what acts on it in proportion to its place, times the square of the sub-step; and the force
    /// times that square.
    fn inertia(&self, vertex: usize, position: DVec3) -> (DMat3, DVec3) {
        let (step, mass, past) = (self.step, self.rest.masses[vertex], self.past[vertex]);
        let [across, along] = step.drag;
        let axis = self.along[vertex];
        let drag = self.length * (DMat3::from_diagonal(DVec3::splat(across)) + (along - across) * outer(axis, axis));
        let pull = self.length * self.length * step.pull;
        let goal = step.root * self.rest.positions[vertex];
        let blown = past.place + self.length * step.wind - position;
        let force = self.free(vertex) - position + drag * blown + pull * (goal - position);
        (mass * (DMat3::from_diagonal(DVec3::splat(1.0 + pull)) + drag), mass * force)
    }
}

fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

/// One sub-step; gives how many rounds of Newton's method it took.
pub fn direct(step: &RodStep, rest: &RodRest, rod: &mut Rod) -> u32 {
    let mut motion = Motion::new(step, rest, rod);
    aim(step, rest, rod);
    let (mut turned, mut rounds) = (0.0, 0);
    let mut touches = vec![Touch::default(); rod.frames.len()];
    for round in 1..=MOST_ROUNDS {
        motion.along = directions(rod);
        turned = newton::round(&motion, rod);
        rounds = round;
        rod.place(rest);
        touches.splice(rest.held.., (rest.held..rod.frames.len()).map(|edge| motion.touch(rod, edge)));
        let settled = turned < SETTLED;
        let touching = !settled && touches.iter().any(|touch| touch.obstacle > 0);
        let deep = !settled && touches.iter().any(|touch| touch.is_deep);
        let limit = ANOTHER_ROUND * step.length * (step.length / SHORT).min(1.0);
        let calm = turned < limit.min(TOO_FAST);
        if round >= if touching { TOUCHING_ROUNDS } else { 1 } && (calm || round >= step.rounds) && !deep {
            break;
        }
    }
    let is_too_fast = turned > TOO_FAST && !rod.is_touching;
    let calm = !is_too_fast && !touches.iter().any(|touch| touch.is_new);
    rod.touches = touches;
    finish(step, &motion, rod, calm, if is_too_fast { TOO_FAST / turned } else { 1.0 });
    rounds
}

/// The direction of the hair at each vertex: the mean of those of the edges beside it.
fn directions(rod: &Rod) -> Vec<DVec3> {
    let edge = |edge: usize| rod.frames.get(edge).map_or(DVec3::ZERO, |frame| *frame * DVec3::Z);
    let before = |vertex: usize| vertex.checked_sub(1).map_or(DVec3::ZERO, edge);
    (0..=rod.frames.len()).map(|vertex| (before(vertex) + edge(vertex)).normalize_or_zero()).collect()
}

/// The guess that Newton's method begins with: each edge is turned, the shortest way, to where its vertices would get with their
/// velocities, see [`NO_AIM`] and [`FOLDED`], and rolls on about itself. Where the root gets to moves the strand as a whole: an edge
/// that asked for it alone would be turned by what bends all that hangs on it.
///
/// An edge that came back twice in a row, in each of the last two sub-steps, is guessed to stay where it is. A round may go too far; where the guess goes on
/// the same way, the next round goes back as far, and a strand at rest would swing to and fro without end. Motion that sub-steps can follow turns back once.
/// Nothing shook in sub-steps of 1/120 s and less, and strands that touch something have other rounds.
fn aim(step: &RodStep, rest: &RodRest, rod: &mut Rod) {
    let free = |vertex: usize| rod.positions[vertex] + step.length * rod.velocities[vertex];
    let swings_back = |edge: usize| {
        let turned = |moved: &[DVec3]| moved[edge + 1] - moved[edge];
        turned(&rod.displacements).dot(turned(&rod.last_displacements)) < 0.0
    };
    let may_stay = step.length > 1.01 * SHORT && !rod.is_touching;
    let aimed = |edge: usize| {
        if may_stay && rod.has_past && rod.came_back[edge] && swings_back(edge) {
            return rod.frames[edge];
        }
        let here = rod.frames[edge] * DVec3::Z;
        let there = free(edge + 1) - free(edge);
        let apart = there.distance(rest.lengths[edge] * here);
        if apart >= NO_AIM * rest.lengths[edge] || there.dot(here) <= FOLDED * there.length() {
            return rod.frames[edge];
        }
        (shortest_turn(here, there.normalize()) * rod.frames[edge]).normalize()
    };
    let guess = |edge: usize| match edge < rest.held {
        true => step.root * rest.frames[edge],
        false => aimed(edge) * DQuat::from_xyzw(0.0, 0.0, 0.5 * rod.rolls[edge], 1.0).normalize(),
    };
    let came_back = (0..rod.frames.len()).map(swings_back).collect();
    rod.frames = (0..rod.frames.len()).map(guess).collect();
    rod.came_back = came_back;
    rod.place(rest);
}

/// The state that the next sub-step begins with. Of what vertices moved by past what holds them only the share `kept` counts as velocity.
fn finish(step: &RodStep, motion: &Motion, rod: &mut Rod, calm: bool, kept: f64) {
    std::mem::swap(&mut rod.velocities, &mut rod.last_velocities);
    std::mem::swap(&mut rod.displacements, &mut rod.last_displacements);
    let held = motion.rest.held;
    for (vertex, before) in motion.before.iter().enumerate() {
        let moved = rod.positions[vertex] - before;
        let displacement = if vertex > held { rod.displacements[held].lerp(moved, kept) } else { moved };
        rod.displacements[vertex] = displacement;
        rod.velocities[vertex] = match calm {
            true => (rod.positions[vertex] - motion.past[vertex].place) / motion.length,
            false => displacement / step.length,
        };
    }
    match step.tip {
        None => rod.holding = DVec3::ZERO,
        // Where the rounds have not come to their end, what is left says nothing of the force.
        Some(_) if !calm => {}
        Some(hold) => {
            let error = hold.place - rod.positions[motion.before.len() - 1];
            let taken_up = TAKEN_UP * (step.length / AT_ONCE).min(1.0);
            rod.holding += taken_up * newton::hold_stiffness(step, motion.rest) * error;
        }
    }
    rod.rolls.iter_mut().filter(|roll| roll.abs() > MOST_ROLL).for_each(|roll| *roll = 0.0);
    let strains = rod.strains_now(motion.rest, step.root);
    rod.last_strains = std::mem::replace(&mut rod.strains, strains);
    rod.has_past = calm;
}
