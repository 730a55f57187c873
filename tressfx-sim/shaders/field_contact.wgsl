// Contact of a point with a signed distance field, along the way that it has gone, as the field sees it. Points are in the space of the head.

import package::capsule::GpuCapsule;
import package::field::{Sample, header, sample, CELL};
import package::vector::{rotate, rotate_back};

/// The way is followed in steps as long as nothing can be touched, and no shorter than this share of a cell,
const SHORTEST: f32 = 0.25;
/// so that there are never more than this.
const STEPS: u32 = 32u;
/// How often a point is pushed out: where the surface bends, once is not far enough.
const PUSHES: u32 = 3u;
/// What is interpolated between nodes changes by up to the square root of 3 over a distance of 1.
const SLOPE: f32 = 0.577;
/// Where the normal has turned by more than what this cosine says since a point touched, it has got to another side.
const STILL_BESIDE: f32 = 0.3;
/// Cells in a field that are deep.
const DEEP_CELLS: f32 = 0.1;

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

/// How deep in a field a point is deep.
fn depth_of_field(shape: GpuCapsule) -> f32 {
    return DEEP_CELLS * header(field_of(shape), CELL);
}

/// Where a point first touches a field on its way, as a share of the way, and the field there; 1 and more where it does not.
struct First { share: f32, here: Sample }

/// `point` is where it gets to along `way`, as the field sees it. What begins inside touches at the beginning.
fn first_touch_of(shape: GpuCapsule, point: vec3<f32>, way: vec3<f32>) -> First {
    let length = sqrt(dot(way, way));
    let shortest = max(SHORTEST * header(field_of(shape), CELL), length / f32(STEPS));
    var gone = 0.0;
    while (gone < length) {
        let here = sample_of(shape, point - way * (1.0 - gone / length));
        if (here.distance <= 0.0) { return First(gone / length, here); }
        gone += max(here.distance, shortest);
    }
    return First(1.0, Sample(0.0, vec3(0.0)));
}

/// By what a point is pushed that has gone along `way` to where it is. Nothing where it has touched nothing. It is held where it touches first and goes on along the
/// surface; then it is pushed out where it is.
fn beside(shape: GpuCapsule, point: vec3<f32>, way: vec3<f32>) -> vec3<f32> {
    var found = sample_of(shape, point);
    if (found.distance >= sqrt(dot(way, way))) { return vec3(0.0); }
    var at = point;
    let first = first_touch_of(shape, point, way);
    if (first.share < 1.0) {
        // What is left of the way, but for what goes into the surface.
        let left = (1.0 - first.share) * dot(way, first.here.normal);
        at -= min(left, 0.0) * first.here.normal;
        found = sample_of(shape, at);
    }
    for (var i = 0u; i < PUSHES && found.distance < 0.0; i++) {
        at -= found.distance * found.normal;
        found = sample_of(shape, at);
    }
    return at - point;
}

/// The plane that holds a point which has gone along `way` to where it is: the distance from it, negative where it is to be pushed, and its normal. That of the
/// surface where the point is; or where it has got to another side, that of the surface where it has touched first.
fn met_by(shape: GpuCapsule, point: vec3<f32>, way: vec3<f32>) -> Sample {
    let found = sample_of(shape, point);
    if (found.distance > sqrt(dot(way, way))) { return found; }
    let first = first_touch_of(shape, point, way);
    if (first.share >= 1.0 || dot(found.normal, first.here.normal) >= STILL_BESIDE) { return found; }
    let left = (1.0 - first.share) * dot(way, first.here.normal);
    return Sample(first.here.distance + left, first.here.normal);
}
