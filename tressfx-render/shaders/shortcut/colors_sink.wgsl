// Colours of fragments that are not behind the last layer: summed up, or in order each in the place of its layer.

import package::constants::K;
import package::fragment::Fragment;
import package::layers::{is_in_front, layer_key};
import package::screen::view;

@if(ordered)
import package::fragment::pack_color;
@if(ordered)
import package::layers::ROUNDING;
@if(!ordered)
import package::layers::UNIT;
@if(!ordered)
import package::sums::weighted;
@if(!ordered)
import package::tile::{resolved_index, tile_of};

@group(0) @binding(6) var<storage, read> layers: array<u32>;
// Two a layer of each pixel: red and green, blue and alpha.
@if(ordered)
@group(0) @binding(7) var<storage, read_write> slots: array<atomic<u32>>;
// The sums of red and green, in the first two words of a pixel. The resolve replaces them by its result.
@if(!ordered)
@group(0) @binding(7) var<storage, read_write> resolved: array<atomic<u32>>;
// Two a pixel: the sums of blue and of alpha.
@if(!ordered)
@group(0) @binding(8) var<storage, read_write> sums: array<atomic<u32>>;

// Words of a pixel in `resolved`.
@if(!ordered && !hair_output)
const RESOLVED: u32 = 2u;
@if(!ordered && hair_output)
const RESOLVED: u32 = 3u;

struct Sink {
    unused: u32,
}

fn take(sink: ptr<function, Sink>, pixel: vec2<u32>, fragment: Fragment) {
    let index = pixel.y * view.size.x + pixel.x;
    let key = layer_key(fragment);
    if is_in_front(key, layers[index * K + K - 1u]) {
        keep(pixel, index, key, fragment);
    }
}

@if(!ordered)
fn keep(pixel: vec2<u32>, index: u32, key: u32, fragment: Fragment) {
    let color = weighted(fragment.color, fragment.alpha, UNIT);
    let place = RESOLVED * resolved_index(tile_of(pixel, view.size), pixel);
    add_to_resolved(place, color.r);
    add_to_resolved(place + 1u, color.g);
    add_to_sums(2u * index, color.b);
    add_to_sums(2u * index + 1u, fragment.alpha);
}

// As the optical depths of the first pass: what has overflowed once stays full.
@if(!ordered)
fn add_to_resolved(place: u32, value: u32) {
    if atomicAdd(&resolved[place], value) > 0xffffffffu - value {
        atomicOr(&resolved[place], 0x80000000u);
    }
}

@if(!ordered)
fn add_to_sums(place: u32, value: u32) {
    if atomicAdd(&sums[place], value) > 0xffffffffu - value {
        atomicOr(&sums[place], 0x80000000u);
    }
}

// The key of the layer that is nearest to a key: its own, but for rounding.
@if(ordered)
fn nearest_layer(index: u32, key: u32) -> u32 {
    var nearest = key;
    var distance = ROUNDING + 1u;
    for (var i = index * K; i < index * K + K; i++) {
        let apart = max(layers[i], key) - min(layers[i], key);
        if apart < distance {
            nearest = layers[i];
            distance = apart;
        }
    }
    return nearest;
}

// Fragments of one key share as many layers as there are fragments, and fewer at the last. Each layer keeps the larger of
// two words and hands the other on, so that the same words are left however threads interleave.
@if(ordered)
fn keep(pixel: vec2<u32>, index: u32, key: u32, fragment: Fragment) {
    let place = nearest_layer(index, key);
    var passed = pack_color(fragment);
    for (var i = index * K; i < index * K + K; i++) {
        if layers[i] == place {
            passed.x = min(passed.x, atomicMax(&slots[2u * i], passed.x));
            passed.y = min(passed.y, atomicMax(&slots[2u * i + 1u], passed.y));
        }
    }
}
