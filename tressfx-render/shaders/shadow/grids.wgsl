// The cells of each frame, over the hair that `shadow_bounds` has found in it.

import package::frames::{ShadowGrid, ShadowUniform, grid_over, number_of};

@group(0) @binding(16) var<uniform> shadow: ShadowUniform;
// For each frame the largest of x, y, z and of -x, -y, -z, as whole numbers in their order.
@group(0) @binding(17) var<storage, read> bounds: array<u32>;

fn grid_of(index: u32) -> ShadowGrid {
    let at = 6u * index;
    let high = vec3(number_of(bounds[at]), number_of(bounds[at + 1u]), number_of(bounds[at + 2u]));
    let low = -vec3(number_of(bounds[at + 3u]), number_of(bounds[at + 4u]), number_of(bounds[at + 5u]));
    return grid_over(low, high, shadow.frames[index], shadow.radius);
}

// Whether hair was found in a frame.
fn has_hair(index: u32) -> bool {
    return bounds[6u * index] != 0u;
}
