//! The renderer.

use std::num::NonZeroU32;
use std::sync::atomic::{AtomicU64, Ordering};

use glam::{DVec2, DVec4};
use rayon::prelude::*;
use tressfx_core::view::View;

use crate::error::TruthError;
use crate::fibres::Fibres;
use crate::layer::{Hits, Layer, Range};
use crate::light::Illumination;
use crate::lit::Lit;
use crate::picture::{Errors, Halves, Picture};
use crate::rays::Rays;
use crate::section::Section;
use crate::tile::{Scene, TilePicture, Workspace};
use crate::tiles::{Lists, Tiling, runs};

/// How much of a picture is done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Progress {
    /// Tiles that are done.
    pub done: u64,
    /// All of them.
    pub tiles: u64,
}

/// Strands before a view, ready to be rendered.
#[derive(Debug)]
pub struct Truth {
    size: [u32; 2],
    rays: Rays,
    fibres: Fibres,
    /// Distance of the opaque scene at each pixel; empty where there is none.
    scene: Vec<f64>,
    light: Option<Lit>,
}

impl Truth {
    /// Takes strands, and the depth of the opaque scene: one value a pixel of the viewport, row by row from the top, in the
    /// order of depth of the view; none where there is no scene. A depth that is NaN hides nothing.
    ///
    /// # Errors
    /// [`TruthError`]: arrays of another length than the counts say, numbers that are not finite. Positions need not be.
    pub fn new(view: &View, sections: &[Section], depth: Option<&[f32]>) -> Result<Self, TruthError> {
        let size = view.size();
        let rays = Rays::new(view);
        let pixels = size[0] as usize * size[1] as usize;
        if let Some(found) = depth.map(<[f32]>::len).filter(|&found| found != pixels) {
            return Err(TruthError::Depth { found, expected: pixels });
        }
        let scene = depth.unwrap_or_default().iter().map(|&depth| rays.distance(depth)).collect();
        Ok(Self { size, rays, fibres: Fibres::new(&rays, sections)?, scene, light: None })
    }

    /// The same strands in light: what is drawn is no longer the colours of the sections, but what these lights make of theirs,
    /// shaded by all strands and meshes. The opacity stays.
    ///
    /// # Errors
    /// [`TruthError`]: arrays of another length than the counts say, shares that are not from 0 to 1, indices of vertices that
    /// a mesh does not have, numbers that are not finite.
    pub fn lit_by(mut self, light: &Illumination) -> Result<Self, TruthError> {
        self.light = Some(Lit::new(&self.rays, &self.fibres, light)?);
        Ok(self)
    }

    /// The picture, from the mean of `samples` rays a pixel. `progress` is called from many threads.
    pub fn render(&self, samples: NonZeroU32, progress: &(dyn Fn(Progress) + Sync)) -> Picture {
        let halves = Halves::new(samples.get());
        let scene = Scene { rays: &self.rays, fibres: &self.fibres, halves, light: self.light.as_ref() };
        let tiling = Tiling::new(self.size);
        let counts = tiling.counts(&self.rays, &self.fibres);
        let mut pixels = vec![DVec4::ZERO; self.size[0] as usize * self.size[1] as usize];
        let (mut errors, mut shadow_rays) = (Errors::default(), 0);
        let done = AtomicU64::new(0);
        for run in runs(&counts) {
            let lists = Lists::new(&tiling, &self.rays, &self.fibres, &counts, run);
            let tiles = lists.tiles().into_par_iter().with_max_len(1).map_init(Workspace::default, |work, tile| {
                let pixels: Vec<_> = tiling.pixels(tile).map(|pixel| (pixel, self.scene_at(pixel))).collect();
                let picture = scene.tile(work, &pixels, lists.of(tile));
                let done = done.fetch_add(1, Ordering::Relaxed) + 1;
                progress(Progress { done, tiles: u64::from(tiling.count()) });
                (tile, picture)
            });
            for (tile, picture) in tiles.collect::<Vec<(u32, TilePicture)>>() {
                errors = errors.with(picture.errors);
                shadow_rays += picture.shadow_rays;
                for (pixel, color) in tiling.pixels(tile).zip(picture.pixels) {
                    pixels[self.index(pixel)] = color;
                }
            }
        }
        let error = halves.tell_error().then(|| errors.summary(pixels.len()));
        Picture { size: self.size, pixels, error, shadow_rays }
    }

    /// All layers along the ray through a point of the picture, nearest first, however much is seen of them. The point is in
    /// pixels from the upper left corner. No bound is used: it is what [`Truth::render`] can be held against.
    pub fn layers(&self, at: DVec2) -> Vec<Layer> {
        let pixel = at.floor().as_uvec2().to_array();
        let inside = at.cmpge(DVec2::ZERO).all() && pixel[0] < self.size[0] && pixel[1] < self.size[1];
        let mut layers = Vec::new();
        if !inside {
            return layers;
        }
        let (ray, range) = (self.rays.through(at), Range { near: self.rays.near, far: self.scene_at(pixel) });
        let mut hits = Hits::default();
        for segment in 0..self.fibres.end() {
            if let Some(cone) = self.fibres.cone(segment) {
                hits.take(&ray, range, &self.fibres, segment, &cone);
            }
        }
        hits.settle(f64::INFINITY, &self.fibres, &mut |layer, _| layers.push(*layer));
        layers
    }

    fn index(&self, pixel: [u32; 2]) -> usize {
        pixel[1] as usize * self.size[0] as usize + pixel[0] as usize
    }

    fn scene_at(&self, pixel: [u32; 2]) -> f64 {
        let distance = self.scene.get(self.index(pixel)).copied().unwrap_or(f64::INFINITY);
        if distance.is_nan() { f64::INFINITY } else { distance }
    }
}
