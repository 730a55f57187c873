//! What shaders rely on: what they were specialised on, what they are bound to, and where they find themselves.

use tressfx_core::backend::{Blend, Depth, Format};
use tressfx_core::pass::{Draw, Grid, Load};
use tressfx_core::shader::{ShaderSource, Specialization};

use super::kernels::LOAD;
use super::subject::{Subject, draw, noise, source};

pub(super) fn constants_and_features_specialize(t: &mut Subject) {
    const SPECIAL: ShaderSource = source(
        "suite.special",
        "import package::constants::FACTOR;
        @group(0) @binding(0) var<storage, read_write> values: array<u32>;
        @compute @workgroup_size(4) fn special(@builtin(local_invocation_index) i: u32) {
            var value = values[i] * FACTOR;
            @if(add) { value += 100u; }
            values[i] = value;
        }",
    );
    let kernels = [(2, false), (5, false), (2, true), (5, true)].map(|(factor, add)| {
        let specialization = Specialization::new().constant("FACTOR", factor).feature("add", add);
        t.specialized(&SPECIAL, &specialization)
    });
    let values = kernels.each_ref().map(|_| t.storage(&[1u32, 2, 3, 4]));
    for (kernel, values) in kernels.iter().zip(values) {
        t.dispatch(kernel, &[("values", values.into())], [1; 3]);
    }
    let found = values.map(|values| t.words(values, 4));
    assert_eq!(found, [[2, 4, 6, 8], [5, 10, 15, 20], [102, 104, 106, 108], [105, 110, 115, 120]]);
}

/// Bindings with gaps, in another order than they are declared.
const GAPS: ShaderSource = source(
    "suite.gaps",
    "@group(0) @binding(7) var<storage, read_write> second: array<u32>;
    @group(0) @binding(2) var<storage, read> minuend: array<u32>;
    @group(0) @binding(5) var<storage, read> subtrahend: array<u32>;
    @group(0) @binding(3) var<uniform> shift: vec4<u32>;
    @group(0) @binding(11) var<uniform> scale: vec4<u32>;
    @group(0) @binding(0) var<storage, read_write> first: array<u32>;
    @compute @workgroup_size(4) fn gaps(@builtin(local_invocation_index) i: u32) {
        first[i] = (minuend[i] - subtrahend[i]) * scale.x;
        second[i] = (minuend[i] - subtrahend[i]) << shift.x;
    }",
);

pub(super) fn bindings_have_gaps_and_any_order(t: &mut Subject) {
    let kernel = t.compute(&GAPS);
    let (minuend, subtrahend) = (t.storage(&[10u32, 20, 30, 40]), t.storage(&[1u32, 2, 3, 4]));
    let (shift, scale) = (t.uniform(&[4u32; 4]), t.uniform(&[3u32; 4]));
    let (first, second) = (t.zeros(4), t.zeros(4));
    let mut resources = [
        ("scale", scale.into()),
        ("first", first.into()),
        ("minuend", minuend.into()),
        ("shift", shift.into()),
        ("second", second.into()),
        ("subtrahend", subtrahend.into()),
    ];
    for _ in 0..resources.len() {
        resources.rotate_left(1);
        t.list.clear(first, 0, 16);
        t.list.clear(second, 0, 16);
        t.dispatch(&kernel, &resources, [1; 3]);
        assert_eq!(t.words(first, 4), [27, 54, 81, 108]);
        assert_eq!(t.words(second, 4), [144, 288, 432, 576]);
    }
}

pub(super) fn one_kernel_has_many_bindings(t: &mut Subject) {
    let kernel = t.compute(&super::kernels::TURN);
    let buffers: Vec<_> = (0..20u32).map(|i| t.storage(&vec![1000 * i; 64])).collect();
    for pair in buffers.windows(2) {
        t.dispatch(&kernel, &[("input", pair[0].into()), ("output", pair[1].into())], [1; 3]);
    }
    assert_eq!(t.words(buffers[19], 64), [19; 64], "each pass had its own");
}

pub(super) fn uniform_and_storage_read_the_same(t: &mut Subject) {
    const BOTH: ShaderSource = source(
        "suite.both",
        "struct Params { a: u32, b: vec3<f32>, c: mat4x4<f32>, d: array<vec4<u32>, 3> }
        @group(0) @binding(0) var<uniform> as_uniform: Params;
        @group(0) @binding(1) var<storage, read> as_storage: Params;
        @group(0) @binding(2) var<storage, read_write> output: array<u32>;
        @compute @workgroup_size(1) fn both() {
            let u = as_uniform;
            let s = as_storage;
            output[0] = u.a; output[1] = s.a;
            output[2] = bitcast<u32>(u.b.z); output[3] = bitcast<u32>(s.b.z);
            output[4] = bitcast<u32>(u.c[3].y); output[5] = bitcast<u32>(s.c[3].y);
            output[6] = u.d[2].w; output[7] = s.d[2].w;
        }",
    );
    let kernel = t.compute(&BOTH);
    // Small floats, which are copied to the bit.
    let words: Vec<u32> = (0..36).map(|i| (i as f32).to_bits()).collect();
    let (uniform, storage, output) = (t.uniform(&words), t.storage(&words), t.zeros(8));
    let resources = [("as_uniform", uniform.into()), ("as_storage", storage.into()), ("output", output.into())];
    t.dispatch(&kernel, &resources, [1; 3]);
    assert_eq!(t.words(output, 8), [0, 0, 6, 6, 21, 21, 35, 35].map(|i| words[i]));
}

pub(super) fn arrays_know_their_length(t: &mut Subject) {
    const LENGTH: ShaderSource = source(
        "suite.length",
        "@group(0) @binding(0) var<storage, read> input: array<vec4<f32>>;
        @group(0) @binding(1) var<storage, read_write> output: array<u32>;
        @compute @workgroup_size(1) fn length_of() {
            output[0] = arrayLength(&input) + u32(input[0].x);
            output[1] = arrayLength(&output);
        }",
    );
    let kernel = t.compute(&LENGTH);
    for words in [4, 400, 4000] {
        let (input, output) = (t.zeros(words), t.zeros(words));
        t.dispatch(&kernel, &[("input", input.into()), ("output", output.into())], [1; 3]);
        assert_eq!(t.words(output, 2), [words as u32 / 4, words as u32]);
    }
}

pub(super) fn what_lies_outside_of_a_buffer_is_not_touched(t: &mut Subject) {
    const STRAY: ShaderSource = source(
        "suite.stray",
        "@group(0) @binding(0) var<storage, read_write> values: array<u32>;
        @compute @workgroup_size(64) fn stray(@builtin(local_invocation_index) i: u32) { values[i * 16u] = 7u; }",
    );
    let kernel = t.compute(&STRAY);
    let words = noise(64, 1);
    let [before, values, after] = [t.storage(&words), t.storage(&words), t.storage(&words)];
    t.dispatch(&kernel, &[("values", values.into())], [1; 3]);
    assert_eq!((t.words(before, 64), t.words(after, 64)), (words.clone(), words.clone()));
    // Where the strays go to the last word, that is their buffer's own.
    let expected: Vec<u32> = (0..63).map(|i| if i % 16 == 0 { 7 } else { words[i] }).collect();
    assert_eq!(t.words(values, 64)[..63], expected);
}

pub(super) fn compute_adds_atomically(t: &mut Subject) {
    const ADD: ShaderSource = source(
        "suite.add",
        "@group(0) @binding(0) var<storage, read_write> sums: array<atomic<u32>, 4>;
        @compute @workgroup_size(64) fn add(@builtin(global_invocation_id) i: vec3<u32>) {
            atomicAdd(&sums[0], 1u);
            atomicMax(&sums[1], i.x);
            atomicOr(&sums[2], 1u << (i.x % 32u));
            atomicAdd(&sums[3], i.x);
        }",
    );
    let kernel = t.compute(&ADD);
    let sums = t.zeros(4);
    t.dispatch(&kernel, &[("sums", sums.into())], [500, 1, 1]);
    assert_eq!(t.words(sums, 4), [32_000, 31_999, u32::MAX, 32_000 * 31_999 / 2]);
}

pub(super) fn fragments_add_atomically(t: &mut Subject) {
    const ADD: ShaderSource = source(
        "suite.add_fragments",
        "import package::cover::cover;
        @group(0) @binding(0) var<storage, read_write> sums: array<atomic<u32>, 2>;
        @vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> { return cover(index); }
        @fragment fn fragment(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
            atomicAdd(&sums[0], 1u);
            atomicMax(&sums[1], u32(at.y) * 1000u + u32(at.x));
            return vec4<f32>(0.0);
        }",
    );
    let kernel = t.raster(&ADD, &[(Format::Rgba8, Blend::Replace)], Depth::Off);
    let sums = t.zeros(2);
    let target = t.texture([61, 43], Format::Rgba8);
    let cover = draw(&kernel, &[("sums", sums.into())], 3);
    t.draw(target, Load::Clear([0.0; 4]), vec![cover.clone(), cover]);
    assert_eq!(t.words(sums, 2), [2 * 61 * 43, 42_060], "every fragment of both draws, once");
}

pub(super) fn groups_share_memory_between_barriers(t: &mut Subject) {
    const REVERSE: ShaderSource = source(
        "suite.reverse",
        "var<workgroup> shared_words: array<u32, 128>;
        @group(0) @binding(0) var<storage, read_write> values: array<u32>;
        @compute @workgroup_size(128) fn reverse(@builtin(global_invocation_id) i: vec3<u32>,
                                                 @builtin(local_invocation_index) lane: u32) {
            shared_words[lane] = values[i.x];
            workgroupBarrier();
            let turned = shared_words[127u - lane];
            workgroupBarrier();
            shared_words[lane] = turned + lane;
            workgroupBarrier();
            values[i.x] = shared_words[lane ^ 1u];
        }",
    );
    let kernel = t.compute(&REVERSE);
    let words = noise(128 * 40, 2);
    let values = t.storage(&words);
    t.dispatch(&kernel, &[("values", values.into())], [40, 1, 1]);
    let group = |words: &[u32]| (0..128).map(|lane| words[127 - (lane ^ 1)].wrapping_add(lane as u32 ^ 1)).collect();
    let expected: Vec<u32> = words.chunks(128).flat_map(|words| -> Vec<u32> { group(words) }).collect();
    assert_eq!(t.words(values, words.len()), expected);
}

pub(super) fn groups_know_their_place_in_the_grid(t: &mut Subject) {
    const PLACE: ShaderSource = source(
        "suite.place",
        "@group(0) @binding(0) var<storage, read_write> output: array<u32>;
        @compute @workgroup_size(2, 3, 4) fn place(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
                                                   @builtin(local_invocation_index) lane: u32, @builtin(local_invocation_id) local: vec3<u32>,
                                                   @builtin(global_invocation_id) all: vec3<u32>) {
            if (lane != local.x + 2u * local.y + 6u * local.z) { return; }
            if (any(all != group * vec3<u32>(2u, 3u, 4u) + local)) { return; }
            let i = (group.z * groups.y + group.y) * groups.x + group.x;
            output[i * 24u + lane] = group.x * 10000u + group.y * 100u + group.z;
        }",
    );
    let kernel = t.compute(&PLACE);
    let [x, y, z] = [5u32, 4, 3];
    let count = (x * y * z * 24) as usize;
    let output = t.storage(&vec![u32::MAX; count]);
    t.dispatch(&kernel, &[("output", output.into())], [x, y, z]);
    let groups = (0..z).flat_map(|k| (0..y).flat_map(move |j| (0..x).map(move |i| i * 10_000 + j * 100 + k)));
    let expected: Vec<u32> = groups.flat_map(|group| [group; 24]).collect();
    assert_eq!(t.words(output, count), expected);
}

pub(super) fn more_groups_than_a_row_holds_are_folded(t: &mut Subject) {
    const MARK: ShaderSource = source(
        "suite.mark",
        "import package::grid::{thread_index, GROUP};
        @group(0) @binding(0) var<storage, read_write> sums: array<atomic<u32>, 4>;
        @compute @workgroup_size(GROUP)
        fn mark(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
                @builtin(local_invocation_index) lane: u32) {
            let i = thread_index(group, groups, lane);
            if (i % 4096u == 5u) { atomicAdd(&sums[0], 1u); atomicAdd(&sums[1], i / 4096u); }
            atomicMax(&sums[2], i);
        }",
    );
    let kernel = t.compute(&MARK);
    let threads = 65_536 * 64;
    let sums = t.zeros(4);
    let grid = Grid::for_threads(threads, 64);
    assert!(grid.0[1] > 1, "folded");
    t.dispatch(&kernel, &[("sums", sums.into())], grid.0);
    let marks = threads / 4096;
    let found = t.words(sums, 3);
    assert_eq!(found[..2], [marks, marks * (marks - 1) / 2], "each index is there once");
    assert!((threads - 1..threads + 128).contains(&found[2]));
}

pub(super) fn textures_know_their_size(t: &mut Subject) {
    const SIZE: ShaderSource = source(
        "suite.size",
        "@group(0) @binding(0) var picture: texture_2d<f32>;
        @group(0) @binding(1) var<storage, read_write> output: array<u32>;
        @compute @workgroup_size(1) fn size_of() {
            let size = textureDimensions(picture);
            output[0] = size.x;
            output[1] = size.y;
        }",
    );
    let kernel = t.compute(&SIZE);
    let picture = t.texture([37, 5], Format::Rgba8);
    let output = t.zeros(2);
    t.draw(picture, Load::Clear([0.0; 4]), Vec::new());
    t.dispatch(&kernel, &[("picture", picture.into()), ("output", output.into())], [1; 3]);
    assert_eq!(t.words(output, 2), [37, 5]);
}

/// Draws instance by instance and triangle by triangle: texel (vertex / 6, instance).
const PLACES: ShaderSource = source(
    "suite.places",
    "import package::cover::texel_corner;
    struct Corner { @builtin(position) at: vec4<f32>, @location(0) @interpolate(flat) color: vec4<f32> }
    @vertex fn vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> Corner {
        let texel = vec2<u32>(index / 6u, instance);
        let color = vec4<f32>(vec2<f32>(texel + 1u) / 255.0, 0.0, 1.0);
        return Corner(texel_corner(texel, vec2<u32>(8u, 8u), index % 6u), color);
    }
    @fragment fn fragment(corner: Corner) -> @location(0) vec4<f32> { return corner.color; }",
);

pub(super) fn vertices_and_instances_are_counted(t: &mut Subject) {
    let kernel = t.raster(&PLACES, &[(Format::Rgba8, Blend::Replace)], Depth::Off);
    let target = t.texture([8, 8], Format::Rgba8);
    let cells = Draw::new(&kernel, &kernel.bind(&[]).expect("nothing is bound"), 5 * 6, 7);
    t.draw(target, Load::Clear([0.0; 4]), vec![cells]);
    let texel = |x: u32, y: u32| if x < 5 && y < 7 { (x + 1) | (y + 1) << 8 | 0xff00_0000 } else { 0 };
    let expected: Vec<u32> = (0..64).map(|i| texel(i % 8, i / 8)).collect();
    assert_eq!(t.texel_words(target), expected);
}

pub(super) fn vertices_pull_from_many_buffers(t: &mut Subject) {
    const PULL_MANY: ShaderSource = source(
        "suite.pull_many",
        "import package::cover::texel_corner;
        @group(0) @binding(0) var<storage, read> indices: array<u32>;
        @group(0) @binding(1) var<storage, read> colors: array<u32>;
        @group(0) @binding(2) var<uniform> size: vec4<u32>;
        struct Corner { @builtin(position) at: vec4<f32>, @location(0) color: vec4<f32> }
        @vertex fn vertex(@builtin(vertex_index) index: u32) -> Corner {
            let i = indices[index / 6u];
            let at = texel_corner(vec2<u32>(i % size.x, i / size.x), size.xy, index % 6u);
            return Corner(at, unpack4x8unorm(colors[i]));
        }
        @fragment fn fragment(corner: Corner) -> @location(0) vec4<f32> { return corner.color; }",
    );
    let kernel = t.raster(&PULL_MANY, &[(Format::Rgba8, Blend::Replace)], Depth::Off);
    let words = noise(16 * 16, 3);
    let order: Vec<u32> = (0..256u32).map(|i| i * 77 % 256).collect();
    let (indices, colors) = (t.storage(&order), t.storage(&words));
    let size = t.uniform(&[16u32, 16, 0, 0]);
    let target = t.texture([16, 16], Format::Rgba8);
    let resources = [("indices", indices.into()), ("colors", colors.into()), ("size", size.into())];
    t.draw(target, Load::Clear([0.0; 4]), vec![draw(&kernel, &resources, 6 * 256)]);
    assert_eq!(t.texel_words(target), words);
}

/// Each corner of the picture in its own colour: upper left red, upper right green, lower left blue, lower right white.
const CORNERS: ShaderSource = source(
    "suite.corners",
    "import package::cover::cover;
    struct Corner { @builtin(position) at: vec4<f32>, @location(0) place: vec2<f32> }
    @vertex fn vertex(@builtin(vertex_index) index: u32) -> Corner {
        let at = cover(index);
        return Corner(at, at.xy);
    }
    @fragment fn fragment(corner: Corner) -> @location(0) vec4<f32> {
        if (corner.place.y > 0.0) {
            return select(vec4<f32>(0.0, 1.0, 0.0, 1.0), vec4<f32>(1.0, 0.0, 0.0, 1.0), corner.place.x < 0.0);
        }
        return select(vec4<f32>(1.0), vec4<f32>(0.0, 0.0, 1.0, 1.0), corner.place.x < 0.0);
    }",
);

/// What [`CORNERS`] makes of 32 x 32 texels.
fn corners() -> Vec<u32> {
    let texel = |i: u32| match (i / 32 < 16, i % 32 < 16) {
        (true, true) => 0xff00_00ff,
        (true, false) => 0xff00_ff00,
        (false, true) => 0xffff_0000,
        (false, false) => u32::MAX,
    };
    (0..32 * 32).map(texel).collect()
}

pub(super) fn up_is_up_and_left_is_left(t: &mut Subject) {
    let kernel = t.raster(&CORNERS, &[(Format::Rgba8, Blend::Replace)], Depth::Off);
    let target = t.texture([32, 32], Format::Rgba8);
    t.draw(target, Load::Clear([0.0; 4]), vec![draw(&kernel, &[], 3)]);
    assert_eq!(t.texel_words(target), corners());
}

pub(super) fn up_is_up_for_those_who_load_it(t: &mut Subject) {
    let kernel = t.raster(&CORNERS, &[(Format::Rgba8, Blend::Replace)], Depth::Off);
    let loader = t.compute(&LOAD);
    let target = t.texture([32, 32], Format::Rgba8);
    let output = t.zeros(32 * 32);
    t.draw(target, Load::Clear([0.0; 4]), vec![draw(&kernel, &[], 3)]);
    t.dispatch(&loader, &[("picture", target.into()), ("output", output.into())], [16, 1, 1]);
    assert_eq!(t.words(output, 32 * 32), corners());
}

pub(super) fn fragments_know_their_place(t: &mut Subject) {
    const AT: ShaderSource = source(
        "suite.at",
        "import package::cover::cover;
        @vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> { return cover(index); }
        @fragment fn fragment(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
            return vec4<f32>(at.x * 2.0, at.y * 2.0, at.z * 510.0, 255.0) / 255.0;
        }",
    );
    let kernel = t.raster(&AT, &[(Format::Rgba8, Blend::Replace)], Depth::Off);
    let target = t.texture([9, 6], Format::Rgba8);
    t.draw(target, Load::Clear([0.0; 4]), vec![draw(&kernel, &[], 3)]);
    let expected: Vec<u8> =
        (0..6u8).flat_map(|y| (0..9u8).flat_map(move |x| [2 * x + 1, 2 * y + 1, 255, 255])).collect();
    assert_eq!(t.texels(target), expected, "centres of texels, from the upper left");
}
