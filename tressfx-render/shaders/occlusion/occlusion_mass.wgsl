// How much hair each tile has in each slice of depth, about: what becomes of it decides about speed alone. One thread a segment of a sample of
// the strands.

import package::grid::{GROUP, thread_index};
import package::occlusion::{MASS_UNIT, SLICES, occlusion};
import package::points::point_of;
import package::screen::{distance_of, tile_columns, view};
import package::strands::{color_of, end_at, is_sound_at, section, strand_at};
import package::tile::TILE;

@group(0) @binding(6) var<storage, read_write> masses: array<atomic<u32>>;

// Places along a segment at which it is, at most.
const MOST_PLACES: f32 = 16.0;
// A place has no more mass: sums stay small.
const MOST_MASS: f32 = 1048576.0;

// The slice of a nearness.
fn slice_of(nearness: f32) -> u32 {
    let share = (distance_of(nearness) - occlusion.nearest) / occlusion.depth;
    return u32(clamp(share, 0.0, 1.0) * (f32(SLICES) - 0.5));
}

fn add(pixel: vec2<f32>, nearness: f32, mass: f32) {
    if all(pixel >= vec2(0.0)) && all(pixel < vec2<f32>(view.size)) && nearness > 0.0 {
        let tile = vec2<u32>(pixel) / TILE;
        let place = (tile.y * tile_columns() + tile.x) * SLICES + slice_of(nearness);
        atomicAdd(&masses[place], u32(min(mass * MASS_UNIT, MOST_MASS)));
    }
}

@compute @workgroup_size(GROUP)
fn occlusion_mass(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
                  @builtin(local_invocation_index) lane: u32) {
    let i = thread_index(group, groups, lane);
    let sampled = (section.lod.strands + occlusion.stride - 1u) / occlusion.stride;
    if i >= sampled * (section.lod.vertices - 1u) {
        return;
    }
    let strand = strand_at(i % sampled * occlusion.stride);
    let vertex = i / sampled;
    if !is_sound_at(strand, vertex) || !is_sound_at(strand, vertex + 1u) {
        return;
    }
    let a = point_of(end_at(strand, vertex));
    let b = point_of(end_at(strand, vertex + 1u));
    if min(a.w, b.w) < 0.0 {
        return;
    }
    let length = distance(a.xy, b.xy);
    let width = (a.w + b.w) * abs(view.lens.focal.y);
    let alpha = saturate(color_of(strand, vertex).a * min(width, 1.0));
    let optical = min(-log2(max(1.0 - alpha, 1e-6)), occlusion.closing);
    let mass = optical * max(width, 1.0) * length * f32(occlusion.stride);
    let places = clamp(ceil(length / f32(TILE)), 1.0, MOST_PLACES);
    for (var place = 0.5; place < places; place += 1.0) {
        let at = mix(a.xyz, b.xyz, place / places);
        add(at.xy, at.z, mass / places);
    }
}
