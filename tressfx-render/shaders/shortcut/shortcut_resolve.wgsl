// Last pass of ShortCut, one thread a pixel: the colour of its nearest fragments with the opacity of all.

import package::constants::K;
import package::pixels::{count_hairy, counters, index_of, is_inside, pixel_of, view};
import package::sums::{FULL, transmittance_of};
import package::tile::tile_of;

@if(ordered)
import package::fragment::{OPAQUE, packed_alpha, packed_color};
@if(hair_output)
import package::pixels::write_seen_pixel;
@if(!hair_output)
import package::pixels::write_pixel;
@if(!ordered)
import package::layers::UNIT;
@if(!ordered)
import package::pixels::resolved;
@if(!ordered)
import package::sums::mean_color;
@if(!ordered)
import package::tile::resolved_index;

@group(0) @binding(1) var<storage, read> layers: array<u32>;
@group(0) @binding(2) var<storage, read> opticals: array<u32>;
// What the second pass has left, beside what it has left in `resolved`.
@if(ordered)
@group(0) @binding(3) var<storage, read> slots: array<vec2<u32>>;
@if(!ordered)
@group(0) @binding(3) var<storage, read> sums: array<vec2<u32>>;

// The sums that the second pass has left in `resolved`.
@if(!ordered && !hair_output)
fn red_green(index: u32) -> vec2<u32> {
    return resolved[index];
}

@if(!ordered && hair_output)
fn red_green(index: u32) -> vec2<u32> {
    return vec2(resolved[3u * index], resolved[3u * index + 1u]);
}

// Where there is opacity and no colour, as rounding might have it, the picture is left as it was, not made black.
@if(!ordered)
fn front(pixel: vec2<u32>, index: u32, behind: f32) -> vec4<f32> {
    let place = resolved_index(tile_of(pixel, view.size), pixel);
    let color = min(vec3(red_green(place), sums[index].x), vec3(FULL));
    let weight = min(sums[index].y, FULL);
    if weight == 0u {
        return vec4(0.0);
    }
    return vec4((1.0 - behind) * mean_color(color, weight, UNIT), 1.0 - behind);
}

// What is behind has the mean colour of those in front.
@if(ordered)
fn front(pixel: vec2<u32>, index: u32, behind: f32) -> vec4<f32> {
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
fn shortcut_resolve(@builtin(global_invocation_id) thread: vec3<u32>, @builtin(workgroup_id) group: vec3<u32>,
                    @builtin(local_invocation_index) lane: u32) {
    let pixel = pixel_of(thread.xy);
    let inside = is_inside(pixel);
    let index = index_of(pixel);
    var has_hair = false;
    if inside {
        has_hair = layers[index * K] != 0u;
    }
    let count = count_hairy(has_hair, tile_of(pixel, view.size), lane);
    if lane == 0u && all(group.xy == vec2(0u)) {
        let wanted = atomicLoad(&counters.fragments);
        counters.saturated = u32(wanted > FULL);
    }
    if inside && count > 0u {
        var color = vec4(0.0);
        if has_hair {
            color = front(pixel, index, transmittance_of(min(opticals[index], FULL)));
        }
        @if(!hair_output) { write_pixel(pixel, color); }
        // The first layer is that of the nearest.
        @if(hair_output) { write_seen_pixel(pixel, color, layers[index * K]); }
    }
}
