//! One tile of the picture: its segments front to back, over all rays of its pixels.

use glam::{DVec2, DVec3, DVec4, UVec2};

use crate::bound::Bound;
use crate::fibres::Fibres;
use crate::layer::{Blend, Hits, Range};
use crate::lit::{Lit, Pick};
use crate::pattern::{chances, points};
use crate::picture::{Errors, Halves, Sum};
use crate::rays::{Ray, Rays};
use crate::shadow::ShadowWork;

/// Rays of a pixel that are followed at the same time, which bounds memory whatever the number of samples is.
const AT_ONCE: u32 = 64;

/// After so many segments, layers that are known to be in order are blended.
const BETWEEN: usize = 32;

/// What a thread keeps from tile to tile.
#[derive(Debug, Default)]
pub(crate) struct Workspace {
    order: Vec<(f64, u32)>,
    samples: Vec<Sample>,
    pixels: Vec<Pixel>,
    shadow: ShadowWork,
}

/// A ray and what it has met.
#[derive(Clone, Debug)]
struct Sample {
    at: DVec2,
    ray: Ray,
    hits: Hits,
    blend: Blend,
    pick: Pick,
    /// What else is left to chance.
    sky: DVec2,
}

#[derive(Clone, Copy, Debug)]
struct Pixel {
    center: DVec2,
    range: Range,
    /// Rays that something may still be seen on.
    open: u32,
}

/// A finished tile.
#[derive(Clone, Debug, Default)]
pub(crate) struct TilePicture {
    /// Premultiplied; empty where there is no hair.
    pub(crate) pixels: Vec<DVec4>,
    pub(crate) errors: Errors,
    pub(crate) shadow_rays: u64,
}

/// What all tiles share.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scene<'a> {
    pub(crate) rays: &'a Rays,
    pub(crate) fibres: &'a Fibres,
    pub(crate) halves: Halves,
    /// None where the colours are those that were given.
    pub(crate) light: Option<&'a Lit>,
}

impl Scene<'_> {
    /// Renders pixels, each given with the distance of the scene. `segments` are all that may be seen there.
    pub(crate) fn tile(&self, work: &mut Workspace, pixels: &[([u32; 2], f64)], segments: &[u32]) -> TilePicture {
        if segments.is_empty() {
            return TilePicture::default();
        }
        let mut sums = vec![Sum::default(); pixels.len()];
        work.sort(self, segments);
        let samples = self.halves.samples();
        for first in (0..samples).step_by(AT_ONCE as usize) {
            let numbers = first..samples.min(first.saturating_add(AT_ONCE));
            let each = numbers.len();
            work.begin(self.rays, pixels, numbers);
            work.follow(self);
            for (sum, samples) in sums.iter_mut().zip(work.samples.chunks(each)) {
                for (number, sample) in (first..).zip(samples) {
                    self.halves.add(sum, number, self.color(&mut work.shadow, sample));
                }
            }
        }
        let mut errors = Errors::default();
        if self.halves.tell_error() {
            sums.iter().for_each(|sum| errors.add(self.halves.error(sum)));
        }
        let shadow_rays = std::mem::take(&mut work.shadow.rays);
        TilePicture { pixels: sums.iter().map(|sum| self.halves.mean(sum)).collect(), errors, shadow_rays }
    }

    /// Premultiplied colour and alpha of a ray that has met all that is seen on it.
    fn color(&self, shadow: &mut ShadowWork, sample: &Sample) -> DVec4 {
        let (Some(light), Some(place)) = (self.light, sample.pick.place) else { return sample.blend.color() };
        let alpha = sample.blend.alpha();
        (alpha * light.color(shadow, self.fibres, place, sample.sky)).extend(alpha)
    }
}

impl Workspace {
    /// Puts segments in the order in which they can be entered first.
    fn sort(&mut self, scene: &Scene, segments: &[u32]) {
        self.order.clear();
        self.order.extend(segments.iter().filter_map(|&segment| {
            let bound = Bound::new(scene.rays, &scene.fibres.cone(segment)?)?;
            Some((bound.nearest, segment))
        }));
        self.order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    }

    fn begin(&mut self, rays: &Rays, pixels: &[([u32; 2], f64)], numbers: std::ops::Range<u32>) {
        let each = numbers.len();
        self.pixels.clear();
        self.pixels.extend(pixels.iter().map(|&(pixel, far)| Pixel {
            center: UVec2::from_array(pixel).as_dvec2() + 0.5,
            range: Range { near: rays.near, far },
            open: each as u32,
        }));
        let empty = Sample {
            at: DVec2::ZERO,
            ray: rays.through(DVec2::ZERO),
            hits: Hits::default(),
            blend: Blend::EMPTY,
            pick: Pick::new(0.0),
            sky: DVec2::ZERO,
        };
        self.samples.resize(each * pixels.len(), empty);
        for ((pixel, _), samples) in pixels.iter().zip(self.samples.chunks_mut(each)) {
            let chosen = points(*pixel, numbers.clone()).zip(chances(*pixel, numbers.clone()));
            for (sample, (at, DVec3 { x, y, z })) in samples.iter_mut().zip(chosen) {
                (sample.at, sample.ray, sample.blend) = (at, rays.through(at), Blend::EMPTY);
                (sample.sky, sample.pick) = (DVec2::new(x, y), Pick::new(z));
                sample.hits.clear();
            }
        }
    }

    /// Follows all rays until nothing more can be seen.
    fn follow(&mut self, scene: &Scene) {
        let farthest = self.pixels.iter().map(|pixel| pixel.range.far).fold(f64::NEG_INFINITY, f64::max);
        let order = std::mem::take(&mut self.order);
        for (number, &(nearest, segment)) in order.iter().enumerate() {
            if number % BETWEEN == 0 {
                self.settle(scene, nearest);
            }
            if nearest > farthest || self.pixels.iter().all(|pixel| pixel.open == 0) {
                break;
            }
            self.segment(scene, segment);
        }
        self.settle(scene, f64::INFINITY);
        self.order = order;
    }

    /// Blends the layers that are nearer than the horizon.
    fn settle(&mut self, scene: &Scene, horizon: f64) {
        let each = self.samples.len() / self.pixels.len();
        for (pixel, samples) in self.pixels.iter_mut().zip(self.samples.chunks_mut(each)) {
            if pixel.open == 0 {
                continue;
            }
            for sample in samples.iter_mut().filter(|sample| !sample.blend.is_closed()) {
                let Sample { blend, pick, .. } = sample;
                sample.hits.settle(horizon, scene.fibres, &mut |layer, place| {
                    if !blend.is_closed() {
                        pick.offer(blend.add(layer), place);
                    }
                });
                pixel.open -= u32::from(blend.is_closed());
            }
        }
    }

    /// Lets all rays that are open meet a segment.
    fn segment(&mut self, scene: &Scene, segment: u32) {
        let Some(cone) = scene.fibres.cone(segment) else { return };
        let Some(bound) = Bound::new(scene.rays, &cone) else { return };
        let half_diagonal = std::f64::consts::FRAC_1_SQRT_2 + 1e-9;
        let each = self.samples.len() / self.pixels.len();
        for (pixel, samples) in self.pixels.iter().zip(self.samples.chunks_mut(each)) {
            let is_seen = pixel.open > 0 && bound.nearest <= pixel.range.far;
            if !is_seen || !bound.meets(pixel.center, half_diagonal) {
                continue;
            }
            for sample in samples.iter_mut().filter(|sample| !sample.blend.is_closed() && bound.meets(sample.at, 0.0)) {
                sample.hits.take(&sample.ray, pixel.range, scene.fibres, segment, &cone);
            }
        }
    }
}
