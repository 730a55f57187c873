//! The passes of hair in a frame.

use tressfx_core::backend::{Backend, BufferDesc, Format};
use tressfx_core::error::{Need, Result};
use tressfx_core::id::{BufferId, TextureId};
use tressfx_core::pass::{PassList, Ticket};
use tressfx_core::shader::{Kernel, RasterPipeline};
use tressfx_core::view::View;

use crate::lights::Lights;
use crate::pool::{Counters, NodePool, Resolved};
use crate::resolve::K_RANGE;
use crate::section::SectionDraw;
use crate::{composite, fill, gpu, predict, resolve, shade};

/// Room in the pool beyond what was predicted or measured: the next frame moves.
const HEADROOM: f64 = 1.25;

/// A renderer to be made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RenderDesc {
    /// Width and height of the targets in pixels.
    pub size: [u32; 2],
    /// Format of the colour target.
    pub target: Format,
    /// How many of the nearest fragments of a pixel are put in order exactly; the rest is blended without order. In
    /// [`K_RANGE`].
    pub k: u32,
    /// Memory that the lists of fragments may take, 16 bytes a fragment. The device's own limit for one binding holds too.
    pub max_node_bytes: u64,
}

impl RenderDesc {
    /// Eight sorted fragments a pixel, and room for at most 16.7 million fragments in all.
    pub fn new(size: [u32; 2], target: Format) -> Self {
        Self { size, target, k: 8, max_node_bytes: 256 << 20 }
    }
}

/// What is drawn to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Targets {
    /// The picture so far; hair is blended over it.
    pub color: TextureId,
    /// Depth of the opaque scene, [`Format::Depth32F`], in the order of the view. Hair is tested against it and does not
    /// write it.
    pub depth: TextureId,
}

/// Draws hair: per-pixel lists of fragments, of which the nearest are sorted.
///
/// The same strands and view give the same picture to the bit, as long as no fragment is dropped: which of them finds room
/// in a full pool is up to the GPU.
#[derive(Debug)]
pub struct HairRenderer {
    desc: RenderDesc,
    shade: Kernel,
    fill: Kernel,
    resolve: Kernel,
    composite: RasterPipeline,
    /// [`gpu::Frame`].
    frame: BufferId,
    pool: NodePool,
    resolved: Resolved,
}

impl HairRenderer {
    /// Compiles the kernels and makes the buffers of the screen.
    ///
    /// # Errors
    /// What the device lacks, or what the backend says.
    ///
    /// # Panics
    /// If `k` is outside [`K_RANGE`] or a side of the size is 0.
    pub fn new(backend: &mut dyn Backend, desc: &RenderDesc) -> Result<Self> {
        assert!(K_RANGE.contains(&desc.k), "k is {}, it must be in {K_RANGE:?}", desc.k);
        check(backend, desc.size)?;
        Ok(Self {
            desc: *desc,
            shade: shade::kernel(backend)?,
            fill: fill::kernel(backend)?,
            resolve: resolve::kernel(backend, desc.k)?,
            composite: composite::kernel(backend, desc.target)?,
            frame: backend.create_buffer(&BufferDesc::uniform("hair.render.frame", size_of::<gpu::Frame>() as u64))?,
            pool: NodePool::new(backend, desc.size, desc.max_node_bytes)?,
            resolved: Resolved::new(backend, desc.size)?,
        })
    }

    /// What it was made from.
    pub fn desc(&self) -> &RenderDesc {
        &self.desc
    }

    /// Fragments that there is room for at the moment.
    pub fn capacity(&self) -> u32 {
        self.pool.capacity
    }

    /// Makes the buffers of the screen anew.
    ///
    /// # Errors
    /// As [`HairRenderer::new`]. The renderer is as it was then.
    ///
    /// # Panics
    /// If a side of the size is 0.
    pub fn resize(&mut self, backend: &mut dyn Backend, size: [u32; 2]) -> Result<()> {
        check(backend, size)?;
        let pool = NodePool::new(backend, size, self.desc.max_node_bytes)?;
        let resolved = Resolved::new(backend, size)?;
        std::mem::replace(&mut self.pool, pool).destroy(backend);
        std::mem::replace(&mut self.resolved, resolved).destroy(backend);
        self.desc.size = size;
        Ok(())
    }

    /// Makes room for what a frame is predicted to need. To be called before the first frame and after a cut of the camera.
    ///
    /// # Errors
    /// What the backend says when it cannot make a buffer of that size; the pool is as it was then.
    pub fn reserve(&mut self, backend: &mut dyn Backend, view: &View, draws: &[SectionDraw]) -> Result<()> {
        self.pool.grow(backend, (predict::fragments(view, draws) * HEADROOM) as u64)
    }

    /// Makes room for what a frame was found to need; nothing happens while there is enough.
    ///
    /// # Errors
    /// As [`HairRenderer::reserve`].
    pub fn observe(&mut self, backend: &mut dyn Backend, counters: &Counters) -> Result<()> {
        if counters.fragments <= self.pool.capacity {
            return Ok(());
        }
        self.pool.grow(backend, (f64::from(counters.fragments) * HEADROOM) as u64)
    }

    /// Draws sections, each once, sorted against each other. Where there is no strand, there is no pass.
    ///
    /// # Panics
    /// If the view has another size than the renderer, or there are more than [`MAX_LIGHTS`](crate::MAX_LIGHTS) lights.
    pub fn draw(&self, list: &mut PassList, view: &View, lights: &Lights, targets: &Targets, draws: &[SectionDraw]) {
        assert_eq!(view.size, self.desc.size, "a view of {:?} for a renderer of {:?}", view.size, self.desc.size);
        self.pool.clear_counters(list);
        if draws.iter().all(SectionDraw::is_empty) {
            return;
        }
        list.upload(self.frame, 0, &[gpu::Frame::new(view, lights, self.pool.capacity)]);
        self.pool.clear(list);
        for draw in draws {
            list.upload(draw.section.uniform, 0, &[draw.uniform()]);
            shade::pass(list, &self.shade, self.frame, draw.section);
        }
        for draw in draws {
            fill::pass(list, &self.fill, self.frame, draw.section, &self.pool, targets.depth);
        }
        resolve::pass(list, &self.resolve, self.frame, &self.pool, &self.resolved);
        composite::pass(list, &self.composite, self.frame, &self.resolved, targets.color);
    }

    /// Brings the counters of the frame so far back: see [`Counters::from_bytes`].
    pub fn read_counters(&self, list: &mut PassList) -> Ticket {
        list.read_buffer(self.pool.counters, 0, Counters::BYTES)
    }

    /// Frees everything that it made.
    pub fn destroy(self, backend: &mut dyn Backend) {
        for kernel in [self.shade, self.fill, self.resolve] {
            backend.destroy_pipeline(kernel.pipeline);
        }
        backend.destroy_pipeline(self.composite.pipeline);
        backend.destroy(self.frame.into());
        self.pool.destroy(backend);
        self.resolved.destroy(backend);
    }
}

/// Whether a device can draw hair on a screen of this size.
fn check(backend: &dyn Backend, size: [u32; 2]) -> Result<()> {
    assert!(size.iter().all(|&side| side > 0), "a size of {size:?}");
    let needs = [
        Need::StorageBuffers(6),
        Need::TextureEdge(size[0].max(size[1])),
        Need::StorageBindingBytes(8 * u64::from(size[0]) * u64::from(size[1])),
    ];
    backend.caps().check("hair.render", &needs)
}

#[cfg(test)]
mod tests {
    use tressfx_core::null::NullBackend;

    use super::*;

    #[test]
    fn structs_are_laid_out_as_in_the_wgsl() {
        let mut backend = NullBackend::default();
        let renderer = HairRenderer::new(&mut backend, &RenderDesc::new([64, 64], Format::Rgba16F)).unwrap();
        for kernel in [&renderer.shade, &renderer.fill, &renderer.resolve] {
            kernel.shader.check_layout::<gpu::Frame>().unwrap();
        }
        renderer.composite.shader.check_layout::<gpu::Frame>().unwrap();
        renderer.shade.shader.check_layout::<gpu::Light>().unwrap();
        for kernel in [&renderer.shade, &renderer.fill] {
            kernel.shader.check_layout::<gpu::Section>().unwrap();
        }
        for kernel in [&renderer.fill, &renderer.resolve] {
            kernel.shader.check_layout::<Counters>().unwrap();
        }
    }

    #[test]
    fn every_kernel_fits_the_limits_of_webgpu() {
        let mut backend = NullBackend::default();
        for k in K_RANGE {
            let desc = RenderDesc { k, ..RenderDesc::new([64, 64], Format::Rgba8Srgb) };
            let renderer = HairRenderer::new(&mut backend, &desc).unwrap();
            assert_eq!(renderer.resolve.shader.features, format!("K={k}"));
            let shaders = [&renderer.shade, &renderer.fill, &renderer.resolve].map(|kernel| &kernel.shader);
            let counts = shaders.map(|shader| shader.storage_buffers());
            assert_eq!(counts.into_iter().max(), Some(6), "{counts:?}: what `check` asks for");
        }
    }
}
