//! The rods of a section at rest.

use glam::{DVec3, Vec4};
use rayon::prelude::*;
use tressfx_core::strands::Strands;

use crate::params::SimParams;
use crate::reference::direct::{RodRest, RodStep};
use crate::step::bending;

/// How the strands of a section stand in the pose of their file under gravity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Standing {
    /// Guides whose bending length was raised, so that their pose is a stable equilibrium.
    pub raised: u32,
    /// The largest factor by which one was raised; 1 where none was.
    pub largest_factor: f32,
    /// Guides that do not stand at any stiffness that was tried; they sag.
    pub fallen: u32,
}

impl Standing {
    fn count(&mut self, rest: &RodRest, stands: bool) {
        let factor = rest.stiffening.cbrt() as f32;
        self.raised += u32::from(stands && factor > 1.0);
        self.fallen += u32::from(!stands);
        self.largest_factor = self.largest_factor.max(factor);
    }
}

/// Guides that are looked at one after the other, since they need about the same.
const NEIGHBOURS: usize = 16;
/// Rods that are held in f64 at the same time; a million would take gigabytes.
const AT_ONCE: usize = 4096;

/// The rods of a section at rest, as the kernel takes them.
#[derive(Debug)]
pub(crate) struct GpuRods {
    /// `(2 * vertex + entry) * guides + guide`: half of the rotation that the joint before the edge wants, the fourth component of
    /// which gives way to the edge's length, and the edge's frame at rest. The tip has no edge; it has what the strand's bending is
    /// multiplied by, how many edges the root holds, the shortest length that bends, and the mass that hangs on a pinned tip (0 on a free
    /// one), and then the length of the strand.
    pub(crate) entries: Vec<Vec4>,
    pub(crate) standing: Standing,
}

impl GpuRods {
    pub(crate) fn new(strands: &Strands, params: &SimParams) -> Self {
        let (guides, vertices) = (strands.guides as usize, strands.vertices as usize);
        let mut entries = vec![Vec4::ZERO; 2 * guides * vertices];
        let mut standing = Standing { largest_factor: 1.0, ..Standing::default() };
        for first in (0..guides).step_by(AT_ONCE) {
            let some = first..(first + AT_ONCE).min(guides);
            let neighbours = |some: Vec<usize>| {
                let mut power = 0;
                some.into_iter().map(move |guide| rod_rest_near(strands, params, guide, &mut power))
            };
            let rods: Vec<_> = some.into_par_iter().chunks(NEIGHBOURS).flat_map_iter(neighbours).collect();
            for (guide, (rest, stands)) in (first..).zip(rods) {
                standing.count(&rest, stands);
                let mut set = |vertex: usize, entry: usize, value: Vec4| {
                    entries[(2 * vertex + entry) * guides + guide] = value;
                };
                for edge in 0..vertices - 1 {
                    let length = strands.rest_lengths[guide * vertices + edge];
                    set(edge, 0, Vec4::from(rest.joints[edge].as_quat()).truncate().extend(length));
                    set(edge, 1, rest.frames[edge].as_quat().into());
                }
                let pinned = rest.held + 1 < vertices && strands.rest[(guide + 1) * vertices - 1].w == 0.0;
                let shortest = rest.spans.iter().copied().fold(f64::INFINITY, f64::min);
                let hung = if pinned { rest.tip_mass() as f32 } else { 0.0 };
                set(vertices - 1, 0, Vec4::new(rest.stiffening as f32, rest.held as f32, shortest as f32, hung));
                // Rounded up: it is a bound.
                set(vertices - 1, 1, Vec4::X * (rest.lengths.iter().sum::<f64>() as f32).next_up());
            }
        }
        Self { entries, standing }
    }
}

/// A guide's rod at rest, in the unit of the file, and whether it stands.
pub(crate) fn rod_rest(strands: &Strands, params: &SimParams, guide: usize) -> (RodRest, bool) {
    rod_rest_near(strands, params, guide, &mut 0)
}

/// The same, where it may need about this power, see [`RodRest::stand_near`].
fn rod_rest_near(strands: &Strands, params: &SimParams, guide: usize, power: &mut i32) -> (RodRest, bool) {
    let vertices = strands.vertices as usize;
    let points = &strands.rest[guide * vertices..(guide + 1) * vertices];
    let held = points.iter().take_while(|point| point.w == 0.0).count().saturating_sub(1);
    let places: Vec<DVec3> = points.iter().map(|point| point.truncate().as_dvec3()).collect();
    let mut rest = RodRest::new(&places, held);
    let metres = f64::from(strands.metres_per_unit);
    let step = RodStep {
        gravity: params.gravity.as_dvec3() / metres,
        bending: bending(params, strands.metres_per_unit),
        twist_ratio: params.twist_ratio.into(),
        ..RodStep::default()
    };
    let wanted = rest.clone();
    let stands = rest.stand_near(&step, params.sag_free.into(), power);
    if stands { (rest, true) } else { (wanted, false) }
}

#[cfg(test)]
mod tests {
    use tressfx_core::asset::{AssetFormat, HairAsset};
    use tressfx_core::strands::StrandOptions;

    use super::*;

    const VERTICES: usize = 8;

    /// Strands that lean to all sides, from 2 to 40 cm long, soft beside stiff.
    fn leaning(guides: usize) -> Strands {
        let points = (0..guides * VERTICES).map(|i| {
            let (guide, vertex) = (i / VERTICES, (i % VERTICES) as f32 / (VERTICES - 1) as f32);
            let length = 0.02 + 0.38 * ((guide * 7) % guides) as f32 / guides as f32;
            let angle = guide as f32;
            let lean = 0.1 + 0.9 * ((guide * 5) % guides) as f32 / guides as f32;
            [vertex * length * lean * angle.cos(), vertex * length, vertex * vertex * length * lean * angle.sin()]
        });
        let asset = HairAsset::new("leaning", AssetFormat::Builtin, points.collect(), vec![VERTICES as u32; guides]);
        let options = StrandOptions { metres_per_unit: Some(1.0), ..StrandOptions::default() };
        Strands::new(&asset, &options).unwrap()
    }

    /// Where a rod begins to look for its stiffness, and which of them are looked at beside each other, changes nothing of it.
    #[test]
    fn the_rods_of_a_section_are_those_of_each_guide_for_itself() {
        let (strands, params) = (leaning(3 * NEIGHBOURS + 5), SimParams { sag_free: 1.0, ..SimParams::default() });
        let guides = strands.guides as usize;
        let rods = GpuRods::new(&strands, &params);
        let mut standing = Standing { largest_factor: 1.0, ..Standing::default() };
        let mut stiffenings = std::collections::BTreeSet::new();
        for guide in 0..guides {
            let (rest, stands) = rod_rest(&strands, &params, guide);
            standing.count(&rest, stands);
            stiffenings.insert(rest.stiffening.to_bits());
            let at = |vertex: usize, entry: usize| rods.entries[(2 * vertex + entry) * guides + guide];
            for edge in 0..VERTICES - 1 {
                assert_eq!(
                    at(edge, 0).truncate(),
                    Vec4::from(rest.joints[edge].as_quat()).truncate(),
                    "guide {guide}, edge {edge}"
                );
                assert_eq!(at(edge, 1), Vec4::from(rest.frames[edge].as_quat()), "guide {guide}, edge {edge}");
            }
            assert_eq!(at(VERTICES - 1, 0).x, rest.stiffening as f32, "guide {guide}");
        }
        assert_eq!(rods.standing, standing);
        assert!(stiffenings.len() > 4, "neighbours need more than a few powers: {stiffenings:?}");
    }
}
