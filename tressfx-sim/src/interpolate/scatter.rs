//! Where render strands are: scattered over the triangles between guides.

use glam::{DVec3, UVec3, Vec2};
use tressfx_core::strands::Strands;

use super::BetweenGuides;
use super::desc::InterpolationParams;
use super::triangles::{Corners, triangles};

/// The powers of the plastic number with which points of a plane are spread evenly, any number of them (Roberts 2018, "The unreasonable effectiveness of quasirandom
/// sequences").
const SEQUENCE: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];

/// The guides of a groom, and the triangles between them.
pub(super) struct Guides<'a> {
    strands: &'a Strands,
    triangles: Vec<Corners>,
    /// Up to and with each triangle the share of strands.
    until: Vec<f64>,
}

impl<'a> Guides<'a> {
    /// Of the rest pose. There may be no triangle.
    pub(super) fn new(strands: &'a Strands) -> Self {
        let roots: Vec<DVec3> = strands.rest.chunks(strands.vertices as usize).map(|guide| point(guide[0])).collect();
        let directions: Vec<DVec3> = strands.root_directions.iter().map(|direction| direction.as_dvec3()).collect();
        let mut triangles = triangles(&roots, &directions);
        let middle = |corners: &Corners| corners.iter().map(|&corner| roots[corner as usize]).sum::<DVec3>() / 3.0;
        let low = roots.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let size = roots.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max) - low;
        // Along a curve that fills the space, so that strands that are spread over the triangles are spread over the groom.
        triangles.sort_by_cached_key(|corners| (along_curve((middle(corners) - low) / size.max_element()), *corners));
        let until = shares(&roots, &triangles);
        Self { strands, triangles, until }
    }

    pub(super) fn has_triangles(&self) -> bool {
        self.until.last().is_some_and(|&all| all > 0.0)
    }

    /// Strand `index` of any number: the first ones are an even sample of those that follow.
    pub(super) fn strand(&self, params: &InterpolationParams, index: u32) -> BetweenGuides {
        let start = unit(params.seed, 0);
        let [across, along] = SEQUENCE.map(|step| (f64::from(index + 1) * step + start).fract());
        let all = self.until.last().copied().unwrap_or(0.0);
        let at = across * all;
        let triangle = self.until.partition_point(|&until| until <= at).min(self.triangles.len() - 1);
        let before = triangle.checked_sub(1).map_or(0.0, |before| self.until[before]);
        let within = ((at - before) / (self.until[triangle] - before)).clamp(0.0, 1.0);
        let near = within.sqrt();
        let mut corners = [0, 1, 2].map(|corner| self.triangles[triangle][corner]);
        let mut shares = [1.0 - near, near * (1.0 - along), near * along];
        let nearest = (0..3).max_by(|&a, &b| shares[a].total_cmp(&shares[b])).unwrap_or(0);
        corners.rotate_left(nearest);
        shares.rotate_left(nearest);
        let edges = self.edge_shares(params, corners, shares);
        let two = |shares: [f64; 3]| Vec2::new(shares[1] as f32, shares[2] as f32);
        BetweenGuides {
            guides: UVec3::from(corners),
            length: 1.0 - params.shorter * unit(params.seed ^ u64::from(index), 1) as f32,
            root_shares: two(shares),
            edge_shares: two(edges),
        }
    }

    /// What of the shape comes from each guide: nothing from one that parts from the nearest.
    fn edge_shares(&self, params: &InterpolationParams, corners: Corners, shares: [f64; 3]) -> [f64; 3] {
        let agrees = |corner: u32| {
            let ways = [corners[0], corner].map(|guide| self.ways(guide));
            let least = f64::from(params.parting).to_radians().cos();
            !params.nearest && (0..2).all(|way| ways[0][way].dot(ways[1][way]) >= least)
        };
        let kept = [0, 1, 2].map(|i| if i == 0 || agrees(corners[i]) { shares[i] } else { 0.0 });
        let sum: f64 = kept.iter().sum();
        kept.map(|share| share / sum)
    }

    /// The directions from the root of a guide to its middle and to its tip.
    fn ways(&self, guide: u32) -> [DVec3; 2] {
        let vertices = self.strands.vertices as usize;
        let guide = &self.strands.rest[guide as usize * vertices..][..vertices];
        let to = |vertex: usize| (point(guide[vertex]) - point(guide[0])).normalize_or(DVec3::Y);
        [to(vertices / 2), to(vertices - 1)]
    }
}

fn point(vertex: glam::Vec4) -> DVec3 {
    vertex.truncate().as_dvec3()
}

/// Up to and with each triangle how many guides' worth of strands there are. A guide has as many as any other, spread over the triangles around it; a triangle has the mean
/// density of its corners, so that a small one among large ones is no tuft.
fn shares(roots: &[DVec3], triangles: &[Corners]) -> Vec<f64> {
    let area = |corners: &Corners| {
        let [a, b, c] = corners.map(|corner| roots[corner as usize]);
        0.5 * (b - a).cross(c - a).length()
    };
    let mut around = vec![0.0; roots.len()];
    for corners in triangles {
        corners.iter().for_each(|&corner| around[corner as usize] += area(corners) / 3.0);
    }
    let density = |corner: u32| if around[corner as usize] > 0.0 { 1.0 / around[corner as usize] } else { 0.0 };
    let share = |corners: &Corners| area(corners) * corners.map(density).iter().sum::<f64>() / 3.0;
    let sum = |sum: &mut f64, corners: &Corners| {
        *sum += share(corners);
        Some(*sum)
    };
    triangles.iter().scan(0.0, sum).collect()
}

/// The place of a point of the unit cube along a curve that fills it (Morton 1966).
fn along_curve(point: DVec3) -> u64 {
    let bits = point.to_array().map(|x| (x.clamp(0.0, 1.0) * 1023.0) as u64);
    (0..10).fold(0, |place, bit| {
        let three = bits.iter().enumerate().map(|(axis, bits)| (bits >> bit & 1) << axis).sum::<u64>();
        place | three << (3 * bit)
    })
}

/// A number in [0, 1) that looks random (SplitMix64, Steele, Lea and Flood 2014).
fn unit(seed: u64, stream: u64) -> f64 {
    let mut x = seed.wrapping_add(stream.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((x ^ (x >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}
