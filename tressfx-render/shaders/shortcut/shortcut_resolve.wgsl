// Last pass of ShortCut, one thread a pixel: the colour of its nearest fragments with the opacity of all.

import package::constants::K;
import package::counters::Counters;
import package::sums::{FULL, transmittance_of};
import package::view::ViewUniform;

@if(ordered)
import package::fragment::{OPAQUE, packed_alpha, packed_color};
@if(!ordered)
import package::layers::UNIT;
@if(!ordered)
import package::sums::mean_color;

@group(0) @binding(0) var<uniform> view: ViewUniform;
@group(0) @binding(1) var<storage, read> layers: array<u32>;
@group(0) @binding(2) var<storage, read> opticals: array<u32>;
// What the second pass has left, beside what it has left in `resolved`.
@if(ordered)
@group(0) @binding(3) var<storage, read> slots: array<vec2<u32>>;
@if(!ordered)
@group(0) @binding(3) var<storage, read> sums: array<vec2<u32>>;
@group(0) @binding(4) var<storage, read_write> counters: Counters;
// Premultiplied colour and alpha as four half floats, a pixel.
@group(0) @binding(5) var<storage, read_write> resolved: array<vec2<u32>>;
// Tiles of 8 x 8 pixels with hair.
@group(0) @binding(6) var<storage, read_write> tiles: array<u32>;
// Six vertices for each of them: the arguments of a draw.
@group(0) @binding(7) var<storage, read_write> tile_vertices: array<atomic<u32>, 4>;

var<workgroup> hairy: atomic<u32>;

// Where there is opacity and no colour, as rounding might have it, the picture is left as it was, not made black.
@if(!ordered)
fn front(index: u32, behind: f32) -> vec4<f32> {
    let color = min(vec3(resolved[index], sums[index].x), vec3(FULL));
    let weight = min(sums[index].y, FULL);
    if weight == 0u {
        return vec4(0.0);
    }
    return vec4((1.0 - behind) * mean_color(color, weight, UNIT), 1.0 - behind);
}

// What is behind has the mean colour of those in front.
@if(ordered)
fn front(index: u32, behind: f32) -> vec4<f32> {
    var color = vec3(0.0);
    var transmittance = 1.0;
    var sum = vec4(0.0);
    for (var i = index * K; i < index * K + K; i++) {
        let alpha = f32(packed_alpha(slots[i])) / OPAQUE;
        let weighted = alpha * packed_color(slots[i]);
        color += transmittance * weighted;
        transmittance *= 1.0 - alpha;
        sum += vec4(weighted, alpha);
    }
    if sum.w == 0.0 {
        return vec4(0.0);
    }
    return vec4(color + max(transmittance - behind, 0.0) * sum.rgb / sum.w, 1.0 - behind);
}

@compute @workgroup_size(8, 8)
fn shortcut_resolve(@builtin(global_invocation_id) pixel: vec3<u32>, @builtin(workgroup_id) group: vec3<u32>,
                    @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    if lane == 0u {
        atomicStore(&hairy, 0u);
    }
    workgroupBarrier();
    let inside = all(pixel.xy < view.size);
    let index = pixel.y * view.size.x + pixel.x;
    var has_hair = false;
    if inside {
        has_hair = layers[index * K] != 0u;
    }
    if has_hair {
        atomicAdd(&hairy, 1u);
    }
    workgroupBarrier();
    let count = atomicLoad(&hairy);
    if lane == 0u {
        atomicAdd(&counters.pixels_with_hair, count);
        if count > 0u {
            tiles[atomicAdd(&tile_vertices[0], 6u) / 6u] = group.y * groups.x + group.x;
        }
    }
    if lane == 0u && all(group.xy == vec2(0u)) {
        let wanted = atomicLoad(&counters.fragments);
        counters.saturated = u32(wanted > FULL);
    }
    if inside && count > 0u {
        var color = vec4(0.0);
        if has_hair {
            color = front(index, transmittance_of(min(opticals[index], FULL)));
        }
        resolved[index] = vec2(pack2x16float(color.rg), pack2x16float(color.ba));
    }
}
