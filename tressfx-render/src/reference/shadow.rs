//! Frames, cells, and what they hold, for the kernels of shadows.

use glam::{DMat4, DVec3};

use super::{Strands, matrix};
use crate::uniforms::{ShadowFrameUniform, ShadowUniform};

/// The frame of the sky.
const SKY: usize = 0;
const POINT: u32 = 2;

/// A light that nothing shades, and one that is taken from what arrives from everywhere.
pub(super) const OPEN: u32 = u32::MAX;
pub(super) const BY_SKY: u32 = 0;

/// Cells of a frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    pub(super) low: DVec3,
    pub(super) cell: DVec3,
    pub(super) size: [u32; 3],
}

/// What is in a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ShadowCell {
    /// The optical depth of its fibres.
    pub depth: f64,
    /// Whether skin is in it.
    pub is_skin: bool,
}

impl Grid {
    /// Over a box of hair.
    pub(super) fn over([low, high]: [DVec3; 2], frame: &ShadowFrameUniform, radius: f64, is_sky: bool) -> Self {
        let size = DVec3::from_array(frame.size.map(f64::from));
        let extent = (high - low) / (size - 2.0);
        let least = 4.0 * radius + 1e-6 * low.abs().max(high.abs()).max_element() + 1e-20;
        let across = extent.x.max(extent.y).max(least / shrinks_by(frame, low));
        let along = extent.z.max(least);
        let cell = if is_sky { DVec3::splat(across.max(along)) } else { DVec3::new(across, across, along) };
        let cell = DVec3::from_array(cell.to_array().map(|size| (0.25 * (4.0 * size.log2()).ceil()).exp2()));
        let corner = (0.5 * (low + high) / cell).floor() - (0.5 * size).floor();
        Self { low: corner * cell, cell, size: frame.size }
    }

    pub(super) fn place(&self, at: DVec3) -> DVec3 {
        (at - self.low) / self.cell
    }

    pub(super) fn index(&self, at: [f64; 3]) -> usize {
        let inside = |axis: usize| at[axis].floor().clamp(0.0, f64::from(self.size[axis] - 1)) as usize;
        (inside(2) * self.size[1] as usize + inside(1)) * self.size[0] as usize + inside(0)
    }

    pub(super) fn count(&self) -> usize {
        self.size.iter().map(|&side| side as usize).product()
    }
}

/// A point of the world as a frame sees it.
pub(super) fn in_frame(frame: &ShadowFrameUniform, point: DVec3) -> DVec3 {
    let axes: DMat4 = matrix(&frame.axes);
    let at = axes.transform_point3(point);
    let distance = at.z.max(f64::from(frame.nearest));
    if frame.kind == POINT { DVec3::new(at.x / distance, at.y / distance, distance) } else { at }
}

/// What widths are divided by where a frame sees them from.
pub(super) fn shrinks_by(frame: &ShadowFrameUniform, at: DVec3) -> f64 {
    if frame.kind == POINT { at.z } else { 1.0 }
}

/// Strands of a section that are counted.
pub(super) fn samples(shadow: &ShadowUniform, strands: &Strands) -> u32 {
    strands.uniform.shadow_strands.min(shadow.samples)
}

/// What a frame of shadows holds in f64.
#[derive(Clone, Debug)]
pub struct ShadowCells {
    pub(super) index: usize,
    pub(super) grid: Grid,
    /// What was counted.
    pub(super) cells: Vec<ShadowCell>,
}

impl ShadowCells {
    /// Whether it is the sky's.
    pub(super) fn is_sky(&self) -> bool {
        self.index == SKY
    }

    pub(super) fn new(shadow: &ShadowUniform, index: usize, bounds: [DVec3; 2]) -> Self {
        let grid = Grid::over(bounds, &shadow.frames[index], f64::from(shadow.radius), index == SKY);
        Self { index, grid, cells: vec![ShadowCell::default(); grid.count()] }
    }
}
