//! Per-pixel linked lists: the A-buffer. The nearest fragments of a pixel are sorted, the rest is blended without order.

mod fill;
mod pool;
mod resolve;
mod tail;

use tressfx_core::backend::{Backend, Format};
use tressfx_core::error::{Error, Label, Need, Result};
use tressfx_core::id::BufferId;
use tressfx_core::pass::{Grid, PassList};
use tressfx_core::shader::{Module, Specialization};
use tressfx_core::view::View;

use crate::composite::Composite;
use crate::predict;
use crate::renderer::Targets;
use crate::resolved::{Resolved, check_pixels, pixels};
use crate::segments::{Fill, Segments};
use crate::shaders::{GROUP, PIXELS, with_shared};
use crate::strands::SectionDraw;
use crate::technique::{Technique, TechniqueInstance, another_technique, check_k};
use crate::views::BoundView;
use pool::NodePool;
use resolve::{Resolve, Variant};

#[cfg(test)]
pub(crate) use pool::PoolUniform;
pub use resolve::K_RANGE;
pub use tail::Tail;

const LABEL: Label = "hair.render.ppll";

/// What the kernels of this technique import.
const LIBRARY: &[Module] = &with_shared::<3, 16>([
    PIXELS,
    ("node", include_str!("../shaders/ppll/node.wgsl")),
    ("sink", include_str!("../shaders/ppll/sink.wgsl")),
]);

/// Lists of fragments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct PpllDesc {
    /// How many of the nearest fragments of a pixel are put in order exactly; the rest is blended without order. In
    /// [`K_RANGE`].
    pub k: u32,
    /// What is seen of the rest.
    pub tail: Tail,
    /// Memory that the lists of fragments may take, 16 bytes a fragment. The device's own limit for one binding holds too.
    pub max_node_bytes: u64,
    /// Where the counter of fragments stops, at most [`PpllDesc::COUNT_LIMIT`]; no more find room.
    pub count_limit: u32,
    /// What fills the lists.
    pub fill: Fill,
}

impl PpllDesc {
    /// The same with `k` sorted fragments a pixel.
    #[must_use]
    pub fn k(self, k: u32) -> Self {
        Self { k, ..self }
    }

    /// The same with something else to be seen of the rest.
    #[must_use]
    pub fn tail(self, tail: Tail) -> Self {
        Self { tail, ..self }
    }

    /// The same with room for at most so many bytes of fragments.
    #[must_use]
    pub fn max_node_bytes(self, max_node_bytes: u64) -> Self {
        Self { max_node_bytes, ..self }
    }

    /// The same with another end of counting.
    #[must_use]
    pub fn count_limit(self, count_limit: u32) -> Self {
        Self { count_limit, ..self }
    }

    /// The same, filled in another way.
    #[must_use]
    pub fn fill(self, fill: Fill) -> Self {
        Self { fill, ..self }
    }

    /// The largest [`PpllDesc::count_limit`]. Up to twice as many can be asked for before the counter is seen to be full, and
    /// that still has to fit into 32 bits.
    pub const COUNT_LIMIT: u32 = i32::MAX as u32;

    fn variant(&self) -> Variant {
        Variant { k: self.k, tail: self.tail }
    }
}

impl Default for PpllDesc {
    /// Eight sorted fragments a pixel, and room for at most 16.7 million fragments in all.
    fn default() -> Self {
        let (count_limit, fill) = (Self::COUNT_LIMIT, Fill::Compute);
        Self { k: 8, tail: Tail::default(), max_node_bytes: 256 << 20, count_limit, fill }
    }
}

impl From<PpllDesc> for crate::Technique {
    fn from(desc: PpllDesc) -> Self {
        Self::Ppll(desc)
    }
}

/// Lists of fragments at work.
#[derive(Debug)]
pub(crate) struct Ppll {
    desc: PpllDesc,
    size: [u32; 2],
    fill: Segments,
    resolve: Resolve,
    composite: Composite,
    pool: NodePool,
    resolved: Resolved,
}

impl Ppll {
    pub(crate) fn new(backend: &mut dyn Backend, desc: &PpllDesc, size: [u32; 2], target: Format) -> Result<Self> {
        check_k(LABEL, desc.k, &K_RANGE)?;
        check(backend, size)?;
        Ok(Self {
            desc: *desc,
            size,
            fill: Segments::new(backend, desc.fill, &fill::SHADERS, &Specialization::new(), target)?,
            resolve: Resolve::new(backend, desc.variant())?,
            composite: Composite::new(backend, target)?,
            pool: NodePool::new(backend, size, desc)?,
            resolved: Resolved::new(backend, size)?,
        })
    }

    fn forget_bindings(&mut self) {
        self.fill.forget_bindings();
        self.resolve.bound.clear();
        self.composite.bound.clear();
    }

    #[cfg(test)]
    pub(crate) fn shaders(&self) -> [&tressfx_core::shader::Shader; 3] {
        [self.fill.shader(), &self.resolve.kernel().shader, &self.composite.pipeline.shader]
    }
}

impl TechniqueInstance for Ppll {
    fn resize(&mut self, backend: &mut dyn Backend, size: [u32; 2]) -> Result<()> {
        check(backend, size)?;
        let pool = NodePool::new(backend, size, &self.desc)?;
        let resolved = Resolved::new(backend, size)?;
        std::mem::replace(&mut self.pool, pool).destroy(backend);
        std::mem::replace(&mut self.resolved, resolved).destroy(backend);
        self.size = size;
        self.forget_bindings();
        Ok(())
    }

    fn predicted(&self, view: &View, draws: &[SectionDraw]) -> f64 {
        predict::fragments(view, draws)
    }

    fn reserve(&mut self, backend: &mut dyn Backend, fragments: u64) -> Result<()> {
        let grown = self.pool.grow(backend, fragments);
        self.forget_bindings();
        grown
    }

    fn retune(&mut self, backend: &mut dyn Backend, technique: &Technique) -> Result<()> {
        let fixed = |desc: &PpllDesc| (desc.max_node_bytes, desc.count_limit, desc.fill);
        let Technique::Ppll(desc) = technique else { return Err(another_technique(LABEL)) };
        check_k(LABEL, desc.k, &K_RANGE)?;
        if fixed(desc) != fixed(&self.desc) {
            return Err(Error::rule(LABEL, "what is not `k` or `tail` needs a new renderer".to_owned()));
        }
        self.resolve.change(backend, desc.variant())?;
        self.desc = *desc;
        Ok(())
    }

    fn capacity(&self) -> u32 {
        self.pool.capacity
    }

    fn bytes(&self) -> u64 {
        self.pool.bytes(self.size) + Resolved::bytes(self.size)
    }

    fn counters(&self, view: usize) -> (BufferId, u64) {
        (self.pool.counters.of(view), 0)
    }

    fn begin(&mut self, list: &mut PassList, views: usize, draws: &[SectionDraw]) {
        self.fill.begin_frame();
        self.resolve.bound.begin_frame();
        self.composite.bound.begin_frame();
        let groups: u64 = draws.iter().map(|draw| groups(draw)).sum();
        self.pool.begin(list, views, groups, tail::unlit(draws));
    }

    fn draw(&mut self, list: &mut PassList, view: &BoundView, targets: &Targets, draws: &[SectionDraw]) -> Result<()> {
        self.pool.clear_heads(list, view.size);
        self.resolved.clear(list);
        self.fill.passes(list, view, draws, targets, &self.pool.bindings(view))?;
        self.resolve.pass(list, view, &self.pool, &self.resolved)?;
        self.composite.pass(list, view, &self.resolved, targets.color)
    }
}

/// Groups that fill the lists from a section.
fn groups(draw: &SectionDraw) -> u64 {
    let [x, y, z] = Grid::for_threads(draw.strands.buffers.shape.segments(), GROUP).0.map(u64::from);
    x * y * z
}

/// Whether a device can draw hair on a screen of this size.
fn check(backend: &dyn Backend, size: [u32; 2]) -> Result<()> {
    let needs = [
        Need::StorageBuffers(6),
        Need::TextureEdge(size[0].max(size[1])),
        Need::StorageBindingBytes(Resolved::PIXEL_BYTES * pixels(size)),
    ];
    backend.caps().check("hair.render", &needs)?;
    check_pixels(size)
}
