//! Judges a case.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::panic::{AssertUnwindSafe, catch_unwind};

use glam::{Quat, Vec4};
use tressfx_core::strands::Strands;
use tressfx_sim::SimParams;
use tressfx_sim::metrics::{self, SHORTEST_EDGE};

use crate::case::{Case, Part, SolverName};
use crate::energy::{Ledger, ROUNDINGS};
use crate::gpu::Gpu;
use crate::player::{CALM, Phase, Sight, play};
use crate::verdict::{Trouble, Verdict};

/// The worst edge error that `Direct` may have, of the edge's length, beyond rounding.
const EDGE: f64 = 2e-5;
/// How far a root may be from where the head has it, of its distance from the centre.
const ROOT: f64 = 1e-5;
/// The most energy that `Direct` may gain, of a fall by the length.
pub const ENERGY: f64 = 2e-3;
/// By how much tips may be faster than what is free to fall: the end of a whip is.
const WHIP: f64 = 3.0;

/// Plays the part of a case on a device and judges it. A case that panics or fails is judged so, and the device is opened anew.
///
/// # Errors
/// The device cannot be opened any more.
pub fn judge(gpu: &mut Gpu, seed: u64, solver: SolverName, part: Part) -> anyhow::Result<Verdict> {
    let judged = catch_unwind(AssertUnwindSafe(|| {
        let case = Case::new(seed, solver, part).map_err(|error| error.to_string())?;
        let mut judge = Judge::new(&case);
        let played = play(&mut *gpu.backend, &case, &mut |sight| judge.see(sight));
        let broken = played.err().map(|error| Trouble::Broken(error.to_string()));
        Ok::<_, String>(Verdict { troubles: judge.troubles(broken), ..judge.verdict })
    }));
    let failed = |trouble| Verdict { troubles: vec![trouble], ..Verdict::default() };
    let verdict = match judged {
        Ok(Ok(verdict)) => verdict,
        Ok(Err(message)) => failed(Trouble::Broken(message)),
        Err(panic) => failed(Trouble::Panic(message_of(&*panic))),
    };
    if verdict.troubles.iter().any(|trouble| matches!(trouble, Trouble::Panic(_) | Trouble::Broken(_))) {
        gpu.reopen()?;
    }
    Ok(verdict)
}

fn message_of(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_default()
}

struct Judge<'a> {
    case: &'a Case,
    verdict: Verdict,
    ledger: Option<Ledger<'a>>,
    /// After the frame before.
    last: Vec<Vec4>,
    /// Speeds of the guides when the calm begins, m/s.
    speeds: Option<Vec<f64>>,
    restless: f64,
    root: f64,
    unasked: bool,
    hasher: DefaultHasher,
}

impl<'a> Judge<'a> {
    fn new(case: &'a Case) -> Self {
        let verdict = Verdict { strands: case.strands.strand_count().into(), ..Verdict::default() };
        Self {
            case,
            verdict,
            ledger: None,
            last: Vec::new(),
            speeds: None,
            restless: 0.0,
            root: 0.0,
            unasked: false,
            hasher: DefaultHasher::new(),
        }
    }

    fn see(&mut self, sight: &Sight) {
        self.count(sight);
        if sight.phase == Phase::Start && self.keeps_energy() {
            let Case { strands, params, solver, .. } = self.case;
            self.ledger = Some(Ledger::new(strands, params, *solver, sight.rotation, sight.center));
            self.verdict.energy = Some(0.0);
        }
        if sight.phase == Phase::Look && sight.report.sub_steps == 1 {
            self.see_sub_step(sight);
        }
        self.last.clear();
        self.last.extend_from_slice(sight.positions);
    }

    /// Whether no energy can come from anywhere: nothing happens, and the joints want the pose that the strands begin in.
    fn keeps_energy(&self) -> bool {
        self.case.script.is_left_alone && (self.case.solver == SolverName::Tressfx || self.case.params.sag_free == 0.0)
    }

    fn count(&mut self, sight: &Sight) {
        let verdict = &mut self.verdict;
        verdict.sub_steps += u64::from(sight.report.sub_steps);
        verdict.teleports += u64::from(sight.report.teleported);
        verdict.resets = sight.non_finite.into();
        verdict.non_finite += metrics::non_finite(sight.positions) as u64;
        verdict.edge = verdict.edge.max(worst_edge(&self.case.strands, sight.positions));
        self.unasked |= sight.report.reset && !sight.report.teleported && !sight.asked_for_reset;
        bytemuck::cast_slice::<Vec4, u8>(sight.positions).hash(&mut self.hasher);
        verdict.fingerprint = self.hasher.finish();
    }

    /// What strands do in a single sub-step of a head that does not move.
    fn see_sub_step(&mut self, sight: &Sight) {
        let gained = self.ledger.as_ref().map(|ledger| ledger.most_gained(&self.last, sight.positions, sight.sub_step));
        self.verdict.energy = self.verdict.energy.zip(gained).map(|(most, gained)| most.max(gained));
        if sight.calm == 0.0 {
            return;
        }
        let speeds = speeds(&self.case.strands, &self.last, sight, |_, _| true);
        let fastest = speeds.iter().copied().fold(0.0, f64::max);
        let at_first = self.speeds.get_or_insert_with(|| speeds.clone());
        if sight.calm < CALM {
            return;
        }
        let carried = self::speeds(&self.case.strands, &self.last, sight, is_held);
        let bounds = at_first.iter().enumerate().map(|(guide, first)| {
            let before = Before { first: *first, calm: sight.calm, sub_step: sight.sub_step };
            speeds[guide] / (allowed_speed(self.case, sight.params, guide, &before) + WHIP * carried[guide])
        });
        self.restless = bounds.fold(0.0, f64::max);
        self.verdict.rest_speed = Some(fastest);
        if !self.case.script.own_roots {
            self.root = worst_root(&self.case.strands, sight);
        }
    }

    fn troubles(&self, broken: Option<Trouble>) -> Vec<Trouble> {
        let verdict = &self.verdict;
        // What the published method promises is no more than that.
        let is_exact = self.case.solver == SolverName::Direct;
        let over = |value: f64, most: f64| value > most || value.is_nan();
        let rests = self.case.script.resting_on.is_empty();
        let energy = verdict.energy.unwrap_or(0.0);
        [
            (verdict.non_finite > 0, Trouble::NonFinite(verdict.non_finite)),
            (verdict.resets > 0, Trouble::Resets(verdict.resets as u32)),
            (self.unasked, Trouble::UnaskedReset),
            (over(self.root, ROOT), Trouble::Root(self.root)),
            (is_exact && over(verdict.edge, EDGE), Trouble::Edge(verdict.edge)),
            (is_exact && over(energy, ENERGY), Trouble::Energy(energy)),
            (is_exact && rests && over(self.restless, 1.0), Trouble::Restless(self.restless)),
        ]
        .into_iter()
        .filter_map(|(is_wrong, trouble)| is_wrong.then_some(trouble))
        .chain(broken)
        .collect()
    }
}

/// The rounding of the coordinates of a strand.
fn rounding(strand: &[Vec4]) -> f64 {
    let farthest = strand.iter().map(|place| place.truncate().abs().max_element()).fold(0.0, f32::max);
    ROUNDINGS * f64::from(f32::EPSILON) / 2.0 * f64::from(farthest)
}

/// The largest error of an edge, of its length, beyond the rounding of its ends.
fn worst_edge(strands: &Strands, positions: &[Vec4]) -> f64 {
    let vertices = strands.vertices as usize;
    let mut worst = 0.0_f64;
    for (strand, lengths) in positions.chunks(vertices).zip(strands.rest_lengths.chunks(vertices)) {
        let (shortest, rounding) = (SHORTEST_EDGE * lengths.iter().sum::<f32>(), rounding(strand));
        for (edge, &rest) in strand.windows(2).zip(lengths).filter(|(_, rest)| **rest > shortest) {
            let length = edge[1].truncate().as_dvec3().distance(edge[0].truncate().as_dvec3());
            let error = ((length - f64::from(rest)).abs() - rounding).max(0.0) / f64::from(rest);
            worst = worst.max(if length.is_finite() { error } else { f64::INFINITY });
        }
    }
    worst
}

/// The highest speed of a vertex of each guide in a sub-step, beyond rounding, m/s; of those at the root for which `counts` says so.
fn speeds(strands: &Strands, before: &[Vec4], sight: &Sight, counts: fn(usize, &Vec4) -> bool) -> Vec<f64> {
    let vertices = strands.vertices as usize;
    let pairs = before.chunks(vertices).zip(sight.positions.chunks(vertices)).take(strands.guides as usize);
    let speed = |(before, after): (&[Vec4], &[Vec4])| {
        let counted = after.iter().enumerate().take_while(|(vertex, place)| counts(*vertex, place));
        let moved = before
            .iter()
            .zip(counted)
            .map(|(before, (_, after))| before.truncate().as_dvec3().distance(after.truncate().as_dvec3()));
        let moved = (moved.fold(0.0, f64::max) - rounding(after)).max(0.0);
        moved / sight.sub_step * f64::from(strands.metres_per_unit)
    };
    pairs.map(speed).collect()
}

/// Whether a vertex is the root, or is held by it as those before it are.
fn is_held(vertex: usize, place: &Vec4) -> bool {
    vertex == 0 || place.w == 0.0
}

/// The rate at which a solver's air takes speed away, 1/s.
fn drag(solver: SolverName, params: &SimParams) -> f64 {
    f64::from(match solver {
        SolverName::Direct => params.air_drag * params.air_drag_along,
        SolverName::Tressfx => 60.0 * params.damping,
    })
}

/// What is known of a guide that nothing has happened to for a while.
struct Before {
    /// Its speed at first, m/s.
    first: f64,
    /// How long nothing has happened, and the length of a sub-step, s.
    calm: f64,
    sub_step: f64,
}

impl Before {
    /// What is left of a speed that air takes away at the rate `drag`, of which a swing loses half: `exp(-z)` in a sub-step, with half of
    /// drag times sub-step as `z`. No formula in time is as fast where that is more than 1: that of first order leaves `1 / (1 + z)`, which
    /// is more than the exponential for any `z`, and that of second order `1 / sqrt(3 + 2 z)`, the roots of
    /// `(3 / 2 + z) r^2 - 2 r + 1 / 2`.
    fn left(&self, drag: f64) -> f64 {
        let z = 0.5 * drag * self.sub_step;
        let in_a_sub_step = (1.0 / (1.0 + z)).max(1.0 / (3.0 + 2.0 * z).sqrt());
        in_a_sub_step.powf(self.calm / self.sub_step)
    }
}

/// How fast a guide may be whose root stands still, m/s:
///
/// * what moved at first swings on, see [`Before::left`];
/// * what falls has no more than a fall by twice its length gives, nor than where drag and weight balance;
/// * what creeps back at a rate `r`, since drag is stronger than its springs, has `r exp(-r t) x`, which is at most `x / (e t)`,
///   with `x` no more than twice the length.
fn allowed_speed(case: &Case, params: &SimParams, guide: usize, before: &Before) -> f64 {
    let vertices = case.strands.vertices as usize;
    let lengths = &case.strands.rest_lengths[guide * vertices..(guide + 1) * vertices];
    let length = lengths.iter().map(|&length| f64::from(length)).sum::<f64>() * f64::from(case.strands.metres_per_unit);
    let (drag, gravity) = (drag(case.solver, params), f64::from(params.gravity.length()));
    let swing = before.first * before.left(drag);
    let fall = (4.0 * gravity * length).sqrt().min(2.0 * gravity / drag);
    let creep = 2.0 * length / (std::f64::consts::E * before.calm);
    WHIP * (swing + fall + creep) + f64::MIN_POSITIVE
}

/// How far a root is from where the head has it, of its distance from the centre, beyond rounding.
fn worst_root(strands: &Strands, sight: &Sight) -> f64 {
    let vertices = strands.vertices as usize;
    let rotation: Quat = sight.rotation;
    let pairs = strands.rest.chunks(vertices).zip(sight.positions.chunks(vertices));
    let off = pairs.filter(|(rest, _)| rest[0].w == 0.0).map(|(rest, strand)| {
        let place = rotation.as_dquat() * (rest[0].truncate() - sight.center).as_dvec3();
        let away = place.distance(strand[0].truncate().as_dvec3()) - rounding(&strand[..1]);
        away.max(0.0) / place.length().max(f64::MIN_POSITIVE)
    });
    off.fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_are_off_by_what_they_are_off_by_beyond_rounding() {
        let case = Case::new(0, SolverName::Direct, Part::ALL).unwrap();
        let strands = Strands { rest_lengths: vec![0.5, 0.0], vertices: 2, guides: 1, ..case.strands };
        let edge = |length: f32| worst_edge(&strands, &[Vec4::ZERO, Vec4::X * length]);
        assert_eq!(edge(0.5), 0.0);
        assert!((edge(0.55) - 0.1).abs() < 1e-4);
        let far = |length: f32| worst_edge(&strands, &[Vec4::X * 1000.0, Vec4::X * (1000.0 + length)]);
        assert_eq!(far(0.50005), 0.0, "1 km from the centre nothing is known better");
        assert_eq!(edge(f32::NAN), f64::INFINITY);
    }

    #[test]
    fn what_drags_more_has_to_be_slower() {
        let case = Case::new(0, SolverName::Direct, Part::ALL).unwrap();
        let at = |air_drag: f32| {
            let params = SimParams { air_drag, air_drag_along: 1.0, ..SimParams::default() };
            allowed_speed(&case, &params, 0, &Before { first: 10.0, calm: 0.5, sub_step: 1.0 / 120.0 })
        };
        assert!(at(0.0) > 30.0 && at(20.0) < at(5.0) && at(5.0) < at(0.0));
    }

    #[test]
    fn what_is_left_of_a_speed_is_what_the_formulas_in_time_leave() {
        for drag in [0.0, 1.0, 60.0, 1000.0] {
            let (sub_step, sub_steps) = (0.02, 25);
            let z: f64 = 0.5 * drag * sub_step;
            let (mut first, mut second, mut before) = (1.0_f64, 1.0 / (1.0 + z), 1.0_f64);
            let mut largest = 0.0_f64;
            for _ in 0..sub_steps {
                first /= 1.0 + z;
                (second, before) = ((2.0 * second - 0.5 * before) / (1.5 + z), second);
                largest = second.abs().max(before.abs());
            }
            let left = Before { first: 1.0, calm: 0.5, sub_step }.left(drag);
            assert!(left >= first * (1.0 - 1e-9), "{drag}: {left} {first}");
            assert!(left >= 0.1 * largest, "{drag}: {left} {largest}");
            assert!(left <= 10.0 * first.max(largest), "{drag}: {left} is more than {first} and {largest}");
        }
    }
}
