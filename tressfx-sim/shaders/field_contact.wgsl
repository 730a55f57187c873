// Contact of a point with a signed distance field, along the way that it has gone.

import package::capsule::GpuCapsule;
import package::field::{Sample, header, sample, CELL};
import package::vector::{rotate, rotate_back};

/// The way is followed in steps as long as nothing can be touched, and no shorter than this share of a cell,
const SHORTEST: f32 = 0.25;
/// so that there are never more than this.
const STEPS: u32 = 32u;
/// How often a point is pushed out: where the surface bends, once is not far enough.
const PUSHES: u32 = 3u;

/// Whether an element of the list of capsules is a field.
fn is_field(shape: GpuCapsule) -> bool {
    return shape.radius_a < 0.0;
}

fn field_of(shape: GpuCapsule) -> u32 {
    return u32(-shape.radius_a - 0.5);
}

/// The distance from a field, and the direction away from it, of a point in the space of the head.
fn sample_of(shape: GpuCapsule, point: vec3<f32>) -> Sample {
    let rotation = vec4(shape.b, shape.radius_b);
    let found = sample(field_of(shape), rotate_back(rotation, point - shape.a));
    return Sample(found.distance, rotate(rotation, found.normal));
}

/// By what a point is pushed that has gone along `way`, as the field sees it, to where it is. Nothing where it has touched nothing. It is held where it touches
/// first and goes on along the surface; what begins inside has touched at the beginning. Then it is pushed out where it is.
fn beside(shape: GpuCapsule, point: vec3<f32>, way: vec3<f32>) -> vec3<f32> {
    let length = sqrt(dot(way, way));
    var found = sample_of(shape, point);
    if (found.distance >= length) { return vec3(0.0); }
    let shortest = max(SHORTEST * header(field_of(shape), CELL), length / f32(STEPS));
    var at = point;
    var gone = 0.0;
    while (gone < length) {
        let here = sample_of(shape, point - way * (1.0 - gone / length));
        if (here.distance <= 0.0) {
            // What is left of the way, but for what goes into the surface.
            let left = (1.0 - gone / length) * dot(way, here.normal);
            at -= min(left, 0.0) * here.normal;
            found = sample_of(shape, at);
            break;
        }
        gone += max(here.distance, shortest);
    }
    for (var i = 0u; i < PUSHES && found.distance < 0.0; i++) {
        at -= found.distance * found.normal;
        found = sample_of(shape, at);
    }
    return at - point;
}
