//! The fixed state of raster passes: blending, targets, faces, and how a pass begins.

use tressfx_core::backend::{Blend, Depth, Format};
use tressfx_core::id::TextureId;
use tressfx_core::pass::{Draw, Load, RasterPass};
use tressfx_core::shader::{RasterPipeline, ShaderSource};

use super::formats::{FILL, assert_rounds_to};
use super::kernels::PAINT;
use super::subject::{Subject, draw, noise, source};

const SIZE: [u32; 2] = [32, 32];
const COUNT: usize = 32 * 32;

pub(super) fn fill(t: &mut Subject, kernel: &RasterPipeline, color: [f32; 4]) -> Draw {
    let uniform = t.uniform(&color);
    draw(kernel, &[("color", uniform.into())], 3)
}

fn channels(word: u32) -> [f64; 4] {
    word.to_le_bytes().map(|byte| f64::from(byte) / 255.0)
}

/// Draws random premultiplied texels over random ones, and gives both and what came of it.
fn layers(t: &mut Subject, blend: Blend) -> [Vec<u32>; 3] {
    let below = noise(COUNT, 1);
    let premultiplied = |word: u32| {
        let [r, g, b, a] = word.to_le_bytes();
        u32::from_le_bytes([r.min(a), g.min(a), b.min(a), a])
    };
    let above: Vec<u32> = noise(COUNT, 2).into_iter().map(premultiplied).collect();
    let replace = t.raster(&PAINT, &[(Format::Rgba8, Blend::Replace)], Depth::Off);
    let kernel = t.raster(&PAINT, &[(Format::Rgba8, blend)], Depth::Off);
    let [one, other] = [t.storage(&below), t.storage(&above)];
    let target = t.texture(SIZE, Format::Rgba8);
    let draws = vec![draw(&replace, &[("colors", one.into())], 3), draw(&kernel, &[("colors", other.into())], 3)];
    t.draw(target, Load::Clear([1.0; 4]), draws);
    let found = t.texel_words(target);
    [below, above, found]
}

pub(super) fn replace_replaces_alpha_and_all(t: &mut Subject) {
    let [_, above, found] = layers(t, Blend::Replace);
    assert_eq!(found, above);
}

pub(super) fn over_lays_premultiplied_color_over(t: &mut Subject) {
    let [below, above, found] = layers(t, Blend::Over);
    for i in 0..COUNT {
        let (below, above, found) = (channels(below[i]), channels(above[i]), channels(found[i]));
        for c in 0..4 {
            let expected = above[c] + below[c] * (1.0 - above[3]);
            assert!((found[c] - expected).abs() <= 1.0 / 255.0, "{above:?} over {below:?} is not {found:?}");
        }
    }
}

/// Draws layers whose sums and products eight bits hold exactly, and gives the texel that comes of it.
fn blended(t: &mut Subject, blend: Blend, format: Format) -> Vec<u8> {
    let pipeline = t.raster(&FILL, &[(format, blend)], Depth::Off);
    let target = t.texture([3, 3], format);
    let layer = fill(t, &pipeline, ABOVE);
    t.draw(target, Load::Clear(BELOW), vec![layer]);
    t.texels(target)
}

/// What blends with what; each channel in another relation.
const BELOW: [f32; 4] = [0.2, 0.8, 1.0, 0.4];
const ABOVE: [f32; 4] = [0.6, 0.1, 0.2, 0.5];
const BLENDABLE: [Format; 6] =
    [Format::Rgba8, Format::Bgra8, Format::Rgba16F, Format::Rgba8Srgb, Format::Rg16F, Format::R16F];

fn blends(t: &mut Subject, blend: Blend, each: impl Fn(f32, f32) -> f32) {
    let expected = std::array::from_fn(|c| each(ABOVE[c], BELOW[c]));
    for format in BLENDABLE {
        let found = blended(t, blend, format);
        assert_rounds_to(format, &found, expected);
    }
}

pub(super) fn add_adds(t: &mut Subject) {
    blends(t, Blend::Add, |above, below| above + below);
}

pub(super) fn add_of_bytes_ends_at_one(t: &mut Subject) {
    let found = blended(t, Blend::Add, Format::Rgba8);
    assert_eq!(found, [204, 230, 255, 230].repeat(9), "0.2 and 1 are 1");
}

pub(super) fn multiply_multiplies(t: &mut Subject) {
    blends(t, Blend::Multiply, |above, below| above * below);
}

pub(super) fn min_takes_the_smaller(t: &mut Subject) {
    blends(t, Blend::Min, f32::min);
}

pub(super) fn max_takes_the_larger(t: &mut Subject) {
    blends(t, Blend::Max, f32::max);
}

fn over_in(t: &mut Subject, format: Format) {
    let over = t.raster(&FILL, &[(format, Blend::Over)], Depth::Off);
    let target = t.texture([3, 3], format);
    let layers = [fill(t, &over, [0.25, 0.5, 0.0, 0.5]), fill(t, &over, [0.0, 0.125, 0.25, 0.25])];
    t.draw(target, Load::Clear([0.5, 0.0, 1.0, 1.0]), layers.to_vec());
    assert_rounds_to(format, &t.texels(target), [0.375, 0.5, 0.625, 1.0]);
}

pub(super) fn over_blends_floats(t: &mut Subject) {
    over_in(t, Format::Rgba16F);
}

pub(super) fn over_blends_srgb_as_light(t: &mut Subject) {
    over_in(t, Format::Rgba8Srgb);
    over_in(t, Format::Bgra8Srgb);
}

pub(super) fn over_takes_more_light_than_alpha(t: &mut Subject) {
    let over = t.raster(&FILL, &[(Format::Rgba16F, Blend::Over)], Depth::Off);
    let target = t.texture([3, 3], Format::Rgba16F);
    let layer = fill(t, &over, [4.0, 0.0, 0.5, 0.0]);
    t.draw(target, Load::Clear([1.0, 2.0, 3.0, 0.5]), vec![layer]);
    assert_rounds_to(Format::Rgba16F, &t.texels(target), [5.0, 2.0, 3.5, 0.5]);
}

pub(super) fn draws_of_a_pass_are_in_order(t: &mut Subject) {
    let kernel = t.raster(&FILL, &[(Format::Rgba8, Blend::Replace)], Depth::Off);
    let target = t.texture([3, 3], Format::Rgba8);
    let draws = (0..10u8).map(|i| fill(t, &kernel, [f32::from(i) / 255.0; 4])).collect();
    t.draw(target, Load::Clear([1.0; 4]), draws);
    assert_eq!(t.texels(target), [9; 36]);
}

pub(super) fn both_faces_are_drawn(t: &mut Subject) {
    const FACES: ShaderSource = source(
        "suite.faces",
        "import package::cover::texel_corner;
        @vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
            // The left texel one way round, the right one the other way.
            let corner = index % 6u;
            let turned = select(corner, 5u - corner, index >= 6u);
            return texel_corner(vec2<u32>(index / 6u, 0u), vec2<u32>(2u, 1u), turned);
        }
        @fragment fn fragment(@builtin(front_facing) front: bool) -> @location(0) vec4<f32> {
            return vec4<f32>(1.0, select(0.0, 1.0, front), 0.0, 1.0);
        }",
    );
    let kernel = t.raster(&FACES, &[(Format::Rgba8, Blend::Replace)], Depth::Off);
    let target = t.texture([2, 1], Format::Rgba8);
    t.draw(target, Load::Clear([0.0; 4]), vec![draw(&kernel, &[], 12)]);
    let found = t.texel_words(target);
    assert_ne!(found[0], found[1], "they face two ways");
    assert!(found.iter().all(|texel| texel & 0xff00_00ff == 0xff00_00ff), "both are there: {found:08x?}");
}

pub(super) fn counter_clockwise_is_the_front(t: &mut Subject) {
    const FRONT: ShaderSource = source(
        "suite.front",
        "@vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
            return vec4<f32>(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.5, 1.0);
        }
        @fragment fn fragment(@builtin(front_facing) front: bool) -> @location(0) vec4<f32> {
            return vec4<f32>(select(0.0, 1.0, front));
        }",
    );
    let kernel = t.raster(&FRONT, &[(Format::Rgba8, Blend::Replace)], Depth::Off);
    let target = t.texture([2, 2], Format::Rgba8);
    t.draw(target, Load::Clear([0.5; 4]), vec![draw(&kernel, &[], 3)]);
    assert_eq!(t.texels(target), [255; 16]);
}

pub(super) fn color_is_kept(t: &mut Subject) {
    let (fill_all, paint) = (
        t.raster(&FILL, &[(Format::Rgba8, Blend::Replace)], Depth::Off),
        t.raster(&FILL, &[(Format::Rgba8, Blend::Over)], Depth::Off),
    );
    let target = t.texture([3, 2], Format::Rgba8);
    let (opaque, glass) = (fill(t, &fill_all, [0.0, 1.0, 0.2, 1.0]), fill(t, &paint, [0.2, 0.0, 0.0, 0.0]));
    t.draw(target, Load::Clear([1.0; 4]), vec![opaque]);
    t.draw(target, Load::Keep, vec![glass]);
    t.draw(target, Load::Keep, Vec::new());
    assert_eq!(t.texels(target), [51, 255, 51, 255].repeat(6));
}

pub(super) fn color_is_kept_across_lists(t: &mut Subject) {
    let target = t.texture([3, 2], Format::Rgba8);
    t.draw(target, Load::Clear([1.0, 0.0, 1.0, 0.0]), Vec::new());
    t.run();
    t.draw(target, Load::Keep, Vec::new());
    assert_eq!(t.texels(target), [255, 0, 255, 0].repeat(6));
}

pub(super) fn color_is_cleared_before_the_first_draw(t: &mut Subject) {
    let over = t.raster(&FILL, &[(Format::Rgba8, Blend::Over)], Depth::Off);
    let target = t.texture([3, 2], Format::Rgba8);
    t.draw(target, Load::Clear([1.0; 4]), Vec::new());
    let glass = fill(t, &over, [0.2, 0.0, 0.0, 0.0]);
    t.draw(target, Load::Clear([0.0, 0.4, 0.0, 1.0]), vec![glass]);
    assert_eq!(t.texels(target), [51, 102, 0, 255].repeat(6));
}

pub(super) fn targets_have_their_own_colors(t: &mut Subject) {
    const THREE: ShaderSource = source(
        "suite.three",
        "import package::cover::cover;
        struct Colors { @location(0) one: vec4<f32>, @location(1) two: vec4<f32>, @location(2) three: vec4<f32> }
        @vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> { return cover(index); }
        @fragment fn fragment() -> Colors {
            return Colors(vec4<f32>(1.0, 0.0, 0.0, 0.5), vec4<f32>(0.0, 1.0, 0.0, 0.5), vec4<f32>(0.0, 0.0, 2.0, 0.5));
        }",
    );
    let formats = [(Format::Rgba8, Blend::Replace), (Format::Rgba8, Blend::Over), (Format::Rgba16F, Blend::Over)];
    let kernel = t.raster(&THREE, &formats, Depth::Off);
    let targets = formats.map(|(format, _)| t.texture([7, 3], format));
    let load = [0.0, 0.0, 1.0, 1.0];
    let pass = |targets: &[TextureId], draws: Vec<Draw>| {
        let mut pass = RasterPass::new("suite.targets");
        pass.colors = targets.iter().map(|&target| (target, Load::Clear(load))).collect();
        pass.draws = draws;
        pass
    };
    t.list.raster(pass(&targets, vec![draw(&kernel, &[], 3)]));
    let expected = [[1.0, 0.0, 0.0, 0.5], [0.0, 1.0, 0.5, 1.0], [0.0, 0.0, 2.5, 1.0]];
    for ((target, (format, _)), expected) in targets.into_iter().zip(formats).zip(expected) {
        assert_rounds_to(format, &t.texels(target), expected);
    }
    t.list.raster(pass(&targets[..2], Vec::new()));
    assert_rounds_to(Format::Rgba8, &t.texels(targets[1]), load);
    assert_rounds_to(Format::Rgba16F, &t.texels(targets[2]), expected[2]);
}

pub(super) fn targets_begin_each_in_its_own_way(t: &mut Subject) {
    let targets = [(); 2].map(|()| t.texture([3, 3], Format::Rgba8));
    let begin = |[one, other]: [Load<[f32; 4]>; 2]| {
        RasterPass::new("suite.targets").color(targets[0], one).color(targets[1], other)
    };
    t.list.raster(begin([Load::Clear([0.2; 4]), Load::Clear([0.4; 4])]));
    t.list.raster(begin([Load::Keep, Load::Clear([0.6; 4])]));
    t.list.raster(begin([Load::Clear([0.8; 4]), Load::Keep]));
    assert_eq!(targets.map(|target| t.texels(target)), [vec![204; 36], vec![153; 36]]);
}

pub(super) fn no_vertices_and_no_instances_draw_nothing(t: &mut Subject) {
    let kernel = t.raster(&FILL, &[(Format::Rgba8, Blend::Replace)], Depth::Off);
    let target = t.texture([2, 2], Format::Rgba8);
    let bindings = fill(t, &kernel, [1.0; 4]).bindings;
    t.draw(target, Load::Clear([0.2; 4]), vec![Draw::new(&kernel, &bindings, 3, 0)]);
    t.draw(target, Load::Keep, vec![Draw::new(&kernel, &bindings, 0, 1)]);
    assert_eq!(t.texels(target), [51; 16]);
}
