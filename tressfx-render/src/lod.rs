//! Level of detail: how much of a section is drawn.

use glam::Vec3;
use tressfx_core::strand_buffers::StrandShape;
use tressfx_core::strands::Strands;
use tressfx_core::view::View;

use crate::strands::SectionDraw;
use crate::uniforms::LodUniform;

/// Strands whose bends are measured.
const MAX_SAMPLES: u32 = 1024;

/// The share of strands whose bends are at most what is noted.
const COVERED: f64 = 0.95;

/// What of a section is drawn and shaded: an even sample of its strands, wider by as much as there are fewer, and of each of them an even
/// sample of its vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lod {
    /// Share of the strands, above 0, at most 1. The number of strands need not be whole: the last one is narrower then, so that none
    /// appears at once.
    pub share: f32,
    /// Steps from a vertex to the next one that is drawn; 1 draws all of them. Roots and tips are always drawn.
    pub step: u32,
}

impl Lod {
    /// All strands and vertices.
    pub const FULL: Self = Self { share: 1.0, step: 1 };

    /// At least the detail of both: for several views, which share what is drawn.
    #[must_use]
    pub fn finer(self, other: Self) -> Self {
        Self { share: self.share.max(other.share), step: self.step.min(other.step) }
    }

    /// Whether a renderer takes it.
    pub(crate) fn is_valid(&self) -> bool {
        self.share > 0.0 && self.share <= 1.0 && self.step > 0
    }

    /// Strands that are drawn, the last one in part.
    fn strands(&self, shape: StrandShape) -> f32 {
        let all = shape.strands() as f32;
        (self.share * all).max(1.0).min(all)
    }

    /// Strands that are counted for shadows: of those more than are drawn, since the cells of lights are as fine at every distance.
    pub(crate) fn shadow_strands(&self, shape: StrandShape) -> u32 {
        let all = shape.strands();
        ((self.share.sqrt() * all as f32).ceil() as u32).clamp(1, all.max(1))
    }

    /// How much wider each strand is.
    pub(crate) fn widening(&self, shape: StrandShape) -> f32 {
        if self.share < 1.0 { shape.strands() as f32 / self.strands(shape).max(1.0) } else { 1.0 }
    }

    /// What the shaders are given.
    pub fn uniform(&self, shape: StrandShape) -> LodUniform {
        let wanted = self.strands(shape);
        let strands = (wanted.ceil() as u32).min(shape.strands());
        let edges = shape.vertices.max(1) - 1;
        let step = self.step.min(edges.max(1));
        let fade = wanted - (strands.max(1) - 1) as f32;
        LodUniform { strands, vertices: edges.div_ceil(step) + 1, step, fade }
    }
}

/// How far the strands of a groom bend away, in its rest pose, from straight lines between fewer of their vertices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bends {
    /// For steps of 2, 4, 8 and so on vertices, in the unit of the positions: of 95 of 100 strands at most.
    deviations: Vec<f32>,
}

impl Bends {
    /// Those of a groom.
    pub fn of(strands: &Strands) -> Self {
        let vertices = strands.vertices as usize;
        let count = strands.guides.min(MAX_SAMPLES) as usize;
        let points = |strand: usize| strands.rest[strand * vertices..][..vertices].iter().map(|point| point.truncate());
        let samples: Vec<Vec<Vec3>> = (0..count).map(|strand| points(strand).collect()).collect();
        let steps = (1..).map(|power| 1 << power).take_while(|&step| step < vertices.max(1));
        Self { deviations: steps.map(|step| covering(samples.iter().map(|strand| deviation(strand, step)))).collect() }
    }

    /// The largest step whose deviation is at most `limit`.
    fn step(&self, limit: f32) -> u32 {
        1 << self.deviations.iter().take_while(|&&deviation| deviation <= limit).count()
    }
}

/// What [`COVERED`] of some numbers are at most.
fn covering(numbers: impl Iterator<Item = f32>) -> f32 {
    let mut numbers: Vec<f32> = numbers.collect();
    numbers.sort_by(f32::total_cmp);
    let last = numbers.len().saturating_sub(1);
    numbers.get((last as f64 * COVERED).ceil() as usize).copied().unwrap_or(0.0)
}

/// The largest distance of a vertex from the line between the drawn vertices before and after it.
fn deviation(strand: &[Vec3], step: usize) -> f32 {
    let last = strand.len() - 1;
    let of_piece = |first: usize| {
        let (start, end) = (strand[first], strand[(first + step).min(last)]);
        let way = end - start;
        let from_line = |point: &Vec3| {
            let along = (*point - start).dot(way) / way.length_squared().max(f32::MIN_POSITIVE);
            point.distance(start + way * along.clamp(0.0, 1.0))
        };
        strand[first..=(first + step).min(last)].iter().map(from_line).fold(0.0, f32::max)
    };
    (0..last).step_by(step).map(of_piece).fold(0.0, f32::max)
}

/// From what is seen to what is drawn.
///
/// The width of a fibre on the screen falls with the root of the area that its groom covers there. So does the share of the strands that are
/// drawn, once a fibre is narrower than `width`: the strands that are left have that width. The cost of fragments then falls with the area, and
/// that of shading with its root.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct LodDesc {
    /// Pixels: strands are drawn wider, and fewer of them, until a fibre at the nearest point of the groom has this width at its root.
    pub width: f32,
    /// Pixels: vertices are left out of strands as long as the curve stays this near.
    pub deviation: f32,
    /// No fewer strands than this are drawn, where there are so many.
    pub least: u32,
}

impl Default for LodDesc {
    fn default() -> Self {
        Self { width: 0.25, deviation: 1.0 / 3.0, least: 256 }
    }
}

impl LodDesc {
    /// The same with another width of strands; 0 draws all of them.
    #[must_use]
    pub fn width(self, width: f32) -> Self {
        Self { width, ..self }
    }

    /// The same with another deviation of curves; 0 draws all vertices.
    #[must_use]
    pub fn deviation(self, deviation: f32) -> Self {
        Self { deviation, ..self }
    }

    /// What to draw of a section for a view. All of it where the eye is in the groom.
    pub fn choose(&self, view: &View, draw: &SectionDraw) -> Lod {
        let lens = view.lens();
        let (middle, radius) = draw.sphere();
        let distance = -(lens.to_eye * draw.pose.matrix()).transform_point3(middle).z - radius;
        let focal = lens.focal.abs().max_element();
        if lens.is_perspective && distance <= lens.near {
            return Lod::FULL;
        }
        let pixels = if lens.is_perspective { focal / distance } else { focal };
        let all = draw.drawn_shape().strands();
        let least = (self.least as f32 / all.max(1) as f32).clamp(f32::MIN_POSITIVE, 1.0);
        let width = 2.0 * draw.strands.info.radius(draw.material) * pixels;
        let share = (width / self.width).clamp(least, 1.0);
        let chosen = Lod { share, step: draw.strands.info.bends.step(self.deviation / pixels) };
        if chosen.is_valid() { chosen } else { Lod::FULL }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHAPE: StrandShape = StrandShape { guides: 100, follows: 0, vertices: 10 };

    #[test]
    fn the_width_of_all_strands_together_stays() {
        for share in [1.0, 0.999, 0.5, 0.333, 0.015, 0.0001] {
            let lod = Lod { share, step: 1 };
            let LodUniform { strands, fade, .. } = lod.uniform(SHAPE);
            let width = lod.widening(SHAPE) * ((strands - 1) as f32 + fade);
            assert!((width - 100.0).abs() < 1e-3, "{share}: {width}");
            assert!(fade > 0.0 && fade <= 1.0, "{share}: {fade}");
        }
    }

    #[test]
    fn roots_and_tips_are_drawn_with_any_step() {
        for step in 1..30 {
            let LodUniform { vertices, step, .. } = Lod { share: 1.0, step }.uniform(SHAPE);
            assert!(
                (vertices - 1) * step >= 9 && (vertices - 2) * step < 9,
                "{vertices} vertices with steps of {step}"
            );
        }
    }

    #[test]
    fn a_bend_is_how_far_a_vertex_is_from_the_line_without_it() {
        let corner = [Vec3::ZERO, Vec3::new(1.0, 0.0, 0.0), Vec3::new(1.0, 1.0, 0.0)];
        assert!((deviation(&corner, 2) - 0.5_f32.sqrt()).abs() < 1e-6);
        assert_eq!(deviation(&corner, 1), 0.0);
        let bends = Bends { deviations: vec![0.1, 0.3, 1.0] };
        let steps = [0.05, 0.1, 0.5, 2.0].map(|limit| bends.step(limit));
        assert_eq!(steps, [1, 2, 4, 8]);
    }
}
