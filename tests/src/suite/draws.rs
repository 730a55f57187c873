//! Draws: counts from buffers, viewports, pipelines without a fragment stage.

use tressfx_core::backend::{Blend, BufferDesc, Depth, DepthOrder, Format};
use tressfx_core::pass::{Draw, Load, RasterPass, Viewport};
use tressfx_core::shader::ShaderSource;

use super::formats::FILL;
use super::state::fill;
use super::subject::{Subject, draw, source};

/// Texel (vertex / 6, instance) of 8 x 8.
const PLACES: ShaderSource = source(
    "suite.counted_places",
    "import package::cover::texel_corner;
    @vertex fn vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32)
        -> @builtin(position) vec4<f32> {
        return texel_corner(vec2<u32>(index / 6u, instance), vec2<u32>(8u, 8u), index % 6u);
    }
    @fragment fn fragment() -> @location(0) vec4<f32> { return vec4<f32>(1.0); }",
);

/// What [`PLACES`] draws of so many texels in so many rows.
fn places(width: u32, height: u32) -> Vec<u32> {
    (0..64).map(|i| if i % 8 < width && i / 8 < height { u32::MAX } else { 0 }).collect()
}

const NOTHING: Load<[f32; 4]> = Load::Clear([0.0; 4]);

pub(super) fn a_buffer_says_how_much_is_drawn(t: &mut Subject) {
    let pipeline = t.raster(&PLACES, &[(Format::Rgba8, Blend::Replace)], Depth::Off);
    let bindings = pipeline.bind(&[]).expect("nothing is bound");
    let counts = t.filled(&[99u32, 18, 4, 0, 0, 30, 7, 0, 0], BufferDesc::indirect);
    let targets = [(); 2].map(|()| t.texture([8, 8], Format::Rgba8));
    for (target, offset) in targets.into_iter().zip([4, 20]) {
        t.draw(target, NOTHING, vec![Draw::indirect(&pipeline, &bindings, counts, offset)]);
    }
    assert_eq!(t.texel_words(targets[0]), places(3, 4));
    assert_eq!(t.texel_words(targets[1]), places(5, 7));
}

pub(super) fn a_buffer_may_say_that_nothing_is_drawn(t: &mut Subject) {
    let pipeline = t.raster(&PLACES, &[(Format::Rgba8, Blend::Replace)], Depth::Off);
    let bindings = pipeline.bind(&[]).expect("nothing is bound");
    let counts = t.filled(&[0u32, 5, 0, 0, 6, 0, 0, 0], BufferDesc::indirect);
    let target = t.texture([8, 8], Format::Rgba8);
    let draws = [0, 16].map(|offset| Draw::indirect(&pipeline, &bindings, counts, offset)).to_vec();
    t.draw(target, NOTHING, draws);
    assert_eq!(t.texel_words(target), places(0, 0));
}

/// Writes how much is drawn.
const COUNT: ShaderSource = source(
    "suite.count_vertices",
    "@group(0) @binding(0) var<uniform> wanted: vec4<u32>;
    @group(0) @binding(1) var<storage, read_write> counts: array<u32>;
    @compute @workgroup_size(1) fn count_vertices() {
        counts[0] = wanted.x;
        counts[1] = wanted.y;
        counts[2] = 0u;
        counts[3] = 0u;
    }",
);

pub(super) fn compute_writes_how_much_is_drawn(t: &mut Subject) {
    let pipeline = t.raster(&PLACES, &[(Format::Rgba8, Blend::Replace)], Depth::Off);
    let (kernel, bindings) = (t.compute(&COUNT), pipeline.bind(&[]).expect("nothing is bound"));
    let counts = t.filled(&[12u32, 1, 0, 0], BufferDesc::indirect);
    let targets = [(); 3].map(|()| t.texture([8, 8], Format::Rgba8));
    let wanted = t.uniform(&[24u32, 6, 0, 0]);
    let show = |t: &mut Subject, target| {
        t.draw(target, NOTHING, vec![Draw::indirect(&pipeline, &bindings, counts, 0)]);
    };
    show(t, targets[0]);
    t.dispatch(&kernel, &[("wanted", wanted.into()), ("counts", counts.into())], [1; 3]);
    show(t, targets[1]);
    t.list.upload(counts, 4, &[2u32]);
    show(t, targets[2]);
    assert_eq!(targets.map(|target| t.texel_words(target)), [places(2, 1), places(4, 6), places(4, 2)]);
}

pub(super) fn a_viewport_is_where_clip_space_lies(t: &mut Subject) {
    let pipeline = t.raster(&PLACES, &[(Format::Rgba8, Blend::Replace)], Depth::Off);
    let target = t.texture([40, 24], Format::Rgba8);
    let bindings = pipeline.bind(&[]).expect("nothing is bound");
    let pass = RasterPass::new("suite.viewport").color(target, Load::Clear([0.0, 0.0, 1.0, 1.0]));
    let pass = pass.viewport(Viewport { origin: [16, 3], size: [16, 8] });
    t.list.raster(pass.draw(Draw::new(&pipeline, &bindings, 6 * 3, 5)));
    // Each texel of eight by eight is two wide here and one high.
    let texel = |x: u32, y: u32| (16..22).contains(&x) && (3..8).contains(&y);
    let expected: Vec<u32> = (0..40 * 24).map(|i| if texel(i % 40, i / 40) { u32::MAX } else { 0xffff_0000 }).collect();
    assert_eq!(t.texel_words(target), expected, "targets are cleared whole");
}

pub(super) fn nothing_is_drawn_beyond_a_viewport(t: &mut Subject) {
    let pipeline = t.raster(&FILL, &[(Format::Rgba8, Blend::Replace)], Depth::Off);
    let target = t.texture([12, 10], Format::Rgba8);
    let cover = fill(t, &pipeline, [1.0; 4]);
    for (origin, size) in [([0, 0], [5, 10]), ([7, 2], [5, 3]), ([11, 9], [1, 1]), ([0, 0], [12, 10])] {
        // The triangle goes far beyond clip space.
        let pass = RasterPass::new("suite.viewport").color(target, NOTHING).draw(cover.clone());
        t.list.raster(pass.viewport(Viewport { origin, size }));
        let inside = |i: u32| (0..2).all(|a| (origin[a]..origin[a] + size[a]).contains(&[i % 12, i / 12][a]));
        let expected: Vec<u32> = (0..120).map(|i| if inside(i) { u32::MAX } else { 0 }).collect();
        assert_eq!(t.texel_words(target), expected, "{origin:?} {size:?}");
    }
}

pub(super) fn fragments_know_their_place_in_the_target(t: &mut Subject) {
    const AT: ShaderSource = source(
        "suite.at_in_viewport",
        "import package::cover::cover;
        @vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> { return cover(index); }
        @fragment fn fragment(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
            return vec4<f32>(at.x * 2.0, at.y * 2.0, 0.0, 255.0) / 255.0;
        }",
    );
    let pipeline = t.raster(&AT, &[(Format::Rgba8, Blend::Replace)], Depth::Off);
    let target = t.texture([9, 6], Format::Rgba8);
    let pass = RasterPass::new("suite.viewport").color(target, NOTHING).draw(draw(&pipeline, &[], 3));
    t.list.raster(pass.viewport(Viewport { origin: [4, 2], size: [3, 4] }));
    let texel = |x: u8, y: u8| match (4..7).contains(&x) && y >= 2 {
        true => [2 * x + 1, 2 * y + 1, 0, 255],
        false => [0; 4],
    };
    let expected: Vec<u8> = (0..6u8).flat_map(|y| (0..9u8).flat_map(move |x| texel(x, y))).collect();
    assert_eq!(t.texels(target), expected);
}

/// Covers the target at a depth, without a fragment stage.
const DEPTH_ALONE: ShaderSource = source(
    "suite.depth_alone",
    "import package::cover::cover;
    @group(0) @binding(0) var<uniform> depth: vec4<f32>;
    @vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
        return vec4<f32>(cover(index).xy, depth.x, 1.0);
    }",
);

pub(super) fn without_a_fragment_stage_depth_is_drawn(t: &mut Subject) {
    let pipeline = t.raster(&DEPTH_ALONE, &[], Depth::TestWrite(DepthOrder::Standard));
    let target = t.texture([4, 3], Format::Depth32F);
    let layers = [0.75f32, 0.25, 0.5].map(|depth| t.uniform(&[depth; 4]));
    let mut pass = RasterPass::new("suite.depth").depth(target, Load::Clear(1.0));
    pass.draws = layers.map(|layer| draw(&pipeline, &[("depth", layer.into())], 3)).to_vec();
    t.list.raster(pass);
    assert_eq!(t.texel_words(target), [0.25f32.to_bits(); 12]);
}
