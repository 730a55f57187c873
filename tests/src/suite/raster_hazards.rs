//! What has to wait for what, where pictures are drawn.

use tressfx_core::backend::{Blend, Depth, DepthOrder, Format};
use tressfx_core::id::{BufferId, TextureId};
use tressfx_core::pass::{Load, RasterPass};
use tressfx_core::shader::{Kernel, RasterPipeline, ShaderSource};

use super::kernels::{LOAD, PAINT, PULL, TIMES_3_PLUS_1, TURN, stepped, turned};
use super::subject::{Subject, draw, noise, source};

/// Width and height of the pictures, which the shaders know.
const EDGE: u32 = 32;
const COUNT: usize = (EDGE * EDGE) as usize;
const GROUPS: u32 = COUNT as u32 / 64;
const NOTHING: Load<[f32; 4]> = Load::Clear([0.0; 4]);

fn canvas(t: &mut Subject) -> TextureId {
    t.texture([EDGE, EDGE], Format::Rgba8)
}

fn painter(t: &mut Subject, source: &ShaderSource) -> RasterPipeline {
    t.raster(source, &[(Format::Rgba8, Blend::Replace)], Depth::Off)
}

fn paint(t: &mut Subject, kernel: &RasterPipeline, colors: BufferId, target: TextureId) {
    let vertices = if kernel.label() == PULL.label { 6 * COUNT as u32 } else { 3 };
    t.draw(target, NOTHING, vec![draw(kernel, &[("colors", colors.into())], vertices)]);
}

fn turn(t: &mut Subject, kernel: &Kernel, input: BufferId, output: BufferId) {
    t.dispatch(kernel, &[("input", input.into()), ("output", output.into())], [GROUPS, 1, 1]);
}

fn load(t: &mut Subject, kernel: &Kernel, picture: TextureId, output: BufferId) {
    t.dispatch(kernel, &[("picture", picture.into()), ("output", output.into())], [GROUPS, 1, 1]);
}

fn step(t: &mut Subject, kernel: &Kernel, values: BufferId) {
    t.dispatch(kernel, &[("values", values.into())], [GROUPS, 1, 1]);
}

fn compute_then(t: &mut Subject, reader: &ShaderSource) {
    let (turner, painter) = (t.compute(&TURN), painter(t, reader));
    let words = noise(COUNT, 1);
    let [a, b] = [t.storage(&words), t.zeros(COUNT)];
    let target = canvas(t);
    turn(t, &turner, a, b);
    paint(t, &painter, b, target);
    assert_eq!(t.texel_words(target), turned(&words));
}

pub(super) fn compute_writes_then_vertices_pull(t: &mut Subject) {
    compute_then(t, &PULL);
}

pub(super) fn compute_writes_then_fragments_read(t: &mut Subject) {
    compute_then(t, &PAINT);
}

pub(super) fn compute_writes_then_compute_reads_then_raster_reads(t: &mut Subject) {
    let (turner, pull, read) = (t.compute(&TURN), painter(t, &PULL), painter(t, &PAINT));
    let words = noise(COUNT, 2);
    let [a, b, c] = [t.storage(&words), t.zeros(COUNT), t.zeros(COUNT)];
    let targets = [canvas(t), canvas(t)];
    turn(t, &turner, a, b);
    turn(t, &turner, b, c);
    paint(t, &pull, b, targets[0]);
    paint(t, &read, b, targets[1]);
    for target in targets {
        assert_eq!(t.texel_words(target), turned(&words));
    }
    assert_eq!(t.words(c, COUNT), turned(&turned(&words)));
}

fn raster_reads_then_compute_writes(t: &mut Subject, reader: &ShaderSource) {
    let (stepper, painter) = (t.compute(&TIMES_3_PLUS_1), painter(t, reader));
    let words = noise(COUNT, 3);
    let colors = t.storage(&words);
    let targets = [canvas(t), canvas(t)];
    paint(t, &painter, colors, targets[0]);
    step(t, &stepper, colors);
    paint(t, &painter, colors, targets[1]);
    assert_eq!(t.texel_words(targets[0]), words, "read before it was changed");
    assert_eq!(t.texel_words(targets[1]), stepped(&words));
}

pub(super) fn vertices_pull_then_compute_writes(t: &mut Subject) {
    raster_reads_then_compute_writes(t, &PULL);
}

pub(super) fn fragments_read_then_compute_writes(t: &mut Subject) {
    raster_reads_then_compute_writes(t, &PAINT);
}

pub(super) fn upload_then_raster_then_upload(t: &mut Subject) {
    let painter = painter(t, &PAINT);
    let [one, other] = [noise(COUNT, 4), noise(COUNT, 5)];
    let colors = t.storage(&one);
    let targets = [canvas(t), canvas(t)];
    paint(t, &painter, colors, targets[0]);
    t.list.upload(colors, 0, &other);
    paint(t, &painter, colors, targets[1]);
    assert_eq!(targets.map(|target| t.texel_words(target)), [one, other]);
}

/// Every fragment changes its own word of a buffer.
const CHANGE: ShaderSource = source(
    "suite.change",
    "import package::cover::cover;
    @group(0) @binding(0) var<storage, read_write> values: array<u32>;
    @vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> { return cover(index); }
    @fragment fn fragment(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
        let i = u32(at.y) * 32u + u32(at.x);
        values[i] = values[i] * 3u + 1u;
        return vec4<f32>(1.0);
    }",
);

fn change(t: &mut Subject, kernel: &RasterPipeline, values: BufferId, target: TextureId) {
    t.draw(target, NOTHING, vec![draw(kernel, &[("values", values.into())], 3)]);
}

pub(super) fn fragments_write_then_compute_reads(t: &mut Subject) {
    let (turner, changer) = (t.compute(&TURN), painter(t, &CHANGE));
    let words = noise(COUNT, 6);
    let [values, output] = [t.storage(&words), t.zeros(COUNT)];
    let target = canvas(t);
    change(t, &changer, values, target);
    turn(t, &turner, values, output);
    assert_eq!(t.words(output, COUNT), turned(&stepped(&words)));
}

pub(super) fn compute_and_fragments_take_turns(t: &mut Subject) {
    let (stepper, changer) = (t.compute(&TIMES_3_PLUS_1), painter(t, &CHANGE));
    let mut words = noise(COUNT, 7);
    let values = t.storage(&words);
    let target = canvas(t);
    for _ in 0..3 {
        change(t, &changer, values, target);
        step(t, &stepper, values);
        words = stepped(&stepped(&words));
    }
    change(t, &changer, values, target);
    change(t, &changer, values, target);
    assert_eq!(t.words(values, COUNT), stepped(&stepped(&words)));
}

pub(super) fn fragments_write_then_copy(t: &mut Subject) {
    let changer = painter(t, &CHANGE);
    let words = noise(COUNT, 8);
    let [values, copy] = [t.storage(&words), t.zeros(COUNT)];
    let target = canvas(t);
    change(t, &changer, values, target);
    t.list.copy(values, copy, 4 * COUNT as u64);
    t.list.clear(values, 0, 4 * COUNT as u64);
    assert_eq!(t.words(copy, COUNT), stepped(&words));
    assert_eq!(t.words(values, COUNT), vec![0; COUNT]);
}

pub(super) fn a_picture_is_drawn_then_loaded_then_drawn(t: &mut Subject) {
    let (painter, loader) = (painter(t, &PAINT), t.compute(&LOAD));
    let pictures = [noise(COUNT, 9), noise(COUNT, 10)];
    let target = canvas(t);
    let outputs = [t.zeros(COUNT), t.zeros(COUNT)];
    for (words, output) in pictures.iter().zip(outputs) {
        let colors = t.storage(words);
        paint(t, &painter, colors, target);
        load(t, &loader, target, output);
    }
    assert_eq!(outputs.map(|output| t.words(output, COUNT)), pictures);
}

/// Turns the picture upside down and left to right, from one texture into another.
const SAMPLE: ShaderSource = source(
    "suite.sample",
    "import package::cover::cover;
    @group(0) @binding(0) var picture: texture_2d<f32>;
    @vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> { return cover(index); }
    @fragment fn fragment(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
        return textureLoad(picture, vec2<u32>(31u) - vec2<u32>(at.xy), 0);
    }",
);

pub(super) fn two_pictures_are_drawn_from_each_other(t: &mut Subject) {
    let (painter, sampler) = (painter(t, &PAINT), painter(t, &SAMPLE));
    let words = noise(COUNT, 11);
    let colors = t.storage(&words);
    let [a, b] = [canvas(t), canvas(t)];
    paint(t, &painter, colors, a);
    for (input, output) in [(a, b), (b, a), (a, b)] {
        t.draw(output, NOTHING, vec![draw(&sampler, &[("picture", input.into())], 3)]);
    }
    assert_eq!(t.texel_words(b), words.iter().rev().copied().collect::<Vec<_>>());
    assert_eq!(t.texel_words(a), words);
}

pub(super) fn a_picture_is_drawn_then_read_back_then_drawn(t: &mut Subject) {
    let painter = painter(t, &PAINT);
    let pictures = [noise(COUNT, 12), noise(COUNT, 13)];
    let target = canvas(t);
    let tickets = pictures.clone().map(|words| {
        let colors = t.storage(&words);
        paint(t, &painter, colors, target);
        t.list.read_texture(target)
    });
    assert_eq!(tickets.map(|ticket| t.read_words(ticket)), pictures);
}

pub(super) fn a_picture_is_loaded_after_it_was_read_back(t: &mut Subject) {
    let (painter, loader) = (painter(t, &PAINT), t.compute(&LOAD));
    let words = noise(COUNT, 14);
    let colors = t.storage(&words);
    let (target, output) = (canvas(t), t.zeros(COUNT));
    paint(t, &painter, colors, target);
    let ticket = t.list.read_texture(target);
    load(t, &loader, target, output);
    assert_eq!(t.read_words(ticket), words);
    t.draw(target, Load::Keep, Vec::new());
    assert_eq!(t.texel_words(target), words, "nothing was drawn over it");
    assert_eq!(t.words(output, COUNT), words);
}

/// Depth that rises from texel to texel.
const SLOPE: ShaderSource = source(
    "suite.slope",
    "import package::cover::cover;
    @vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
        let at = cover(index);
        return vec4<f32>(at.xy, (at.x + 1.0) * 0.25 + (at.y + 1.0) * 0.125, 1.0);
    }
    @fragment fn fragment() {}",
);

fn slope(t: &mut Subject, kernel: &RasterPipeline, depth: TextureId) {
    t.list.raster(RasterPass::new("suite.depth").depth(depth, Load::Clear(1.0)).draw(draw(kernel, &[], 3)));
}

fn sloped() -> Vec<f32> {
    let center = |i: u32| (i as f32 + 0.5) / EDGE as f32;
    (0..EDGE).flat_map(|y| (0..EDGE).map(move |x| 0.5 * center(x) + 0.25 * (1.0 - center(y)))).collect()
}

fn assert_near(found: &[u32], expected: &[f32]) {
    for (i, (&found, expected)) in found.iter().zip(expected).enumerate() {
        let found = f32::from_bits(found);
        assert!((found - expected).abs() < 1e-5, "texel {i}: {found} is not {expected}");
    }
}

pub(super) fn depth_is_drawn_then_loaded_in_compute(t: &mut Subject) {
    const LOAD_DEPTH: ShaderSource = source(
        "suite.load_depth",
        "@group(0) @binding(0) var picture: texture_depth_2d;
        @group(0) @binding(1) var<storage, read_write> output: array<f32>;
        @compute @workgroup_size(64) fn load_depth(@builtin(global_invocation_id) i: vec3<u32>) {
            output[i.x] = textureLoad(picture, vec2<u32>(i.x % 32u, i.x / 32u), 0);
        }",
    );
    let kernel = t.raster(&SLOPE, &[], Depth::TestWrite(DepthOrder::Standard));
    let loader = t.compute(&LOAD_DEPTH);
    let depth = t.texture([EDGE, EDGE], Format::Depth32F);
    let output = t.zeros(COUNT);
    slope(t, &kernel, depth);
    load(t, &loader, depth, output);
    slope(t, &kernel, depth);
    let words = t.words(output, COUNT);
    assert_near(&words, &sloped());
    assert_eq!(t.texel_words(depth), words, "by read-back as by loading");
}

pub(super) fn depth_is_drawn_then_loaded_by_fragments(t: &mut Subject) {
    const SHOW_DEPTH: ShaderSource = source(
        "suite.show_depth",
        "import package::cover::cover;
        @group(0) @binding(0) var picture: texture_depth_2d;
        @vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> { return cover(index); }
        @fragment fn fragment(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
            return unpack4x8unorm(bitcast<u32>(textureLoad(picture, vec2<u32>(at.xy), 0)));
        }",
    );
    let kernel = t.raster(&SLOPE, &[], Depth::TestWrite(DepthOrder::Standard));
    let show = painter(t, &SHOW_DEPTH);
    let depth = t.texture([EDGE, EDGE], Format::Depth32F);
    let target = canvas(t);
    slope(t, &kernel, depth);
    t.draw(target, NOTHING, vec![draw(&show, &[("picture", depth.into())], 3)]);
    assert_near(&t.texel_words(target), &sloped());
}
