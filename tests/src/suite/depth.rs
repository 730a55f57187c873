//! Depth: which fragments pass, in both orders, and what stays for those that follow.

use tressfx_core::backend::{Blend, Depth, DepthOrder, Format};
use tressfx_core::id::TextureId;
use tressfx_core::pass::{Draw, Load, RasterPass};
use tressfx_core::shader::{RasterPipeline, ShaderSource};

use super::subject::{Subject, draw, source};

/// Covers the target at a depth, in a colour.
const LAYER: ShaderSource = source(
    "suite.layer",
    "import package::cover::cover;
    struct Layer { color: vec4<f32>, depth: vec4<f32> }
    @group(0) @binding(0) var<uniform> layer: Layer;
    @vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
        return vec4<f32>(cover(index).xy, layer.depth.x, 1.0);
    }
    @fragment fn fragment() -> @location(0) vec4<f32> { return layer.color; }",
);

/// A colour target, a depth target, and what draws to both.
struct Screen {
    color: TextureId,
    depth: TextureId,
    pipeline: RasterPipeline,
    order: DepthOrder,
}

impl Screen {
    fn new(t: &mut Subject, order: DepthOrder) -> Self {
        Self {
            color: t.texture([3, 3], Format::Rgba8),
            depth: t.texture([3, 3], Format::Depth32F),
            pipeline: t.raster(&LAYER, &[(Format::Rgba8, Blend::Replace)], Depth::TestWrite(order)),
            order,
        }
    }

    /// A layer; layer `i` is as bright as `i`.
    fn layer(&self, t: &mut Subject, brightness: u8, depth: f32) -> Draw {
        let color = [f32::from(brightness) / 255.0; 4];
        let layer = t.uniform(&[color, [depth; 4]]);
        draw(&self.pipeline, &[("layer", layer.into())], 3)
    }

    /// A pass of layers at these depths, the first of brightness `first`.
    fn pass(&self, t: &mut Subject, loads: (Load<[f32; 4]>, Load<f32>), first: u8, depths: &[f32]) {
        let mut pass = RasterPass::new("suite.layers").color(self.color, loads.0).depth(self.depth, loads.1);
        pass.draws = (first..).zip(depths).map(|(i, &depth)| self.layer(t, i, depth)).collect();
        t.list.raster(pass);
    }

    /// As [`pass`](Self::pass) on a fresh screen; brightness and depth of what is seen.
    fn seen(&self, t: &mut Subject, depths: &[f32]) -> (u8, f32) {
        self.pass(t, (Load::Clear([0.0; 4]), Load::Clear(self.order.far())), 1, depths);
        self.look(t)
    }

    fn look(&self, t: &mut Subject) -> (u8, f32) {
        let (color, depth) = (t.texels(self.color), t.texel_words(self.depth));
        assert!(color.iter().all(|&byte| byte == color[0]), "one layer covers all: {color:?}");
        assert!(depth.iter().all(|&word| word == depth[0]), "at one depth: {depth:x?}");
        (color[0], f32::from_bits(depth[0]))
    }
}

pub(super) fn nearer_passes_in_standard_order(t: &mut Subject) {
    let screen = Screen::new(t, DepthOrder::Standard);
    assert_eq!(screen.seen(t, &[0.75, 0.5, 0.25]), (3, 0.25));
}

pub(super) fn nearer_passes_in_reverse_order(t: &mut Subject) {
    let screen = Screen::new(t, DepthOrder::Reverse);
    assert_eq!(screen.seen(t, &[0.25, 0.5, 0.75]), (3, 0.75));
}

pub(super) fn farther_is_hidden_in_standard_order(t: &mut Subject) {
    let screen = Screen::new(t, DepthOrder::Standard);
    assert_eq!(screen.seen(t, &[0.25, 0.5, 0.375]), (1, 0.25));
}

pub(super) fn farther_is_hidden_in_reverse_order(t: &mut Subject) {
    let screen = Screen::new(t, DepthOrder::Reverse);
    assert_eq!(screen.seen(t, &[0.75, 0.5, 0.625]), (1, 0.75));
}

pub(super) fn equal_passes_in_standard_order(t: &mut Subject) {
    let screen = Screen::new(t, DepthOrder::Standard);
    assert_eq!(screen.seen(t, &[0.5, 0.5]), (2, 0.5));
    assert_eq!(screen.seen(t, &[1.0]), (1, 1.0), "as far as the frame was cleared to");
}

pub(super) fn equal_passes_in_reverse_order(t: &mut Subject) {
    let screen = Screen::new(t, DepthOrder::Reverse);
    assert_eq!(screen.seen(t, &[0.5, 0.5]), (2, 0.5));
    assert_eq!(screen.seen(t, &[0.0]), (1, 0.0), "as far as the frame was cleared to");
}

pub(super) fn tested_alone_depth_stays(t: &mut Subject) {
    for (order, wall, near, far) in [(DepthOrder::Standard, 0.5, 0.25, 0.75), (DepthOrder::Reverse, 0.5, 0.75, 0.25)] {
        let screen = Screen::new(t, order);
        screen.pass(t, (Load::Clear([0.0; 4]), Load::Clear(order.far())), 1, &[wall]);
        let pipeline = t.raster(&LAYER, &[(Format::Rgba8, Blend::Replace)], Depth::Test(order));
        let tested = Screen { pipeline, ..screen };
        tested.pass(t, (Load::Keep, Load::Keep), 2, &[near, far]);
        assert_eq!(tested.look(t), (2, wall), "{order:?}: the far one is hidden, the near one is not written");
        tested.pass(t, (Load::Keep, Load::Keep), 4, &[wall]);
        assert_eq!(tested.look(t), (4, wall), "{order:?}: equal passes");
    }
}

pub(super) fn off_takes_the_last(t: &mut Subject) {
    let kernel = t.raster(&LAYER, &[(Format::Rgba8, Blend::Replace)], Depth::Off);
    let color = t.texture([3, 3], Format::Rgba8);
    let draws = [0.25f32, 0.75, 0.5].into_iter().enumerate().map(|(i, depth)| {
        let layer = t.uniform(&[[i as f32 / 255.0; 4], [depth; 4]]);
        draw(&kernel, &[("layer", layer.into())], 3)
    });
    let draws = draws.collect();
    t.draw(color, Load::Clear([1.0; 4]), draws);
    assert_eq!(t.texels(color), [2; 36]);
}

pub(super) fn depth_is_kept(t: &mut Subject) {
    for (order, near, far) in [(DepthOrder::Standard, 0.25, 0.5), (DepthOrder::Reverse, 0.5, 0.25)] {
        let screen = Screen::new(t, order);
        assert_eq!(screen.seen(t, &[near]), (1, near));
        screen.pass(t, (Load::Clear([0.0; 4]), Load::Keep), 2, &[far]);
        assert_eq!(screen.look(t), (0, near), "{order:?}: hidden by the pass before");
        screen.pass(t, (Load::Keep, Load::Keep), 3, &[near]);
        assert_eq!(screen.look(t), (3, near));
    }
}

pub(super) fn depth_is_cleared(t: &mut Subject) {
    for (order, near, far) in [(DepthOrder::Standard, 0.25, 0.5), (DepthOrder::Reverse, 0.5, 0.25)] {
        let screen = Screen::new(t, order);
        screen.seen(t, &[near]);
        assert_eq!(screen.seen(t, &[far]), (1, far), "{order:?}: nothing hides it any more");
        screen.pass(t, (Load::Clear([0.0; 4]), Load::Clear(near)), 2, &[far]);
        assert_eq!(screen.look(t), (0, near), "{order:?}: the value that was asked for hides it");
    }
}

pub(super) fn depth_alone_is_drawn(t: &mut Subject) {
    const DEPTH_ONLY: ShaderSource = source(
        "suite.depth_only",
        "import package::cover::cover;
        @vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> { return cover(index); }
        @fragment fn fragment() {}",
    );
    let kernel = t.raster(&DEPTH_ONLY, &[], Depth::TestWrite(DepthOrder::Standard));
    let screen = Screen::new(t, DepthOrder::Standard);
    t.list.raster(RasterPass::new("suite.depth").depth(screen.depth, Load::Clear(1.0)).draw(draw(&kernel, &[], 3)));
    screen.pass(t, (Load::Clear([0.0; 4]), Load::Keep), 1, &[0.75, 0.25, 0.3]);
    assert_eq!(screen.look(t), (2, 0.25));
}
