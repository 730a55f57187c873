//! How much light comes through the strands, and past what is opaque.

use std::ops::ControlFlow;

use glam::DVec3;

use crate::cone::RoundCone;
use crate::fibres::Fibres;
use crate::opaque::Opaque;
use crate::rays::Ray;
use crate::tree::{Boxes, Tree};

/// Less light than this counts as none.
const DARK: f64 = 1e-4;

/// After so many crossings, or a quarter more than there were, it is looked at whether light is left.
const BETWEEN: usize = 16;

/// Strands and meshes in the way of light.
#[derive(Debug)]
pub(crate) struct Shadows {
    strands: Tree,
    opaque: Opaque,
    /// Of each section its first strand, and what a crossing of one of its strands lets through.
    sections: Vec<(u32, f64)>,
}

/// Where a ray towards light begins: a point on the axis of a fibre.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Start {
    pub(crate) point: DVec3,
    /// Of the fibre there.
    pub(crate) radius: f64,
    pub(crate) strand: u32,
}

/// The part of a ray in one segment.
#[derive(Clone, Copy, Debug)]
struct Crossing {
    strand: u32,
    enter: f64,
    exit: f64,
}

/// What a thread keeps from ray to ray.
#[derive(Debug, Default)]
pub(crate) struct ShadowWork {
    stack: Vec<u32>,
    crossings: Vec<Crossing>,
    /// Rays so far.
    pub(crate) rays: u64,
}

impl Shadows {
    /// `through` is what a crossing lets through, 0 to 1, of each section.
    pub(crate) fn new(fibres: &Fibres, through: &[f64], opaque: Opaque) -> Self {
        let mut boxes = Boxes::with_capacity(fibres.end() as usize);
        for segment in 0..fibres.end() {
            if let Some(RoundCone { a, radius_a, b, radius_b }) = fibres.cone(segment) {
                boxes.push((a - radius_a).min(b - radius_b), (a + radius_a).max(b + radius_b), segment);
            }
        }
        let sections = fibres.parts().iter().zip(through).map(|(part, &through)| (part.strands.start, through));
        Self { strands: Tree::new(boxes), opaque, sections: sections.collect() }
    }

    /// The share of light that comes from the direction `towards`, of length 1, from no further than `end`.
    ///
    /// What is opaque counts from the surface of the fibre on, since a mesh that a fibre grows on goes through its axis.
    pub(crate) fn light(&self, work: &mut ShadowWork, fibres: &Fibres, start: &Start, towards: DVec3, end: f64) -> f64 {
        work.rays += 1;
        let ray = Ray { origin: start.point, direction: towards };
        if self.is_blocked(work, start, towards, end) {
            return 0.0;
        }
        let ShadowWork { stack, crossings, .. } = work;
        crossings.clear();
        let mut next_look = BETWEEN;
        let stopped = self.strands.visit(stack, &ray, end, |segment| {
            crossings.extend(crossing(&ray, end, fibres, segment));
            if crossings.len() < next_look {
                return ControlFlow::Continue(());
            }
            next_look = crossings.len() + BETWEEN.max(crossings.len() / 4);
            match self.light_past_strands(crossings, start.strand) < DARK {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            }
        });
        let light = if stopped.is_break() { 0.0 } else { self.light_past_pieces(crossings, start.strand) };
        if light < DARK { 0.0 } else { light }
    }

    /// Whether what is opaque is in the way.
    pub(crate) fn is_blocked(&self, work: &mut ShadowWork, start: &Start, towards: DVec3, end: f64) -> bool {
        let ray = Ray { origin: start.point, direction: towards };
        self.opaque.blocks(&mut work.stack, &ray, start.radius, end)
    }

    /// What a crossing of a strand lets through.
    pub(crate) fn through(&self, strand: u32) -> f64 {
        let after = self.sections.partition_point(|(first, _)| *first <= strand);
        self.sections[after - 1].1
    }

    /// What is left if each strand but `own` counts once: not less than what is left in the end, whatever else is crossed.
    fn light_past_strands(&self, crossings: &mut [Crossing], own: u32) -> f64 {
        crossings.sort_unstable_by_key(|crossing| crossing.strand);
        let strands = crossings.chunk_by(|a, b| a.strand == b.strand).map(|same| same[0].strand);
        strands.filter(|&strand| strand != own).map(|strand| self.through(strand)).product()
    }

    /// What is left where each piece of a strand counts once. The piece of the strand `own` that the ray begins in does not.
    fn light_past_pieces(&self, crossings: &mut [Crossing], own: u32) -> f64 {
        crossings.sort_unstable_by(|a, b| a.strand.cmp(&b.strand).then(a.enter.total_cmp(&b.enter)));
        let mut light = 1.0;
        for same in crossings.chunk_by(|a, b| a.strand == b.strand) {
            let (strand, through) = (same[0].strand, self.through(same[0].strand));
            let mut reach = if strand == own { 0.0 } else { f64::NEG_INFINITY };
            for crossing in same {
                if crossing.enter > reach {
                    light *= through;
                }
                reach = reach.max(crossing.exit);
            }
        }
        light
    }
}

/// The part of a ray in a segment, if there is one between the origin and the parameter `end`.
fn crossing(ray: &Ray, end: f64, fibres: &Fibres, segment: u32) -> Option<Crossing> {
    let cone = fibres.cone(segment).filter(|cone| may_meet(ray, cone))?;
    let part = cone.interval(ray).filter(|part| part.exit > 0.0 && part.enter < end)?;
    Some(Crossing { strand: fibres.strand(segment), enter: part.enter, exit: part.exit })
}

/// Whether the line of a ray comes as near to that of the axis as a ball that it could meet: a quick look before the exact one.
/// What rounding may add is in proportion to the two lengths, and is all that there is where the lines are parallel.
fn may_meet(ray: &Ray, cone: &RoundCone) -> bool {
    const ROUNDING: f64 = 8.0 * f64::EPSILON;
    let (axis, from) = (cone.b - cone.a, cone.a - ray.origin);
    let across = ray.direction.cross(axis);
    let slack = ROUNDING * from.abs().element_sum() * axis.abs().element_sum();
    from.dot(across).abs() <= cone.radius_a.max(cone.radius_b) * (1.0 + ROUNDING) * across.length() + slack
}

#[cfg(test)]
mod tests {
    use tressfx_core::strand_buffers::StrandShape;
    use tressfx_core::view::{Camera, Pose};

    use crate::rays::Rays;
    use crate::section::Section;

    use super::*;

    /// Numbers in [0, 1) that are the same everywhere.
    struct Random(u32);

    impl Random {
        fn unit(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            f64::from(self.0 >> 8) / f64::from(1 << 24)
        }

        fn vector(&mut self) -> DVec3 {
            DVec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
        }
    }

    const VERTICES: u32 = 12;

    /// Strands that wander about in a cube, in two sections of so many.
    fn wandering(random: &mut Random, strands: u32) -> Fibres {
        let shape = StrandShape { guides: strands, follows: 0, vertices: VERTICES };
        let mut positions = vec![[0.0; 4]; (strands * VERTICES) as usize];
        for strand in 0..strands {
            let mut at = random.vector();
            for vertex in 0..VERTICES {
                // Some edges along an axis, some of no length.
                let step = [random.vector(), DVec3::X, DVec3::ZERO][[0, 0, 0, 1, 2][(random.unit() * 5.0) as usize]];
                at = (at + 0.3 * step).clamp(DVec3::NEG_ONE, DVec3::ONE);
                positions[shape.index(strand, vertex) as usize] = at.as_vec3().extend(1.0).to_array();
            }
        }
        let (colors, thickness) = (vec![[1.0; 4]; positions.len()], vec![1.0; positions.len()]);
        let section = |fibre_radius| Section {
            shape,
            pose: Pose::IDENTITY,
            positions: &positions,
            colors: &colors,
            thickness: &thickness,
            fibre_radius,
            tip_width: 1.0,
        };
        let view = Camera::around(&[glam::Vec3::ONE, glam::Vec3::NEG_ONE], [8, 8]).view([8, 8]).unwrap();
        Fibres::new(&Rays::new(&view), &[section(0.02), section(0.001)]).unwrap()
    }

    /// What light does past all segments, piece by piece: points of a piece are found by following what overlaps.
    fn light_past_all(fibres: &Fibres, through: [f64; 2], start: &Start, towards: DVec3, end: f64) -> f64 {
        let ray = Ray { origin: start.point, direction: towards };
        let strands = fibres.parts().iter().map(|part| part.strands.end).max().unwrap();
        let mut light = 1.0;
        for strand in 0..strands {
            let segments = strand * VERTICES..(strand + 1) * VERTICES - 1;
            let parts = segments.filter_map(|segment| fibres.cone(segment)?.interval(&ray));
            let mut parts: Vec<_> = parts.filter(|part| part.exit > 0.0 && part.enter < end).collect();
            while let Some(mut piece) = parts.pop() {
                let touching = |piece: &crate::cone::Interval, parts: &[crate::cone::Interval]| {
                    parts.iter().position(|part| part.enter <= piece.exit && piece.enter <= part.exit)
                };
                while let Some(found) = touching(&piece, &parts) {
                    let part = parts.swap_remove(found);
                    (piece.enter, piece.exit) = (piece.enter.min(part.enter), piece.exit.max(part.exit));
                }
                if strand != start.strand || piece.enter > 0.0 {
                    light *= through[usize::from(strand >= fibres.parts()[1].strands.start)];
                }
            }
        }
        light
    }

    #[test]
    fn the_tree_finds_what_a_look_at_every_segment_finds() {
        let mut random = Random(3);
        let fibres = wandering(&mut random, 60);
        let opaque = || Opaque::new(&Rays::new(&Camera::around(&[glam::Vec3::ONE], [8, 8]).view([8, 8]).unwrap()), &[]);
        let (mut bright, mut dark, mut work) = (0, 0, ShadowWork::default());
        for through in [[0.7, 0.9], [0.0, 1.0], [0.2, 0.05]] {
            let shadows = Shadows::new(&fibres, &through, opaque().unwrap());
            for i in 0..1000 {
                let segment = (random.unit() * f64::from(fibres.end())) as u32;
                let Some(cone) = fibres.cone(segment) else { continue };
                let point = cone.a.lerp(cone.b, random.unit());
                let start = Start { point, radius: cone.radius_a, strand: fibres.strand(segment) };
                // Along the axes and along the strand too.
                let towards = [random.vector(), DVec3::Z, DVec3::NEG_X, cone.b - cone.a][[0, 0, 0, 1, 2, 3][i % 6]];
                let Some(towards) = towards.try_normalize() else { continue };
                let end = if i % 2 == 0 { f64::INFINITY } else { 0.5 * random.unit() };
                let found = shadows.light(&mut work, &fibres, &start, towards, end);
                let expected = light_past_all(&fibres, through, &start, towards, end);
                let expected = if expected < DARK { 0.0 } else { expected };
                assert!((found - expected).abs() < 1e-12, "{i}: {found} is not {expected}");
                bright += u32::from(found > 0.0 && found < 1.0);
                dark += u32::from(found == 0.0);
            }
        }
        assert!(bright > 800 && dark > 300, "{bright} {dark}");
    }

    #[test]
    fn a_quick_look_keeps_all_that_is_met() {
        let mut random = Random(7);
        let (mut met, mut left_out) = (0, 0);
        for i in 0..40_000 {
            let radius = [0.3, 1e-3, 1e-6][i % 3];
            let (a, axis) = (random.vector(), random.vector() * [1.0, 1e-6, 0.0][i / 3 % 3]);
            let cone = RoundCone { a, radius_a: radius * random.unit(), b: a + axis, radius_b: radius * random.unit() };
            let through = a + axis * (1.4 * random.unit() - 0.2) + 1.5 * radius * random.vector();
            let direction = if i % 5 == 0 { axis } else { random.vector() };
            let Some(direction) = direction.try_normalize() else { continue };
            let ray = Ray { origin: through - 10.0 * random.unit() * direction, direction };
            let hit = cone.interval(&ray).is_some();
            assert!(!hit || may_meet(&ray, &cone), "{cone:?} is met by {ray:?}");
            met += u32::from(hit);
            left_out += u32::from(!may_meet(&ray, &cone));
        }
        assert!(met > 8000 && left_out > 8000, "{met} {left_out}");
    }
}
