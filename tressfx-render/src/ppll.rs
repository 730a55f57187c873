//! Per-pixel linked lists: the A-buffer. The nearest fragments of a pixel are sorted, the rest is blended without order.

mod bounded;
mod desc;
mod fill;
mod nearest;
mod nodes;
mod pool;
mod resolve;
mod tail;

use tressfx_core::backend::Backend;
use tressfx_core::error::{Error, Label, Need, Result};
use tressfx_core::id::BufferId;
use tressfx_core::pass::{Grid, PassList};
use tressfx_core::shader::{Kernel, Module};
use tressfx_core::view::View;

use crate::composite::Composite;
use crate::counters::Counters;
use crate::occlusion::{self, Occlusion};
use crate::output::Output;
use crate::places::check_places;
use crate::predict;
use crate::renderer::{Targets, with_headroom};
use crate::resolved::{Resolved, check_pixels, pixels, tile_count};
use crate::segments::{Segments, Walk};
use crate::shaders::{FRONT, GROUP, PIXELS, with_shared};
use crate::strands::SectionDraw;
use crate::technique::{Technique, TechniqueInstance, another_technique, check_k};
use crate::usage::Usage;
use crate::views::BoundView;
use bounded::{Bounded, Prepared};
use pool::{HEAD_BYTES, NodePool};
use resolve::{Resolve, Variant};

pub use desc::PpllDesc;
#[cfg(test)]
pub(crate) use pool::PoolUniform;
pub use resolve::K_RANGE;
pub use tail::Tail;

const LABEL: Label = "hair.render.ppll";

/// Lists that were bounded hold all fragments again where there may be room for so many times as many: a third walk less is worth more
/// than the full headroom of a pool.
const SPARE: f64 = 1.02;

/// What the kernels of this technique import.
const LIBRARY: &[Module] = &with_shared::<7, 25>([
    FRONT,
    PIXELS,
    ("kept", include_str!("../shaders/ppll/kept.wgsl")),
    ("node", include_str!("../shaders/ppll/node.wgsl")),
    ("rest", include_str!("../shaders/ppll/rest.wgsl")),
    ("sink", include_str!("../shaders/ppll/sink.wgsl")),
    ("weight", include_str!("../shaders/ppll/weight.wgsl")),
]);

/// What looks for hidden hair, made and not in use yet.
#[derive(Debug, Default)]
struct Hiding {
    occlusion: Option<occlusion::Prepared>,
    fill: Option<Walk>,
    bounded: [Option<Walk>; 2],
}

/// Lists of fragments at work.
#[derive(Debug)]
pub(crate) struct Ppll {
    desc: PpllDesc,
    size: [u32; 2],
    output: Output,
    fill: Segments,
    resolve: Resolve,
    composite: Composite,
    pool: NodePool,
    bounded: Bounded,
    occlusion: Occlusion,
    /// Where lists are bounded: how many fragments of a pixel have nodes.
    kept: u32,
    /// Where lists were bounded because of a prediction: views that are still to be measured, and the most fragments of those that
    /// were.
    unproven: Option<(usize, u64)>,
    views: usize,
    /// Fragments, nodes, pixels with hair.
    usage: Usage<3>,
    resolved: Resolved,
}

impl Ppll {
    pub(crate) fn new(
        backend: &mut dyn Backend,
        desc: &PpllDesc,
        size: [u32; 2],
        output: impl Into<Output>,
    ) -> Result<Self> {
        let output = output.into();
        check_k(LABEL, desc.k, &K_RANGE)?;
        check_places(LABEL, desc.places)?;
        if desc.places > 1 && desc.skips_hidden == Some(true) {
            return Err(Error::rule(LABEL, "hidden hair is not known where a pixel has several places".to_owned()));
        }
        check(backend, size, output)?;
        let pool = NodePool::new(backend, size, desc, output.views)?;
        let mut made = Self {
            desc: *desc,
            size,
            output,
            fill: fill::pass(backend, desc, [false, pool.limits.has_more(false)], output)?
                .with_lists(backend, desc.looks_for_hidden() == Some(true))?,
            resolve: Resolve::new(backend, desc.variant(desc.cap.is_some(), &pool.limits, output))?,
            composite: Composite::new(backend, output)?,
            pool,
            bounded: Bounded::default(),
            occlusion: Occlusion::new(backend, desc.looks_for_hidden(), desc.fill, size, output)?,
            kept: 0,
            unproven: None,
            views: 1,
            usage: Usage::new(),
            resolved: Resolved::new(backend, size, output)?,
        };
        if desc.cap.is_some() {
            let prepared = made.prepare(backend, desc)?;
            made.bound(backend, desc, prepared);
        }
        Ok(made)
    }

    /// What `resolve` is compiled for.
    fn variant(&self, desc: &PpllDesc, is_bounded: bool) -> Variant {
        desc.variant(is_bounded, &self.pool.limits, self.output)
    }

    /// Makes what it takes to keep only as many fragments of a pixel as `desc` needs, and changes nothing yet.
    fn prepare(&self, backend: &mut dyn Backend, desc: &PpllDesc) -> Result<(Option<Kernel>, Prepared)> {
        let kernel = self.resolve.prepare(backend, self.variant(desc, true))?;
        let walks_lists = self.occlusion.is_wanted();
        Ok((kernel, self.bounded.prepare(backend, self.size, desc, self.output, walks_lists)?))
    }

    /// Does so.
    fn bound(&mut self, backend: &mut dyn Backend, desc: &PpllDesc, (kernel, prepared): (Option<Kernel>, Prepared)) {
        self.resolve.change(self.variant(desc, true), kernel);
        self.bounded.turn_on(backend, prepared);
        self.kept = desc.asked();
        self.forget_bindings();
    }

    /// Whether the device can bound lists by itself.
    fn can_bound(&self, backend: &dyn Backend) -> bool {
        bounded::check(backend, self.size, self.desc.asked(), self.output).is_ok()
    }

    /// Makes room for what a view has needed. Where even the nearest have too little, fewer of a pixel are kept: which of them find
    /// room would depend on the order in which they come.
    fn grow(&mut self, backend: &mut dyn Backend, counters: &Counters) -> Result<()> {
        let was_bounded = self.bounded.is_on();
        if counters.wanted <= self.pool.capacity(was_bounded) {
            return Ok(());
        }
        self.reserve(backend, counters.wanted.into())?;
        self.unproven = None;
        let largest = self.pool.limits.largest(was_bounded);
        if was_bounded && counters.wanted > largest {
            let fits = largest / counters.pixels_with_hair.max(1);
            self.kept = fits.min(self.kept.saturating_sub(1));
        }
        Ok(())
    }

    /// Holds all fragments again where they have room. Returns whether it does.
    fn unbound(&mut self, backend: &mut dyn Backend, fragments: u64) -> Result<bool> {
        let has_room = fragments as f64 <= self.most_unbounded();
        if self.desc.cap.is_some() || !self.bounded.is_on() || !has_room {
            return Ok(false);
        }
        let kernel = self.resolve.prepare(backend, self.variant(&self.desc, false))?;
        if let Some(nodes) = self.pool.prepare(backend, with_headroom(fragments), false)? {
            self.pool.replace(backend, nodes);
        }
        self.resolve.change(self.variant(&self.desc, false), kernel);
        self.bounded.turn_off(backend);
        self.forget_bindings();
        Ok(true)
    }

    /// Gives back what was not needed for a long time.
    fn shrink(&mut self, backend: &mut dyn Backend, [fragments, nodes, pixels]: [u64; 3]) -> Result<()> {
        if self.unbound(backend, fragments)? {
            return Ok(());
        }
        let is_bounded = self.bounded.is_on();
        let needed = if is_bounded { nodes } else { fragments };
        if let Some(nodes) = self.pool.prepare_smaller(backend, needed, is_bounded)? {
            self.pool.replace(backend, nodes);
            self.forget_bindings();
        }
        let fits = u64::from(self.pool.limits.largest(is_bounded)) / with_headroom(pixels).max(1);
        if is_bounded && fits > u64::from(self.kept) {
            self.kept = fits.min(u64::from(self.bounded.asked())) as u32;
        }
        Ok(())
    }

    /// Fragments up to which lists hold all again where they were bounded.
    pub(crate) fn most_unbounded(&self) -> f64 {
        f64::from(self.pool.limits.largest(false)) / SPARE
    }

    /// Makes room for so many fragments and some more; for more than lists may hold in bounded ones.
    pub(crate) fn reserve(&mut self, backend: &mut dyn Backend, fragments: u64) -> Result<()> {
        let desc = self.desc;
        let largest = self.pool.limits.largest(false).into();
        let bounds = !self.bounded.is_on() && fragments > largest && self.can_bound(backend);
        let prepared = if bounds { Some(self.prepare(backend, &desc)?) } else { None };
        let is_bounded = bounds || self.bounded.is_on();
        let most = if is_bounded { u64::from(desc.asked()) * pixels(self.size) } else { u64::MAX };
        if let Some(nodes) = self.pool.prepare(backend, with_headroom(fragments).min(most), is_bounded)? {
            self.pool.replace(backend, nodes);
        }
        if let Some(prepared) = prepared {
            self.bound(backend, &desc, prepared);
            self.unproven = Some((self.views, 0));
        }
        self.usage.expect([fragments, fragments.min(most), 0]);
        self.forget_bindings();
        Ok(())
    }

    /// Makes what it takes to look for hidden hair, where that is wanted and the device can, and changes nothing yet.
    fn prepare_occlusion(&self, backend: &mut dyn Backend) -> Result<Hiding> {
        let occlusion = self.occlusion.prepare(backend)?;
        if occlusion.is_none() && !self.occlusion.is_ready() {
            return Ok(Hiding::default());
        }
        let (fill, bounded) = (self.fill.prepare_lists(backend)?, self.bounded.prepare_lists(backend)?);
        Ok(Hiding { occlusion, fill, bounded })
    }

    /// Uses that. Returns whether anything is new.
    fn hide(&mut self, backend: &mut dyn Backend, hiding: Hiding) -> bool {
        let Hiding { occlusion, fill, bounded } = hiding;
        let is_new = occlusion.is_some() || fill.is_some() || bounded.iter().any(Option::is_some);
        self.fill.walk_lists(fill);
        self.bounded.walk_lists(bounded);
        if let Some(prepared) = occlusion {
            self.occlusion.turn_on(backend, prepared);
            self.forget_bindings();
        }
        is_new
    }

    /// Gives back all nodes, until more are reserved.
    pub(crate) fn release(&mut self, backend: &mut dyn Backend) -> Result<()> {
        let variant = self.variant(&self.desc, self.desc.cap.is_some());
        let kernel = self.resolve.prepare(backend, variant)?;
        if let Some(nodes) = self.pool.prepare_idle(backend)? {
            self.pool.replace(backend, nodes);
        }
        self.resolve.change(variant, kernel);
        if self.desc.cap.is_none() {
            self.bounded.turn_off(backend);
        }
        self.occlusion.release(backend);
        (self.unproven, self.usage) = (None, Usage::new());
        self.forget_bindings();
        Ok(())
    }

    fn forget_bindings(&mut self) {
        self.fill.forget_bindings();
        self.bounded.forget_bindings();
        self.resolve.bound.clear();
        self.composite.bound.clear();
    }

    #[cfg(test)]
    pub(crate) fn shaders(&self) -> [&tressfx_core::shader::Shader; 3] {
        [self.fill.shader(), &self.resolve.kernel().shader, self.composite.shader()]
    }
}

impl TechniqueInstance for Ppll {
    fn resize(&mut self, backend: &mut dyn Backend, size: [u32; 2]) -> Result<()> {
        check(backend, size, self.output)?;
        let pool = NodePool::new(backend, size, &self.desc, self.output.views)?;
        let resolved = Resolved::new(backend, size, self.output)?;
        let bounded = &self.bounded;
        let walks_lists = self.occlusion.is_wanted();
        let prepare = || bounded.prepare(backend, size, &self.desc, self.output, walks_lists);
        if let Some(prepared) = bounded.is_on().then(prepare).transpose()? {
            self.bounded.turn_on(backend, prepared);
        }
        std::mem::replace(&mut self.pool, pool).destroy(backend);
        std::mem::replace(&mut self.resolved, resolved).destroy(backend);
        self.occlusion.resize(backend, size);
        self.size = size;
        self.forget_bindings();
        Ok(())
    }

    fn make_room(&mut self, backend: &mut dyn Backend, view: &View, draws: &[SectionDraw]) -> Result<()> {
        let fragments = predict::fragments(view, draws);
        self.occlusion.expect(view, draws, fragments);
        // Nothing is in use before all is made.
        let hiding = self.prepare_occlusion(backend)?;
        self.reserve(backend, fragments as u64)?;
        self.hide(backend, hiding);
        Ok(())
    }

    fn measured(&mut self, backend: &mut dyn Backend, counters: &Counters) -> Result<bool> {
        let before = (self.capacity(), self.bounded.is_on(), self.kept);
        self.occlusion.release_unused(backend);
        let hiding = self.prepare_occlusion(backend)?;
        if self.hide(backend, hiding) {
            return Ok(true);
        }
        let needed = [counters.fragments, counters.wanted, counters.pixels_with_hair].map(u64::from);
        let settled = self.usage.measured(needed);
        self.grow(backend, counters)?;
        if (self.capacity(), self.bounded.is_on(), self.kept) != before {
            return Ok(true);
        }
        // Each of these replaces something once all is made that it needs, so only one of them comes at a time.
        match (self.unproven.take(), settled) {
            (Some((views, most)), _) if views > 1 => {
                self.unproven = Some((views - 1, most.max(counters.fragments.into())));
            }
            (Some((_, most)), _) => self.unbound(backend, most.max(counters.fragments.into())).map(drop)?,
            (None, Some(most)) => self.shrink(backend, most)?,
            (None, None) => (),
        }
        Ok(false)
    }

    fn retune(&mut self, backend: &mut dyn Backend, technique: &Technique) -> Result<()> {
        let fixed =
            |desc: &PpllDesc| (desc.max_node_bytes, desc.count_limit, desc.fill, desc.places, desc.skips_hidden);
        let Technique::Ppll(desc) = technique else { return Err(another_technique(LABEL)) };
        check_k(LABEL, desc.k, &K_RANGE)?;
        if fixed(desc) != fixed(&self.desc) {
            return Err(Error::rule(LABEL, "what is not `k`, `tail` or `cap` needs a new renderer".to_owned()));
        }
        let was_capped = self.desc.cap.is_some();
        let stays = self.bounded.is_on() && (desc.cap.is_some() || !was_capped);
        if stays && self.bounded.asked() == desc.asked() || !stays && desc.cap.is_none() {
            let kernel = self.resolve.prepare(backend, self.variant(desc, stays))?;
            self.resolve.change(self.variant(desc, stays), kernel);
            if !stays {
                self.bounded.turn_off(backend);
            }
        } else {
            let prepared = self.prepare(backend, desc)?;
            self.bound(backend, desc, prepared);
        }
        self.desc = *desc;
        Ok(())
    }

    fn capacity(&self) -> u32 {
        self.pool.capacity(self.bounded.is_on())
    }

    fn bytes(&self) -> u64 {
        self.pool.bytes(self.size) + self.bounded.bytes() + self.occlusion.bytes() + self.resolved.bytes(self.size)
    }

    fn counters(&self, view: usize) -> (BufferId, u64) {
        (self.pool.counters.of(view), 0)
    }

    fn begin(&mut self, list: &mut PassList, views: usize, draws: &[SectionDraw]) {
        self.fill.begin_frame();
        self.bounded.begin_frame();
        self.occlusion.begin_frame();
        self.resolve.bound.begin_frame();
        self.composite.bound.begin_frame();
        self.pool.begin(list, views);
        self.usage.begin_frame();
        self.views = views.max(1);
        let groups: u64 = draws.iter().map(|draw| groups(draw)).sum();
        let kept = self.bounded.is_on().then_some(self.kept);
        self.pool.upload(list, groups, kept, &self.desc, tail::unlit(draws));
    }

    fn hairy(&self) -> &Resolved {
        &self.resolved
    }

    fn draw(&mut self, list: &mut PassList, view: &BoundView, targets: &Targets, draws: &[SectionDraw]) -> Result<()> {
        self.resolved.clear(list);
        let occluded = self.occlusion.passes(list, view, draws, targets)?;
        let occluded = occluded.as_ref();
        let own = self.pool.bindings(view.index, self.bounded.is_on());
        match self.bounded.passes() {
            None => {
                view.region.clear(list, self.pool.heads, HEAD_BYTES);
                let own = [&own[..], &[("heads", self.pool.heads.into())]].concat();
                self.fill.passes(list, view, draws, targets, &own, occluded)?;
            }
            Some(passes) => {
                passes.clear(list, &view.region, self.kept);
                if self.kept > 0 {
                    passes.nearest.passes(list, view, draws, targets, &[own[0], passes.keys], occluded)?;
                }
                let own = [&own[..], &[passes.keys, passes.rest]].concat();
                passes.fill.passes(list, view, draws, targets, &own, occluded)?;
            }
        }
        self.resolve.pass(list, view, &self.pool, &self.resolved, self.bounded.rest())?;
        self.composite.pass(list, view, &self.resolved, targets)
    }
}

/// Groups that fill the lists from a section.
fn groups(draw: &SectionDraw) -> u64 {
    let [x, y, z] = Grid::for_threads(draw.segments(), GROUP).0.map(u64::from);
    x * y * z
}

/// Whether a device can draw hair on a screen of this size.
fn check(backend: &dyn Backend, size: [u32; 2], output: Output) -> Result<()> {
    let needs = [
        Need::StorageBuffers(6),
        Need::TextureEdge(size[0].max(size[1])),
        Need::StorageBindingBytes(output.slot_bytes() * u64::from(tile_count(size))),
    ];
    backend.caps().check("hair.render", &needs)?;
    check_pixels(size)
}
