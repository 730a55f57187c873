// Many fragments of one and the same depth: their order means nothing, so that each pixel has their mean.

import package::fragment::Fragment;
import package::front::{Front, over};
import package::quarter::PIXELS;
@if(places)
import package::places::all_places;
import package::sums::{mean_color, optical_depth, transmittance_of, weighted};

// The sums have room for so many fragments of a pixel of this brightness.
const MOST: u32 = 2048u;
const BRIGHTEST: f32 = 16.0;
const UNIT: f32 = 65536.0;

@if(!hair_output)
const SUMS: u32 = 6u;
@if(hair_output)
const SUMS: u32 = 7u;

// Fragments, their optical depth, weight and colour, and, where depth is written, the largest alpha; a pixel.
var<workgroup> sums: array<array<atomic<u32>, SUMS>, PIXELS>;

fn empty_mean(pixel: u32) {
    for (var i = 0u; i < SUMS; i++) {
        atomicStore(&sums[pixel][i], 0u);
    }
}

fn add_to_mean(pixel: u32, fragment: Fragment) {
    if fragment.alpha == 0u {
        return;
    }
    if atomicAdd(&sums[pixel][0], 1u) >= MOST {
        return;
    }
    let color = weighted(min(fragment.color, vec3(BRIGHTEST)), fragment.alpha, UNIT);
    atomicAdd(&sums[pixel][1], optical_depth(fragment.alpha));
    atomicAdd(&sums[pixel][2], fragment.alpha);
    atomicAdd(&sums[pixel][3], color.x);
    atomicAdd(&sums[pixel][4], color.y);
    atomicAdd(&sums[pixel][5], color.z);
    @if(hair_output) { atomicMax(&sums[pixel][6], fragment.alpha); }
}

fn blend_mean(front: Front, pixel: u32) -> Front {
    let weight = atomicLoad(&sums[pixel][2]);
    if weight == 0u {
        return front;
    }
    let color = vec3(atomicLoad(&sums[pixel][3]), atomicLoad(&sums[pixel][4]), atomicLoad(&sums[pixel][5]));
    let alpha = 1.0 - transmittance_of(atomicLoad(&sums[pixel][1]));
    @if(!places) { return over(front, mean_color(color, weight, UNIT), alpha, atomicLoad(&sums[pixel][0])); }
    @if(places) { return over(front, mean_color(color, weight, UNIT), all_places(alpha), atomicLoad(&sums[pixel][0])); }
}

// The largest alpha of the fragments of a pixel; 0 where there are none.
@if(hair_output)
fn largest_alpha(pixel: u32) -> u32 {
    return atomicLoad(&sums[pixel][6]);
}
