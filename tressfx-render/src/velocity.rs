//! How far hair has moved on the screen since the frame before.
//!
//! Two walks over the segments find the segment of the fragment that each pixel is seen to have, the one whose depth `hair_output` gives; then tiles
//! with hair are drawn, and each pixel of them finds where the point of its segment was. That is the same for every technique.

mod past;
mod seen_keys;
mod seen_segments;

use tressfx_core::backend::{Backend, Blend, Format, RasterDesc};
use tressfx_core::error::Result;
use tressfx_core::id::{BufferId, TextureId};
use tressfx_core::pass::{Draw, Grid, Load, PassList, RasterPass};
use tressfx_core::shader::{Binding, Kernel, Module, RasterPipeline};

use crate::bound::Bound;
use crate::output::walk;
use crate::resolved::{Resolved, pixels, storage};
use crate::shaders::{CORNER, GROUP, shader, with_shared};
use crate::strands::SectionDraw;
use crate::views::BoundView;

pub use past::MotionUniform;
pub(crate) use past::Past;

/// Format of the motion of hair, where a renderer writes it: see [`Targets::velocity`](crate::Targets::velocity).
pub const VELOCITY_FORMAT: Format = Format::Rg32F;

const LABEL: &str = "hair.render.velocity";

/// What a section has moved by, for a shader.
const MOTION: Module = ("motion", include_str!("../shaders/velocity/motion.wgsl"));

const LIBRARY: &[Module] = &with_shared::<2, 20>([CORNER, MOTION]);

/// A number for each pixel of the largest view.
#[derive(Debug)]
pub(crate) struct Seen {
    /// `u32`: the key of the fragment that the pixel is seen to have, 0 for none.
    keys: BufferId,
    /// `u32`: the number of its segment, from 1.
    segments: BufferId,
    size: [u32; 2],
}

impl Seen {
    pub(crate) fn new(backend: &mut dyn Backend, size: [u32; 2]) -> Result<Self> {
        let mut made = |label| storage(backend, label, 4 * pixels(size));
        Ok(Self { keys: made("hair.render.seen_keys")?, segments: made("hair.render.seen_segments")?, size })
    }

    fn bytes(&self) -> u64 {
        2 * (4 * pixels(self.size)).max(16)
    }

    fn destroy(self, backend: &mut dyn Backend) {
        [self.keys, self.segments].into_iter().for_each(|buffer| backend.destroy(buffer.into()));
    }
}

/// A kernel over segments, by view, section and scene.
type WalkBindings = Bound<(usize, BufferId, TextureId)>;

/// The passes.
#[derive(Debug)]
pub(crate) struct Velocity {
    seen: Seen,
    walks: [Kernel; 2],
    walk_bindings: [WalkBindings; 2],
    pipeline: RasterPipeline,
    /// By view, section, list of tiles, and whether the past is known.
    bound: Bound<(usize, BufferId, BufferId, bool)>,
}

impl Velocity {
    pub(crate) fn new(backend: &mut dyn Backend, size: [u32; 2], copies: bool) -> Result<Self> {
        let root = ("velocity", include_str!("../shaders/velocity/velocity.wgsl"));
        let shader = shader(LABEL, root, LIBRARY, &walk(copies))?;
        let desc = RasterDesc::new(shader).target(VELOCITY_FORMAT, Blend::Replace);
        Ok(Self {
            seen: Seen::new(backend, size)?,
            walks: [seen_keys::kernel(backend, copies)?, seen_segments::kernel(backend, copies)?],
            walk_bindings: [Bound::new(), Bound::new()],
            pipeline: backend.create_raster(&desc)?,
            bound: Bound::new(),
        })
    }

    /// Bytes of what it keeps a pixel.
    pub(crate) fn bytes(&self) -> u64 {
        self.seen.bytes()
    }

    /// Takes what was made for views of another size.
    pub(crate) fn resize(&mut self, backend: &mut dyn Backend, seen: Seen) {
        std::mem::replace(&mut self.seen, seen).destroy(backend);
        self.walk_bindings.iter_mut().for_each(Bound::clear);
        self.bound.clear();
    }

    pub(crate) fn begin_frame(&mut self) {
        self.walk_bindings.iter_mut().for_each(Bound::begin_frame);
        self.bound.begin_frame();
    }

    /// Writes the passes of a view whose hair has been drawn: `hairy` are its tiles.
    pub(crate) fn passes(
        &mut self,
        list: &mut PassList,
        view: &BoundView,
        [depth, target]: [TextureId; 2],
        draws: &[SectionDraw],
        hairy: &Resolved,
    ) -> Result<()> {
        past::upload(list, view, draws)?;
        for buffer in [self.seen.keys, self.seen.segments] {
            list.clear(buffer, 0, (4 * pixels(view.size)).max(4));
        }
        self.walk(list, 0, view, depth, draws)?;
        self.walk(list, 1, view, depth, draws)?;
        let mut pass = RasterPass::new(LABEL).color(target, Load::Keep);
        for draw in draws {
            let past = past::of(draw)?;
            let key = (view.index, draw.strands.colors, hairy.tiles, past.is_known());
            let bindings = self.bound.get(key, || {
                let [strands @ .., _, thickness, _] = draw.strands.bindings(view, depth);
                let positions = if past.is_known() { past.positions } else { draw.strands.buffers.positions };
                let own = [
                    thickness,
                    ("past_positions", positions.into()),
                    ("segments", self.seen.segments.into()),
                    ("motion", past.uniforms.binding(view.index)),
                    ("tiles", hairy.tiles.into()),
                ];
                self.pipeline.bind(&[&strands[..], &own].concat())
            })?;
            pass = pass.draw(Draw::indirect(&self.pipeline, &bindings, hairy.draw, 0));
        }
        list.raster(pass);
        Ok(())
    }

    fn walk(
        &mut self,
        list: &mut PassList,
        index: usize,
        view: &BoundView,
        depth: TextureId,
        draws: &[SectionDraw],
    ) -> Result<()> {
        let kernel = &self.walks[index];
        let keys: (&str, Binding) = ("keys", self.seen.keys.into());
        for draw in draws {
            let bindings = self.walk_bindings[index].get((view.index, draw.strands.colors, depth), || {
                let strands = draw.strands.bindings(view, depth);
                let motion = past::of(draw)?.uniforms.binding(view.index);
                let own = [keys, ("segments", self.seen.segments.into()), ("motion", motion)];
                kernel.bind(&[&strands[..], &own[..if index == 0 { 1 } else { 3 }]].concat())
            })?;
            list.compute(kernel, &bindings, Grid::for_threads(draw.segments(), GROUP));
        }
        Ok(())
    }

    #[cfg(test)]
    pub(crate) fn shaders(&self) -> [&tressfx_core::shader::Shader; 3] {
        [&self.walks[0].shader, &self.walks[1].shader, &self.pipeline.shader]
    }
}
